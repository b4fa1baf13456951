/* Drives an FMI 2.0 co-simulation library from C and prints times, for fmu/benches/step_rate.py.
 * Arguments: library, GUID, resources as a URI, communication step in s, number of steps, references to set before each
 * step (comma-separated, may be empty), the value to set, references to get after it. Prints nanoseconds a step and, where
 * the library can, nanoseconds to save and to restore a state; the least of several rounds. */

#define _GNU_SOURCE
#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { ROUNDS = 5, STATES = 1000, MOST = 64 };

typedef void Logger(void *, const char *, int, const char *, const char *, ...);
typedef struct {
    Logger *logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment;
} Callbacks;

static void logger(void *environment, const char *name, int status, const char *category, const char *text, ...) {
    (void)environment, (void)name, (void)category;
    va_list arguments;
    va_start(arguments, text);
    if (status > 1) vfprintf(stderr, text, arguments), fputc('\n', stderr);
    va_end(arguments);
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
    return t.tv_sec * 1e9 + t.tv_nsec;
}

static void *symbol(void *library, const char *name) {
    void *found = dlsym(library, name);
    if (!found) fprintf(stderr, "no %s\n", name), exit(1);
    return found;
}

static size_t references(const char *text, unsigned *list) {
    size_t count = 0;
    for (char *end; *text && count < MOST; text = *end == ',' ? end + 1 : end) list[count++] = strtoul(text, &end, 10);
    return count;
}

static void check(int status, const char *what) {
    if (status != 0) fprintf(stderr, "%s: status %d\n", what, status), exit(1);
}

int main(int count, char **arguments) {
    if (count != 9) return fprintf(stderr, "expected 8 arguments\n"), 2;
    void *library = dlopen(arguments[1], RTLD_NOW | RTLD_LOCAL);
    if (!library) return fprintf(stderr, "%s\n", dlerror()), 1;
    void *(*instantiate)(const char *, int, const char *, const char *, const Callbacks *, int, int) =
        symbol(library, "fmi2Instantiate");
    int (*setup)(void *, int, double, double, int, double) = symbol(library, "fmi2SetupExperiment");
    int (*enter)(void *) = symbol(library, "fmi2EnterInitializationMode");
    int (*leave)(void *) = symbol(library, "fmi2ExitInitializationMode");
    int (*set)(void *, const unsigned *, size_t, const double *) = symbol(library, "fmi2SetReal");
    int (*get)(void *, const unsigned *, size_t, double *) = symbol(library, "fmi2GetReal");
    int (*step)(void *, double, double, int) = symbol(library, "fmi2DoStep");
    void (*release)(void *) = symbol(library, "fmi2FreeInstance");
    int (*save)(void *, void **) = dlsym(library, "fmi2GetFMUstate");
    int (*restore)(void *, void *) = dlsym(library, "fmi2SetFMUstate");
    int (*forget)(void *, void **) = dlsym(library, "fmi2FreeFMUstate");

    double size = atof(arguments[4]);
    long steps = atol(arguments[5]);
    unsigned inputs[MOST], outputs[MOST];
    size_t n_inputs = references(arguments[6], inputs), n_outputs = references(arguments[8], outputs);
    double command[MOST], values[MOST];
    for (size_t k = 0; k < n_inputs; k++) command[k] = atof(arguments[7]);
    Callbacks callbacks = {logger, calloc, free, NULL, NULL};

    double best = 1e300, saved = 1e300, restored = 1e300;
    for (int round = 0; round < ROUNDS; round++) {
        void *rover = instantiate("rover", 1, arguments[2], arguments[3], &callbacks, 0, 0);
        if (!rover) return fprintf(stderr, "not instantiated\n"), 1;
        check(setup(rover, 0, 0.0, 0.0, 0, 0.0), "fmi2SetupExperiment");
        check(enter(rover), "fmi2EnterInitializationMode");
        check(leave(rover), "fmi2ExitInitializationMode");
        double start = now();
        for (long k = 0; k < steps; k++) {
            if (n_inputs) check(set(rover, inputs, n_inputs, command), "fmi2SetReal");
            check(step(rover, k * size, size, 1), "fmi2DoStep");
            check(get(rover, outputs, n_outputs, values), "fmi2GetReal");
        }
        double taken = (now() - start) / steps;
        if (taken < best) best = taken;
        if (save) {
            void *state = NULL;
            start = now();
            for (int k = 0; k < STATES; k++) check(save(rover, &state), "fmi2GetFMUstate");
            taken = (now() - start) / STATES;
            if (taken < saved) saved = taken;
            start = now();
            for (int k = 0; k < STATES; k++) check(restore(rover, state), "fmi2SetFMUstate");
            taken = (now() - start) / STATES;
            if (taken < restored) restored = taken;
            check(forget(rover, &state), "fmi2FreeFMUstate");
        }
        release(rover);
    }
    printf("%.1f %.1f %.1f\n", best, save ? saved : -1.0, save ? restored : -1.0);
    return 0;
}
