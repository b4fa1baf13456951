/** The state of the page: what the address says, and what the server knows. */

import { get, post, remove } from "./api";
import { readView, sameView, writeView, type View } from "./address";
import { over, together } from "./errors";
import { spoken } from "./format";
import { keyOf, missing, remember } from "./memory";
import type { Plan } from "./plan";
import { embedded } from "./saved";
import { partOf, shownOf } from "./set";
import { Trials } from "./trials";
import type { Diagnosis, Experiment, Found, Job, JobKind, Listed, Parameter, Part, Separation, Snapshot, Step, Trial, Values } from "./types";
import { experimentOf } from "./wire";

export class Store {
  /** The report that the page is, where no server answers. */
  readonly saved = embedded();
  view: View = readView();
  listed: Listed | null = null;
  /** What is open: an experiment, or several on one soil. */
  whole: Experiment | null = null;
  /** The same with the measurements that are shown: of several experiments those of one. They change with the trial that belongs to them. */
  experiment: Experiment | null = null;
  /** Which of several experiments is shown; null where there is one. */
  part: Part | null = null;
  steps: Step[] = [];
  found = new Map<string, Found>();
  diagnosis: Diagnosis | null = null;
  separation: Separation | null = null;
  jobs = new Map<JobKind, Job>();
  trial: Trial | null = null;
  /** The model of the step that is drawn beside. */
  other: Trial | null = null;
  /** A plan whose map is shown. */
  plan: Plan | null = null;
  error: string | null = null;
  connected = true;
  /** Whether the values follow the fit of the effects that are on, once it is there. */
  following = false;
  /** Times from a toggle or a slider to the redrawn page, ms; the test in a browser reads them. */
  times: { what: string; ms: number; server: number }[] = [];

  private listeners = new Set<() => void>();
  private events: EventSource | null = null;
  private touched: { what: string; at: number } | null = null;
  private trials = new Trials(this);

  subscribe(listener: () => void): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  changed(): void {
    for (const listener of this.listeners) listener();
  }

  fail(error: unknown): void {
    this.error = error instanceof Error ? error.message : String(error);
    this.changed();
  }

  async start(): Promise<void> {
    window.addEventListener("popstate", () => this.moveTo(readView()));
    if (this.saved) return this.startSaved();
    try {
      this.listed = await get<Listed>("api/experiments");
      const known = this.listed.experiments.some((one) => one.id === this.view.experiment);
      const first = this.listed.experiments[0];
      if (!known && first) this.view = { ...readView(), experiment: first.id };
      if (this.view.experiment) await this.open(this.view.experiment);
    } catch (error) {
      this.fail(error);
    }
    this.changed();
  }

  /** A report opens with its last model, the one before beside it. */
  private startSaved(): void {
    const saved = this.saved;
    if (!saved) return;
    this.show(saved.experiment, "");
    this.steps = saved.snapshot.steps;
    this.found = new Map(saved.snapshot.found.map((found) => [keyOf(found.effects), found]));
    this.diagnosis = saved.snapshot.diagnosis;
    const last = this.steps.length - 1;
    if (!location.hash.includes("at=") || !this.steps[this.view.at]) {
      const before = last >= 2 ? last - 1 : null;
      this.view = { ...readView(""), at: last, on: this.steps[last]?.effects ?? [], versus: before };
    }
    void this.ask("load");
  }

  /** Follows the browser's back and forward. */
  private async moveTo(view: View): Promise<void> {
    const other = view.experiment !== this.view.experiment;
    this.view = view;
    this.following = false;
    if (other && view.experiment) await this.open(view.experiment);
    this.changed();
    void this.ask("undo");
  }

  /** Changes what the address says; `push` makes it a step that the browser's back undoes. */
  go(change: Partial<View>, push = false): void {
    const next = { ...this.view, ...change };
    if (sameView(next, this.view)) return;
    this.view = next;
    writeView(this.view, push);
    this.changed();
  }

  async openExperiment(id: string): Promise<void> {
    this.go({ ...readView(""), experiment: id }, true);
    this.listed = await get<Listed>("api/experiments");
    await this.open(id);
  }

  private async open(id: string): Promise<void> {
    this.events?.close();
    this.show(null, "");
    this.trial = null;
    this.other = null;
    this.steps = [];
    this.found.clear();
    this.jobs.clear();
    this.diagnosis = null;
    this.separation = null;
    this.changed();
    try {
      this.show(experimentOf(await get<Experiment>(`api/experiments/${id}`)), this.view.part);
    } catch (error) {
      return this.fail(error);
    }
    this.listen(id);
  }

