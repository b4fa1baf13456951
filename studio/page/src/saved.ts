/** A saved report: the models of its steps, and the model along the strength of each effect that was tried, between whose values the
 * page interpolates. It answers in the place of a server. */

import { differences, experimentOf, numbers, residuals, trialOf, type Differences, type Packed, type WireModel } from "./wire";
import type { Curves, Experiment, Numbers, Snapshot, Trial, Values } from "./types";

interface Steps { base: Packed; others: Differences }

interface Response {
  effects: string[];
  parameter: string;
  values: Values;
  strengths: number[];
  /** Which strength the differences are from. */
  base: number;
  /** Mean products of the residuals at each two strengths, by signal. */
  products: Record<string, number[][]>;
  runs: Record<string, Steps>[];
  curves: Record<string, Record<string, Steps>[]>;
  largest_error: Values;
  rounding: Values;
}

interface Data {
  experiment: Experiment;
  snapshot: Snapshot;
  models: WireModel[];
  responses: Response[];
  rows: { kept: number; of: number };
}

/** Weights of the values at `strengths` for one at `at`: the cubic through the four nearest. The library measures the error of the same. */
export function weightsAt(strengths: number[], at: number): number[] {
  const weights = new Array<number>(strengths.length).fill(0);
  const points = Math.min(4, strengths.length);
  const found = strengths.findIndex((strength) => strength >= at);
  const above = found < 0 ? strengths.length : found;
  const first = Math.min(Math.max(0, above - Math.floor(points / 2)), strengths.length - points);
  const own = strengths.slice(first, first + points);
  own.forEach((x, j) => {
    weights[first + j] = own.reduce((product, other, k) => (k === j ? product : (product * (at - other)) / (x - other)), 1);
  });
  return weights;
}

/** base + the weighted differences. */
function mixed({ base, others }: Steps, weights: number[]): Numbers {
  const values = numbers(base);
  const all = differences(others, weights.length);
  const acting = weights.map((weight, k) => [weight, all[k]] as const).filter(([weight]) => weight !== 0);
  return values.map((value, row) => {
    if (value === null) return null;
    let sum = value;
    for (const [weight, difference] of acting) {
      const own = difference?.[row];
      if (own == null) return null;
      sum += weight * own;
    }
    return sum;
  });
}

export class Saved {
  readonly experiment: Experiment;

  constructor(private readonly data: Data) {
    this.experiment = experimentOf(data.experiment);
  }

  get snapshot(): Snapshot {
    return this.data.snapshot;
  }

  get rows(): { kept: number; of: number } {
    return this.data.rows;
  }

  /** The range in which a strength was computed while these effects act; null where it was not. */
  range(on: string[], parameter: string): [number, number] | null {
    const own = this.responses(on).find((response) => response.parameter === parameter);
    const [low, high] = [own?.strengths[0], own?.strengths[own.strengths.length - 1]];
    return low === undefined || high === undefined ? null : [low, high];
  }

  /** What was computed while exactly these effects act. */
  responses(on: string[]): Response[] {
    const key = [...on].sort().join("+");
    return this.data.responses.filter((response) => [...response.effects].sort().join("+") === key);
  }

  /** How far curves may be from a simulation, in the worst of the effects: interpolation and rounding together. */
  worst(): { effects: string[]; signal: string; error: number; ratio: number | null } | null {
    let worst = null;
    for (const { effects, largest_error, rounding } of this.data.responses) {
      for (const [signal, interpolation] of Object.entries(largest_error)) {
        const error = interpolation + (rounding[signal] ?? 0);
        const noise = this.experiment.noise[signal]?.value;
        const ratio = noise ? error / noise : null;
        if (!worst || (ratio ?? -1) > (worst.ratio ?? -1)) worst = { effects, signal, error, ratio };
      }
    }
    return worst;
  }

  /** The model with these values; null where it was not computed in advance. */
  trial(values: Values, axis: string, at: number): Trial | null {
    const same = (known: Values, but?: string) => {
      const names = new Set([...Object.keys(known), ...Object.keys(values)]);
      names.delete(but ?? "");
      return [...names].every((name) => (known[name] ?? this.start(name)) === (values[name] ?? this.start(name)));
    };
    const step = this.snapshot.steps.findIndex((known) => same(known.values));
    const stored = this.data.models[step];
    if (stored) return trialOf(this.experiment, { ...stored, milliseconds: 0 }, axis);
    const response = this.data.responses.find((known) => same(known.values, known.parameter));
    const shown = this.data.models[at];
    if (!response || !shown) return null;
    return this.between(response, values[response.parameter] ?? this.start(response.parameter) ?? 0, axis, trialOf(this.experiment, shown, axis));
  }

  private start(name: string): number | undefined {
    return this.experiment.parameters.find((parameter) => parameter.name === name)?.start;
  }

  private between(response: Response, strength: number, axis: string, step: Trial): Trial {
    const weights = weightsAt(response.strengths, strength);
    const square = (products: number[][]) =>
      products.reduce((sum, row, j) => sum + row.reduce((part, cell, k) => part + (weights[j] ?? 0) * (weights[k] ?? 0) * cell, 0), 0);
    const rmse = Object.fromEntries(Object.entries(response.products).map(([signal, products]) => [signal, Math.sqrt(Math.max(0, square(products)))]));
    const runs = response.runs.map((run, number) =>
      Object.fromEntries(Object.entries(run).map(([signal, steps]) => {
        const modelled = mixed(steps, weights);
        return [signal, { modelled, residual: residuals(this.experiment, number, signal, modelled) }];
      })));
    const own = response.curves[axis];
    const curves: Curves | null = step.curves && own
      ? { ...step.curves, groups: step.curves.groups.map((group, k) => ({ ...group, signals: this.curves(own[k], weights) })) }
      : step.curves;
    // Failures in words and the motion belong to simulated models only.
    return { rmse, runs, curves, unanswered: [], failures: null, motion: step.motion, milliseconds: 0 };
  }

  private curves(signals: Record<string, Steps> | undefined, weights: number[]): Curves["groups"][number]["signals"] {
    return Object.fromEntries(Object.entries(signals ?? {}).map(([signal, steps]) => [signal, { value: mixed(steps, weights), band: null }]));
  }
}

/** The report that this page holds; null where a server answers. */
export function embedded(): Saved | null {
  const text = document.getElementById("saved")?.textContent;
  return text ? new Saved(JSON.parse(text) as Data) : null;
}

