/** Models that the page asks for as a hand moves: of the server, or of the file that the page is. */

import { post } from "./api";
import { partOf, shownOf } from "./set";
import type { Store } from "./store";
import type { Trial, Values } from "./types";
import { motionOf, trialOf, type WireModel } from "./wire";

export class Trials {
  private asking = false;
  private askAgain = false;
  /** Which model is drawn beside. */
  private otherIs = "";
  private motionTimer = 0;

  constructor(private readonly store: Store) {}

  /** Runs the model; while one answer is awaited, only the last wish counts. */
  async ask(_why: string): Promise<void> {
    if (!this.store.experiment) return;
    if (this.asking) {
      this.askAgain = true;
      return;
    }
    this.asking = true;
    const id = this.store.experiment.id;
    try {
      do {
        this.askAgain = false;
        const part = this.store.view.part;
        const trial = await this.answer(this.store.values(), part);
        if (this.store.experiment?.id !== id) break;
        const another = partOf(this.store.whole, part) !== this.store.part;
        if (!this.store.saved && !another) trial.motion = this.store.trial?.motion ?? [];
        await this.askOther(id, part);
        this.store.show(this.store.whole, part);
        this.store.trial = trial;
        this.store.error = null;
        this.store.changed();
      } while (this.askAgain);
    } catch (error) {
      this.store.fail(error);
    }
    this.asking = false;
    if (this.askAgain) void this.ask("again");
    this.askMotion();
  }

  /** The model that is drawn beside, where there is one and it is not there already. */
  private async askOther(id: string, part: string): Promise<void> {
    const step = this.store.view.versus === null ? undefined : this.store.steps[this.store.view.versus];
    const wanted = step ? JSON.stringify([id, part, this.store.view.versus, this.store.view.axis]) : "";
    if (wanted === this.otherIs && (this.store.other !== null) === Boolean(step)) return;
    this.otherIs = wanted;
    this.store.other = step ? await this.answer(step.values, part) : null;
  }

  /** The model with these values beside the measurements of `part`. */
  private async answer(values: Values, part: string): Promise<Trial> {
    const { whole, view, saved } = this.store;
    if (!whole) throw new Error("no experiment is open");
    const own = partOf(whole, part);
    const experiment = shownOf(whole, own);
    if (!saved) {
      const wire = await post<WireModel>(`api/experiments/${whole.id}/trial`, { values, axis: view.axis, part: own?.part });
      return trialOf(experiment, wire, view.axis);
    }
    const trial = saved.trial(values, view.axis, view.at);
    if (!trial) throw new Error("this report does not hold that model: it holds its steps, and each effect that was tried along its strength");
    return trial;
  }

  /** How the rover moves is asked for once a slider rests: it takes a second simulation. */
  private askMotion(): void {
    clearTimeout(this.motionTimer);
    const { experiment, part } = this.store;
    if (experiment?.kind !== "traverse" || this.store.saved) return;
    this.motionTimer = window.setTimeout(async () => {
      const values = this.store.values();
      try {
        const wire = await post<WireModel>(`api/experiments/${experiment.id}/trial`, { values, motion: true, part: part?.part });
        if (this.store.trial && this.store.experiment?.id === experiment.id && this.store.part?.part === part?.part) {
          this.store.trial = { ...this.store.trial, motion: wire.motion.map(motionOf) };
          this.store.changed();
        }
      } catch (error) {
        this.store.fail(error);
      }
    }, 250);
  }
}
