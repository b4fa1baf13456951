/* A minimal FMI 2.0 co-simulation FMU: x' = -x by Euler's method, without checks. The peer in
 * fmu/benches/step_rate.py: what a step costs that does next to nothing. */

#include <stdlib.h>

typedef struct {
    double x;
} State;

const char *fmi2GetTypesPlatform(void) { return "default"; }
const char *fmi2GetVersion(void) { return "2.0"; }

void *fmi2Instantiate(const char *name, int type, const char *guid, const char *resources, const void *callbacks,
                      int visible, int logging) {
    (void)name, (void)type, (void)guid, (void)resources, (void)callbacks, (void)visible, (void)logging;
    State *cart = malloc(sizeof(State));
    if (cart) cart->x = 1.0;
    return cart;
}

void fmi2FreeInstance(void *cart) { free(cart); }

int fmi2SetupExperiment(void *cart, int with_tolerance, double tolerance, double start, int with_stop, double stop) {
    (void)cart, (void)with_tolerance, (void)tolerance, (void)start, (void)with_stop, (void)stop;
    return 0;
}

int fmi2EnterInitializationMode(void *cart) { return (void)cart, 0; }
int fmi2ExitInitializationMode(void *cart) { return (void)cart, 0; }
int fmi2Terminate(void *cart) { return (void)cart, 0; }

int fmi2Reset(void *cart) {
    ((State *)cart)->x = 1.0;
    return 0;
}

int fmi2GetReal(void *cart, const unsigned *references, size_t count, double *values) {
    (void)references;
    for (size_t k = 0; k < count; k++) values[k] = ((State *)cart)->x;
    return 0;
}

int fmi2SetReal(void *cart, const unsigned *references, size_t count, const double *values) {
    (void)references;
    for (size_t k = 0; k < count; k++) ((State *)cart)->x = values[k];
    return 0;
}

int fmi2DoStep(void *cart, double time, double step, int no_set) {
    (void)time, (void)no_set;
    ((State *)cart)->x -= step * ((State *)cart)->x;
    return 0;
}

int fmi2GetFMUstate(void *cart, void **state) {
    if (!*state) *state = malloc(sizeof(State));
    if (!*state) return 3;
    *(State *)*state = *(State *)cart;
    return 0;
}

int fmi2SetFMUstate(void *cart, void *state) {
    *(State *)cart = *(State *)state;
    return 0;
}

int fmi2FreeFMUstate(void *cart, void **state) {
    (void)cart;
    free(*state);
    *state = NULL;
    return 0;
}

/* What importers look up and this FMU does not have. */
#define MISSING(name) int name(void) { return 3; }
MISSING(fmi2SetDebugLogging)
MISSING(fmi2GetInteger) MISSING(fmi2GetBoolean) MISSING(fmi2GetString)
MISSING(fmi2SetInteger) MISSING(fmi2SetBoolean) MISSING(fmi2SetString)
MISSING(fmi2SerializedFMUstateSize) MISSING(fmi2SerializeFMUstate) MISSING(fmi2DeSerializeFMUstate)
MISSING(fmi2GetDirectionalDerivative) MISSING(fmi2SetRealInputDerivatives) MISSING(fmi2GetRealOutputDerivatives)
MISSING(fmi2CancelStep) MISSING(fmi2GetStatus) MISSING(fmi2GetRealStatus) MISSING(fmi2GetIntegerStatus)
MISSING(fmi2GetBooleanStatus) MISSING(fmi2GetStringStatus)
