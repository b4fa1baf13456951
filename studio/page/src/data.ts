/** From an experiment and a trial to the series of plots. */

import type { Experiment, Numbers, Trial } from "./types";
import { colour } from "./hooks";

export interface Series {
  label: string;
  values: Numbers;
  stroke: string;
  /** Points of measurements, or the line of a model. */
  points: boolean;
  dash?: number[];
  width?: number;
}

export interface PlotData {
  x: number[];
  series: Series[];
}

/** The series of one signal of a wheel on a carriage: points by group, and the model as a curve in the group's colour. */
export function steady(experiment: Experiment, trial: Trial, signal: string, dark: boolean): PlotData {
  const curves = trial.curves;
  const table: { label: string; at: Numbers; values: Numbers; points: boolean; group: number }[] = [];
  const factor = experiment.columns[signal]?.factor ?? 1;
  const xFactor = experiment.columns[curves?.axis ?? "slip"]?.factor ?? 1;
  const scaled = (values: Numbers, by: number) => values.map((value) => (value === null ? null : value * by));
  for (const [group, { name, rows, at, signals }] of (curves?.groups ?? []).entries()) {
    // Rows at the same place stand one upon the other: repeats go into layers of their own.
    const layers: [number, number][][] = [];
    const seen = new Map<number, number>();
    for (const [run, row] of rows) {
      const x = experiment.runs[run]?.data[curves?.axis ?? "slip"]?.[row];
      const y = experiment.runs[run]?.data[signal]?.[row];
      if (x === null || x === undefined || y === null || y === undefined) continue;
      const layer = seen.get(x) ?? 0;
      seen.set(x, layer + 1);
      (layers[layer] ??= []).push([x * xFactor, y * factor]);
    }
    for (const layer of layers) {
      layer.sort((p, q) => p[0] - q[0]);
      table.push({ label: name, at: layer.map((p) => p[0]), values: layer.map((p) => p[1]), points: true, group });
    }
    const curve = signals?.[signal];
    if (curve) table.push({ label: name, at: scaled(at, xFactor), values: scaled(curve, factor), points: false, group });
  }
  return joined(table, dark);
}

/** Puts series with places of their own over one common axis. */
function joined(table: { label: string; at: Numbers; values: Numbers; points: boolean; group: number }[], dark: boolean): PlotData {
  const x = [...new Set(table.flatMap((one) => one.at as number[]))].sort((p, q) => p - q);
  const place = new Map(x.map((value, index) => [value, index]));
  const series = table.map((one) => {
    // `undefined` joins the neighbours of a curve over places of other series; null would be a gap.
    const values = new Array(x.length).fill(one.points ? null : undefined) as Numbers;
    one.at.forEach((at, k) => {
      const index = place.get(at as number);
      if (index !== undefined) values[index] = one.values[k] ?? null;
    });
    return { label: one.label, values, stroke: colour(one.group, dark), points: one.points, width: 2 };
  });
  return { x, series };
}

/** The series of one signal of a traverse over time. */
export function overTime(experiment: Experiment, trial: Trial, run: number, signal: string, dark: boolean): PlotData {
  const data = experiment.runs[run]?.data ?? {};
  const factor = experiment.columns[signal]?.factor ?? 1;
  const scaled = (values: Numbers | undefined) => (values ?? []).map((value) => (value === null ? null : value * factor));
  return {
    x: (data.time ?? []).map((time) => time ?? 0),
    series: [
      { label: "measured", values: scaled(data[signal]), stroke: colour(6, dark), points: false, width: 1.5 },
      { label: "model", values: scaled(trial.runs[run]?.[signal]?.modelled), stroke: colour(1, dark), points: false, width: 2 },
    ],
  };
}

/** Places where a value may be read: by linear interpolation between its neighbours. */
export function valueAt(x: number[], values: Numbers, at: number): number | null {
  let before = -1;
  for (let k = 0; k < x.length; k += 1) {
    const here = x[k] as number;
    const value = values[k];
    if (value === null || value === undefined) continue;
    if (here < at) before = k;
    else {
      if (here === at || before < 0) return here === at ? value : null;
      const [x0, y0] = [x[before] as number, values[before] as number];
      return y0 + ((at - x0) / (here - x0)) * (value - y0);
    }
  }
  return null;
}
