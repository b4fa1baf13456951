/** From an experiment and a trial to the series of plots. */

import type { Experiment, Numbers, Trial } from "./types";
import { colour } from "./hooks";

export interface Series {
  label: string;
  values: Numbers;
  stroke: string;
  /** Points of measurements, or the line of a model. */
  points: boolean;
  dash?: number[] | undefined;
  width?: number;
  /** Half the length of an error bar at each place. */
  spread?: Numbers | undefined;
  /** Lowest and highest values of a band about it. */
  band?: [Numbers, Numbers] | undefined;
  /** Which of two models it is. */
  other?: boolean;
}

export interface PlotData {
  x: number[];
  series: Series[];
}

/** A series with places of its own. */
export interface Placed extends Omit<Series, "stroke"> {
  at: Numbers;
  group: number;
}

const DASH = [6, 4];

function scaledBy(factor: number): (values: Numbers) => Numbers {
  return (values) => values.map((value) => (value === null ? null : value * factor));
}

/** The series of one signal of a wheel on a carriage: points by group, and the models as curves in the group's colour. */
export function steady(experiment: Experiment, trial: Trial, other: Trial | null, signal: string, dark: boolean): PlotData {
  const table: Placed[] = [];
  const axis = trial.curves?.axis ?? "slip";
  const factor = experiment.columns[signal]?.factor ?? 1;
  const xFactor = experiment.columns[axis]?.factor ?? 1;
  const scaled = scaledBy(factor);
  const noise = experiment.noise[signal]?.value ?? null;
  const draw = (curves: Trial["curves"], second: boolean) => {
    for (const [group, { name, at, signals }] of (curves?.groups ?? []).entries()) {
      const curve = signals?.[signal];
      if (!curve) continue;
      const band: [Numbers, Numbers] | undefined = curve.band && !second ? [scaled(curve.band[0]), scaled(curve.band[1])] : undefined;
      const dash = second ? DASH : undefined;
      table.push({ label: name, at: scaledBy(xFactor)(at), values: scaled(curve.value), points: false, group, band, dash, width: second ? 1.5 : 2, other: second });
    }
  };
  draw(other?.curves ?? null, true);
  draw(trial.curves, false);
  for (const [group, { name, rows }] of (trial.curves?.groups ?? []).entries()) {
    // Rows at the same place stand one upon the other: repeats go into layers of their own.
    const layers: [number, number][][] = [];
    const seen = new Map<number, number>();
    for (const [run, row] of rows) {
      const x = experiment.runs[run]?.data[axis]?.[row];
      const y = experiment.runs[run]?.data[signal]?.[row];
      if (x === null || x === undefined || y === null || y === undefined) continue;
      const layer = seen.get(x) ?? 0;
      seen.set(x, layer + 1);
      (layers[layer] ??= []).push([x * xFactor, y * factor]);
    }
    for (const layer of layers) {
      layer.sort((p, q) => p[0] - q[0]);
      const spread = noise === null ? undefined : layer.map(() => 2 * noise * factor);
      table.push({ label: name, at: layer.map((p) => p[0]), values: layer.map((p) => p[1]), points: true, group, spread });
    }
  }
  return joined(table, (group) => colour(group, dark));
}

/** Puts series with places of their own over one common axis. */
export function joined(table: Placed[], stroke: (group: number) => string): PlotData {
  const x = [...new Set(table.flatMap((one) => one.at as number[]))].sort((p, q) => p - q);
  const place = new Map(x.map((value, index) => [value, index]));
  const series = table.map(({ at, group, ...one }) => {
    // `undefined` joins the neighbours of a curve over places of other series; null would be a gap.
    const spreadOut = (own: Numbers, between: null | undefined) => {
      const values = new Array(x.length).fill(between) as Numbers;
      at.forEach((here, k) => {
        const index = place.get(here as number);
        if (index !== undefined) values[index] = own[k] ?? null;
      });
      return values;
    };
    const between = one.points ? null : undefined;
    return {
      ...one,
      values: spreadOut(one.values, between),
      spread: one.spread && spreadOut(one.spread, null),
      band: one.band && ([spreadOut(one.band[0], undefined), spreadOut(one.band[1], undefined)] as [Numbers, Numbers]),
      stroke: stroke(group),
    };
  });
  return { x, series };
}

/** The series of one signal of a traverse over time: measured, the model, and where there is one another model. */
export function overTime(experiment: Experiment, trial: Trial, other: Trial | null, run: number, signal: string, dark: boolean): PlotData {
  const data = experiment.runs[run]?.data ?? {};
  const factor = experiment.columns[signal]?.factor ?? 1;
  const scaled = scaledBy(factor);
  const measured = scaled(data[signal] ?? []);
  const noise = experiment.noise[signal]?.value ?? null;
  const shifted = (by: number) => measured.map((value) => (value === null ? null : value + by));
  const band: [Numbers, Numbers] | undefined = noise === null ? undefined : [shifted(-2 * noise * factor), shifted(2 * noise * factor)];
  const model = (own: Trial) => scaled(own.runs[run]?.[signal]?.modelled ?? []);
  const series: Series[] = [
    { label: "measured", values: measured, stroke: colour(6, dark), points: false, width: 1.5, band },
    { label: "model", values: model(trial), stroke: colour(1, dark), points: false, width: 2 },
  ];
  if (other) series.push({ label: "other model", values: model(other), stroke: colour(0, dark), points: false, width: 1.5, dash: DASH, other: true });
  return { x: (data.time ?? []).map((time) => time ?? 0), series };
}

/** The value at a place: by linear interpolation between the neighbours that have one. */
export function valueAt(x: number[], values: Numbers, at: number): number | null {
  let [low, high] = [0, x.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if ((x[middle] as number) < at) low = middle + 1;
    else high = middle;
  }
  let [after, before] = [low, low - 1];
  while (after < x.length && values[after] == null) after += 1;
  while (before >= 0 && values[before] == null) before -= 1;
  const [x1, y1] = [x[after], values[after]];
  if (x1 === undefined || y1 == null) return null;
  if (x1 === at) return y1;
  const [x0, y0] = [x[before], values[before]];
  return x0 === undefined || y0 == null ? null : y0 + ((at - x0) / (x1 - x0)) * (y1 - y0);
}
