/** Steps are kept by the server; a tab remembers them too, for a server that was started again. */

import type { Step } from "./types";

/** The effects of a model as one text. */
export function keyOf(effects: string[]): string {
  return [...effects].sort().join("+");
}

function remembered(id: string): Step[] {
  try {
    return JSON.parse(sessionStorage.getItem(`steps of ${id}`) ?? "[]") as Step[];
  } catch {
    return [];
  }
}

export function remember(id: string, steps: Step[]): void {
  try {
    sessionStorage.setItem(`steps of ${id}`, JSON.stringify(steps));
  } catch {
    // Without storage the server alone keeps them.
  }
}

/** Steps of an experiment that this tab remembers beyond those of a server that was started again; none where they are of something else. */
export function missing(id: string | undefined, known: Step[]): Step[] {
  const steps = id ? remembered(id) : [];
  const key = (step: Step | undefined) => step && JSON.stringify([keyOf(step.effects), Object.entries(step.values).sort(), Object.entries(step.rmse).sort()]);
  return known.every((step, at) => key(step) === key(steps[at])) ? steps.slice(known.length) : [];
}