  /** Shows the measurements of an experiment, of several those of one. */
  show(whole: Experiment | null, part: string): void {
    if (whole === this.whole && this.experiment && partOf(whole, part) === this.part) return;
    this.whole = whole;
    this.part = partOf(whole, part);
    this.experiment = whole && shownOf(whole, this.part);
  }

  /** Chooses which of several experiments is shown. */
  choosePart(part: string): void {
    this.touch("part");
    this.go({ part, run: 0, row: 0, range: null, a: null, b: null, search: "", heat: ["", "", ""] }, true);
    void this.ask("part");
  }

  private listen(id: string): void {
    const events = new EventSource(`api/experiments/${id}/events`);
    this.events = events;
    const on = <T>(name: string, take: (data: T) => void) =>
      events.addEventListener(name, (event) => {
        if (this.events !== events) return;
        take(JSON.parse((event as MessageEvent<string>).data) as T);
        this.changed();
      });
    events.onopen = () => this.connection(true);
    events.onerror = () => this.connection(false);
    on<Snapshot>("snapshot", (data) => void this.take(data).then(() => this.changed()));
    on<Job>("job", (job) => {
      if (job.running) this.jobs.set(job.kind, job);
      else this.jobs.delete(job.kind);
      if (job.error && job.error !== "stopped") this.error = job.error;
    });
    on<Found>("fit", (found) => this.takeFit(found));
    on<{ at: number; step: Step }>("step", ({ at, step }) => {
      this.steps[at] = step;
      this.remember();
      if (at === 1 && this.view.at === 0 && !this.isChanged()) this.goTo(1, false);
    });
    on<Diagnosis>("diagnosis", (data) => (this.diagnosis = data));
    on<Separation>("separation", (data) => (this.separation = data));
    on<null>("calibrated", () => void this.refresh());
  }

  private connection(good: boolean): void {
    if (this.connected === good) return;
    this.connected = good;
    this.changed();
  }

  private async refresh(): Promise<void> {
    if (!this.experiment) return;
    this.show(experimentOf(await get<Experiment>(`api/experiments/${this.experiment.id}`)), this.part?.part ?? "");
    this.changed();
  }

  private remember(): void {
    if (this.experiment && !this.saved) remember(this.experiment.id, this.steps);
  }

  private async take(data: Snapshot): Promise<void> {
    const lost = missing(this.experiment?.id, data.steps);
    // All at once: a page that is left while they are sent remembers every one.
    this.steps = [...data.steps, ...lost];
    try {
      for (const step of lost) {
        const { at } = await post<{ at: number }>(`api/experiments/${this.experiment?.id}/steps`, { ...step, rmse: {} });
        this.steps[at] = step;
      }
      // What was known of the experiment may be of the server before.
      if (lost.length > 0) await this.refresh();
    } catch (error) {
      this.fail(error);
    }
    this.found = new Map(data.found.map((found) => [keyOf(found.effects), found]));
    this.diagnosis = data.diagnosis;
    this.separation = data.separation;
    this.jobs = new Map(data.jobs.map((job) => [job.kind, job]));
    if (this.view.at >= this.steps.length) this.view = { ...this.view, at: this.steps.length - 1 };
    // Who comes without an address sees the calibrated model, which may be there already.
    const fresh = this.view.at === 0 && !this.isChanged() && !location.hash.includes("at=");
    if (fresh && this.steps.length > 1) this.goTo(1, false);
    else if (!this.trial) void this.ask("load");
    if (!this.jobs.has("calibrate") && !this.experiment?.calibration) void this.begin("calibrate");
    this.remember();
  }

  private takeFit(found: Found): void {
    const key = keyOf(found.effects);
    this.found.set(key, found);
    if (this.following && key === keyOf(this.view.on)) {
      this.go({ set: this.difference(found.values) });
      void this.ask("fit");
    }
  }

  get step(): Step | undefined {
    return this.steps[this.view.at];
  }

  /** The values of the model that is shown, where they differ from the given ones. */
  values(): Values {
    const values: Values = { ...this.step?.values, ...this.view.set };
    const off = (parameter: Parameter) => parameter.effect !== null && !this.view.on.includes(parameter.effect);
    for (const parameter of this.experiment?.parameters ?? []) if (off(parameter)) delete values[parameter.name];
    return values;
  }

  value(parameter: Parameter): number {
    return this.values()[parameter.name] ?? parameter.start;
  }

