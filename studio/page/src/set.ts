/** Several experiments on one soil: which of them is shown, where effects act, and whose parameters are whose. */

import { spoken } from "./format";
import type { EffectInfo, Experiment, Parameter, Part } from "./types";

/** The one of several experiments that is called so, or the first; null where there is one experiment. */
export function partOf(whole: Experiment | null, name: string): Part | null {
  return whole?.parts.find((part) => part.part === name) ?? whole?.parts[0] ?? null;
}

/** All that is known of several experiments, with the measurements of one of them. */
export function shownOf(whole: Experiment, part: Part | null): Experiment {
  return part ? { ...whole, ...part, name: whole.name } : whole;
}

/** Effects by their plain names: one entry for each place in which it may act. */
export function families(effects: EffectInfo[]): EffectInfo[][] {
  const all = new Map<string, EffectInfo[]>();
  for (const effect of effects) {
    const known = all.get(effect.plain);
    if (known) known.push(effect);
    else all.set(effect.plain, [effect]);
  }
  return [...all.values()];
}

/** Where an effect acts, in words. */
export function placeOf(effect: EffectInfo, whole: Experiment): string {
  const parts = effect.parts ?? [];
  if (parts.length === whole.parts.length) return "in all experiments";
  return `in ${parts.join(" and ")}`;
}

/** A parameter's name without where it acts. */
export function plainName({ name, parts }: Parameter): string {
  const suffixes = (parts ?? []).map((part) => ` in ${part}`);
  const found = suffixes.find((suffix) => name.includes(suffix));
  return spoken(found ? name.replace(found, "") : name);
}
