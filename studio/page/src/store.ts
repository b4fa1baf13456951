/** The state of the page: what the address says, and what the server knows. */

import { get, post, remove } from "./api";
import { readView, sameView, writeView, type View } from "./address";
import type { Diagnosis, Experiment, Found, Job, JobKind, Listed, Parameter, Separation, Snapshot, Step, Trial, Values } from "./types";

/** Share of a noise floor above which an error is more than noise. */
export const AT_NOISE = 1.25;

export class Store {
  view: View = readView();
  listed: Listed | null = null;
  experiment: Experiment | null = null;
  steps: Step[] = [];
  found = new Map<string, Found>();
  diagnosis: Diagnosis | null = null;
  separation: Separation | null = null;
  jobs = new Map<JobKind, Job>();
  trial: Trial | null = null;
  error: string | null = null;
  connected = true;
  /** Whether the values follow the fit of the effects that are on, once it is there. */
  following = false;
  /** Times from a toggle or a slider to the redrawn page, ms; the test in a browser reads them. */
  times: { what: string; ms: number; server: number }[] = [];

  private listeners = new Set<() => void>();
  private events: EventSource | null = null;
  private asking = false;
  private askAgain = false;
  private touched: { what: string; at: number } | null = null;
  private motionTimer = 0;

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
    this.experiment = null;
    this.trial = null;
    this.steps = [];
    this.found.clear();
    this.jobs.clear();
    this.diagnosis = null;
    this.separation = null;
    this.changed();
    try {
      this.experiment = await get<Experiment>(`api/experiments/${id}`);
    } catch (error) {
      return this.fail(error);
    }
    this.listen(id);
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
    on<Snapshot>("snapshot", (data) => this.take(data));
    on<Job>("job", (job) => {
      if (job.running) this.jobs.set(job.kind, job);
      else this.jobs.delete(job.kind);
      if (job.error && job.error !== "stopped") this.error = job.error;
    });
    on<Found>("fit", (found) => this.takeFit(found));
    on<{ at: number; step: Step }>("step", ({ at, step }) => {
      this.steps[at] = step;
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
    this.experiment = await get<Experiment>(`api/experiments/${this.experiment.id}`);
    this.changed();
  }

  private take(data: Snapshot): void {
    this.steps = data.steps;
    this.found = new Map(data.found.map((found) => [keyOf(found.effects), found]));
    this.diagnosis = data.diagnosis;
    this.separation = data.separation;
    this.jobs = new Map(data.jobs.map((job) => [job.kind, job]));
    if (this.view.at >= this.steps.length) this.view = { ...this.view, at: this.steps.length - 1 };
    // Who comes without an address sees the calibrated model, which may be there already.
    const fresh = this.view.at === 0 && !this.isChanged() && !location.hash.includes("at=");
    if (fresh && this.steps.length > 1) this.goTo(1, false);
    else if (!this.trial) void this.ask("load");
    if (this.steps.length === 1 && !this.jobs.has("calibrate") && !this.experiment?.calibration) void this.begin("calibrate");
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
    const on = this.view.on.includes(effect) ? this.view.on.filter((id) => id !== effect) : [...this.view.on, effect];
    const known = this.found.get(keyOf(on));
    let set: Values;
    if (keyOf(on) === keyOf(this.step?.effects ?? [])) set = {};
    else if (known) set = this.difference(known.values);
    else {
      set = { ...this.view.set };
      for (const parameter of this.parametersOf(effect)) {
        if (on.includes(effect)) set[parameter.name] = parameter.typical;
        else delete set[parameter.name];
      }
    }
    this.go({ on, set }, true);
    // A fit that came in during a search has no standard errors yet.
    this.following = !known?.fitted && this.experiment?.calibration !== null && keyOf(on) !== keyOf(this.step?.effects ?? []);
    // The answer comes first: a fit takes all cores.
    void this.ask("toggle").then(() => {
      if (this.following && keyOf(on) === keyOf(this.view.on)) void this.begin("fit");
    });
  }

  /** Moves a parameter by hand. */
  move(name: string, value: number): void {
    this.touch("slider");
    this.following = false;
    this.go({ set: { ...this.view.set, [name]: value } });
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
    const added = this.view.on.filter((id) => !before.includes(id)).map((id) => `+ ${id.replaceAll("_", " ")}`);
    const gone = before.filter((id) => !this.view.on.includes(id)).map((id) => `− ${id.replaceAll("_", " ")}`);
    const label = [...added, ...gone].join(", ") || "parameters set by hand";
    const step = { label, parent: this.view.at, effects: this.view.on, values: this.values(), rmse: {} };
    try {
      const { at } = await post<{ at: number }>(`api/experiments/${this.experiment.id}/steps`, step);
      this.steps[at] = { ...step, rmse: this.trial?.rmse ?? {} };
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
  async ask(_why: string): Promise<void> {
    if (!this.experiment) return;
    if (this.asking) {
      this.askAgain = true;
      return;
    }
    this.asking = true;
    const id = this.experiment.id;
    try {
      do {
        this.askAgain = false;
        const trial = await post<Trial>(`api/experiments/${id}/trial`, { values: this.values(), axis: this.view.axis });
        if (this.experiment?.id !== id) break;
        trial.motion = this.trial?.motion ?? [];
        this.trial = trial;
        this.error = null;
        this.changed();
      } while (this.askAgain);
    } catch (error) {
      this.fail(error);
    }
    this.asking = false;
    if (this.askAgain) void this.ask("again");
    this.askMotion();
  }

  /** How the rover moves is asked for once a slider rests: it takes a second simulation. */
  private askMotion(): void {
    const experiment = this.experiment;
    if (experiment?.kind !== "traverse") return;
    clearTimeout(this.motionTimer);
    this.motionTimer = window.setTimeout(async () => {
      const values = this.values();
      try {
        const trial = await post<Trial>(`api/experiments/${experiment.id}/trial`, { values, motion: true });
        if (this.trial && this.experiment?.id === experiment.id) {
          this.trial = { ...this.trial, motion: trial.motion };
          this.changed();
        }
      } catch (error) {
        this.fail(error);
      }
    }, 250);
  }

  /** Error over noise of one signal; null where the noise is not known. */
  ratio(signal: string, rmse: Values | undefined): number | null {
    const noise = this.experiment?.noise[signal]?.value ?? null;
    const error = rmse?.[signal];
    return noise === null || error === undefined || noise <= 0 ? null : error / noise;
  }

  /** Root mean square of error over noise of all signals whose noise is known. */
  overall(rmse: Values | undefined): number | null {
    const ratios = (this.experiment?.signals ?? []).map((signal) => this.ratio(signal, rmse)).filter((r) => r !== null);
    return ratios.length ? Math.sqrt(ratios.reduce((sum, ratio) => sum + ratio * ratio, 0) / ratios.length) : null;
  }

  /** Fall of chi-square by adding an effect to the accepted ones, as far as a fit is known. */
  gain(effect: string): number | null {
    const accepted = this.step?.effects ?? [];
    const without = this.found.get(keyOf(accepted));
    const withIt = this.found.get(keyOf([...accepted, effect]));
    return without && withIt ? without.chi_square - withIt.chi_square : null;
  }
}

export function keyOf(effects: string[]): string {
  return [...effects].sort().join("+");
}

export const store = new Store();