  /** What of these values differs from the step's. */
  private difference(values: Values): Values {
    const own = this.step?.values ?? {};
    return Object.fromEntries(Object.entries(values).filter(([name, value]) => own[name] !== value));
  }

  isChanged(): boolean {
    return Object.keys(this.view.set).length > 0 || keyOf(this.view.on) !== keyOf(this.step?.effects ?? []);
  }

  parametersOf(effect: string | null): Parameter[] {
    return (this.experiment?.parameters ?? []).filter((parameter) => parameter.effect === effect);
  }

  /** Switches an effect on or off: at its fitted strength with the soil fitted beside it, where that is known; else at a strength at
   * which it shows, until the fit is there. */
  toggle(effect: string): void {
    this.touch("toggle");
    if (this.saved) return this.toggleSaved(effect);
    const set = { ...this.view.set };
    const goesOn = !this.view.on.includes(effect);
    for (const parameter of this.parametersOf(effect)) {
      if (goesOn) set[parameter.name] = parameter.typical;
      else delete set[parameter.name];
    }
    this.turn(goesOn ? [...this.view.on, effect] : this.view.on.filter((id) => id !== effect), set);
  }

  /** Lets an effect act in other ones of several experiments, with the strength that it has. */
  place(effect: string, elsewhere: string): void {
    this.touch("toggle");
    const set = { ...this.view.set };
    const others = this.parametersOf(elsewhere);
    this.parametersOf(effect).forEach((parameter, k) => {
      const other = others[k];
      if (other) set[other.name] = this.value(parameter);
      delete set[parameter.name];
    });
    this.turn([...this.view.on.filter((id) => id !== effect && id !== elsewhere), elsewhere], set);
  }

  /** Lets these effects act: with what a fit of them has found or, until it is there, with `otherwise`. */
  private turn(on: string[], otherwise: Values): void {
    const known = this.found.get(keyOf(on));
    let set = otherwise;
    if (keyOf(on) === keyOf(this.step?.effects ?? [])) set = {};
    else if (known) set = this.difference(known.values);
    this.go({ on, set }, true);
    // A fit that came in during a search has no standard errors yet.
    this.following = !known?.fitted && this.experiment?.calibration !== null && keyOf(on) !== keyOf(this.step?.effects ?? []);
    // The answer comes first: a fit takes all cores.
    void this.ask("toggle").then(() => {
      if (this.following && keyOf(on) === keyOf(this.view.on)) void this.begin("fit");
    });
  }

  /** A report holds each effect alone and the models of its steps: where the effects together were not computed, one alone is. */
  private toggleSaved(effect: string): void {
    const wanted = this.view.on.includes(effect) ? this.view.on.filter((id) => id !== effect) : [...this.view.on, effect];
    const alone = wanted.includes(effect) ? [effect] : [];
    const on = [wanted, alone, []].find((on) => this.found.has(keyOf(on)));
    const found = on && this.found.get(keyOf(on));
    if (!found) return;
    this.go({ on: found.effects, set: this.difference(found.values) }, true);
    void this.ask("toggle");
  }

  /** Whether a toggle leads to a model that is known. */
  canToggle(effect: string): boolean {
    return !this.saved || this.view.on.includes(effect) || this.found.has(effect);
  }

  /** Bounds of a slider; null where it cannot move. */
  range(parameter: Parameter): [number, number] | null {
    return this.saved ? this.saved.range(this.view.on, parameter.name) : [parameter.min, parameter.max];
  }

  /** Moves a parameter by hand; in a report one at a time, from the fitted values. */
  move(name: string, value: number): void {
    this.touch("slider");
    this.following = false;
    const fitted = this.saved && this.found.get(keyOf(this.view.on));
    this.go({ set: fitted ? this.difference({ ...fitted.values, [name]: value }) : { ...this.view.set, [name]: value } });
    void this.ask("slider");
  }

  /** Fits all parameters again from where they are. */
  refit(): void {
    this.found.delete(keyOf(this.view.on));
    this.following = true;
    void this.begin("fit");
  }

  goTo(at: number, push = true): void {
    const step = this.steps[at];
    if (!step) return;
    this.following = false;
    this.go({ at, on: step.effects, set: {} }, push);
    void this.ask("step");
  }

  async accept(): Promise<void> {
    if (!this.experiment || !this.isChanged()) return;
    // What is accepted stays as it was shown, though a fit may still be on its way.
    this.following = false;
    const before = this.step?.effects ?? [];
    const added = this.view.on.filter((id) => !before.includes(id)).map((id) => `+ ${spoken(id)}`);
    const gone = before.filter((id) => !this.view.on.includes(id)).map((id) => `− ${spoken(id)}`);
    const label = [...added, ...gone].join(", ") || "parameters set by hand";
    const step = { label, parent: this.view.at, effects: this.view.on, values: this.values(), rmse: {} };
    try {
      const { at } = await post<{ at: number }>(`api/experiments/${this.experiment.id}/steps`, step);
      this.steps[at] = { ...step, rmse: this.trial?.rmse ?? {} };
      this.remember();
      this.go({ at, on: step.effects, set: {} }, true);
    } catch (error) {
      this.fail(error);
    }
  }

  async begin(kind: JobKind): Promise<void> {
    if (!this.experiment) return;
    this.error = null;
    // What is accepted belongs to the baseline of a further search.
    const effects = kind === "fit" ? this.view.on : (this.step?.effects ?? []);
    const values = kind === "fit" ? this.values() : {};
    if (kind === "rank") this.diagnosis = null;
    try {
      await post(`api/experiments/${this.experiment.id}/jobs`, { kind, effects, values });
    } catch (error) {
      this.fail(error);
    }
  }

  async stop(kind: JobKind): Promise<void> {
    if (this.experiment) await remove(`api/experiments/${this.experiment.id}/jobs/${kind}`).catch((error) => this.fail(error));
  }

  touch(what: string): void {
    this.touched = { what, at: performance.now() };
  }

  /** Called once the plots of a trial are drawn. */
  drawn(): void {
    if (!this.touched || !this.trial) return;
    this.times.push({ what: this.touched.what, ms: performance.now() - this.touched.at, server: this.trial.milliseconds });
    this.touched = null;
  }

  /** Runs the model; while one answer is awaited, only the last wish counts. */
  async ask(why: string): Promise<void> {
    return this.trials.ask(why);
  }

  /** Takes the soil of the last model of another experiment, as values set by hand. */
  async takeSoil(of: string): Promise<void> {
    try {
      const { steps } = await get<{ steps: Step[] }>(`api/experiments/${of}/steps`);
      const found = steps[steps.length - 1]?.values ?? {};
      const own = [...(this.experiment?.parameters ?? []), ...(this.experiment?.known ?? [])];
      const soil = own.filter(({ name, min, max }) => name.startsWith("soil.") && (found[name] ?? Number.NaN) >= min && (found[name] ?? Number.NaN) <= max);
      if (soil.length === 0) throw new Error("that experiment has no fitted soil yet, or none within the bounds here");
      this.touch("soil");
      this.following = false;
      const taken = Object.fromEntries(soil.map(({ name }) => [name, found[name] as number]));
      this.go({ set: this.difference({ ...this.values(), ...taken }) }, true);
      void this.ask("soil");
    } catch (error) {
      this.fail(error);
    }
  }

  /** Draws the model of another step beside; null for none. */
  compareWith(versus: number | null): void {
    this.go({ versus }, true);
    void this.ask("versus");
  }

  /** The error of a signal of what is shown, among those of all. */
  errorOf(signal: string, rmse: Values | undefined): number | undefined {
    return rmse?.[this.part ? `${this.part.part}.${signal}` : signal];
  }

  /** Error over noise of one signal of what is shown; null where the noise is not known. */
  ratio(signal: string, rmse: Values | undefined): number | null {
    return over(this.errorOf(signal, rmse), this.experiment?.noise[signal]?.value);
  }

  /** Root mean square of error over noise of all signals whose noise is known; of several experiments of all of them. */
  overall(rmse: Values | undefined): number | null {
    return this.whole && together(this.whole, rmse, "");
  }

  /** The same of one of several experiments. */
  overallOf(part: Part, rmse: Values | undefined): number | null {
    return together(part, rmse, `${part.part}.`);
  }

  /** The effects to which others are added: none in a report, which has tried each alone. */
  get accepted(): string[] {
    return this.saved ? [] : (this.step?.effects ?? []);
  }

  /** Fall of chi-square by adding an effect to the accepted ones, as far as a fit is known. */
  gain(effect: string): number | null {
    const accepted = this.accepted;
    const without = this.found.get(keyOf(accepted));
    const withIt = this.found.get(keyOf([...accepted, effect]));
    return without && withIt ? without.chi_square - withIt.chi_square : null;
  }
}

export const store = new Store();
