/** From what a server sends or a saved file holds to what the page draws. */

import type { Curves, Experiment, Measured, Motion, Numbers, Trial } from "./types";

/** Numbers as they are, or rounded to whole numbers of two bytes: offset + step × number. */
export type Packed = Numbers | { o: number; s: number; w: string };
/** Several arrays as their differences from one of them, in whole numbers of one byte or of two. */
export interface Differences { s: number; b?: string; w?: string }

function bytes(text: string): Uint8Array {
  return Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
}

export function numbers(packed: Packed): Numbers {
  if (Array.isArray(packed)) return packed;
  const view = new DataView(bytes(packed.w).buffer);
  return Array.from({ length: view.byteLength / 2 }, (_, k) => {
    const word = view.getInt16(2 * k, true);
    return word === -32768 ? null : packed.o + packed.s * word;
  });
}

/** The differences of each of `count` arrays. */
export function differences({ s, b, w }: Differences, count: number): Numbers[] {
  const view = new DataView(bytes(b ?? w ?? "").buffer);
  const size = b === undefined ? 2 : 1;
  const missing = size === 2 ? -32768 : -128;
  const length = view.byteLength / size / count;
  const word = (k: number) => (size === 2 ? view.getInt16(2 * k, true) : view.getInt8(k));
  const of = (from: number) => Array.from({ length }, (_, k) => (word(from + k) === missing ? null : s * word(from + k)));
  return Array.from({ length: count }, (_, k) => of(k * length));
}

export interface WireCurves {
  axis: string;
  groups: { name: string; rows: [number, number][]; at: Packed; signals: Record<string, { value: Packed; band: [Packed, Packed] | null }> | null }[];
}

export interface WireMotion {
  windows: [number, number][];
  x: Packed;
  z: Packed;
  pitch: Packed;
  centres: [Packed, Packed][];
  radius: number;
  slip: Packed[];
  load: Packed[];
  ground: Packed;
}

/** A model as it is sent. */
export interface WireModel extends Omit<Trial, "runs" | "curves" | "motion"> {
  runs: Record<string, Packed>[];
  curves: Record<string, WireCurves>;
  motion: WireMotion[];
}

export function experimentOf(wire: Experiment): Experiment {
  return { ...measuredOf(wire), parts: wire.parts.map(measuredOf) };
}

function measuredOf<M extends Measured>(wire: M): M {
  const columns = (all: Record<string, Packed>) => Object.fromEntries(Object.entries(all).map(([name, packed]) => [name, numbers(packed)]));
  return { ...wire, runs: wire.runs.map((run) => ({ ...run, data: columns(run.data), terrain: run.terrain && columns(run.terrain) })) };
}

/** Measured less modelled of the rows that count. */
export function residuals(experiment: Experiment, run: number, signal: string, modelled: Numbers): Numbers {
  const own = experiment.runs[run];
  const measured = own?.data[signal] ?? [];
  const residual = modelled.map((value, row) => {
    const known = measured[row];
    return value === null || known == null ? null : known - value;
  });
  for (const rows of experiment.uncounted) if (rows.run === own?.name) residual.fill(null, rows.first - 1, rows.last);
  return residual;
}

export function curvesOf(wire: WireCurves | undefined): Curves | null {
  if (!wire) return null;
  const signals = (all: WireCurves["groups"][number]["signals"]) =>
    all && Object.fromEntries(Object.entries(all).map(([signal, { value, band }]) =>
      [signal, { value: numbers(value), band: band && [numbers(band[0]), numbers(band[1])] as [Numbers, Numbers] }]));
  return { axis: wire.axis, groups: wire.groups.map((group) => ({ ...group, at: numbers(group.at), signals: signals(group.signals) })) };
}

export function motionOf(wire: WireMotion): Motion {
  const all = (list: Packed[]) => list.map(numbers);
  const centres = wire.centres.map(([x, z]) => [numbers(x), numbers(z)] as [Numbers, Numbers]);
  const rows = wire.windows.length ? (centres[0]?.[0].length ?? 0) : 0;
  return {
    ...wire,
    x: numbers(wire.x),
    z: numbers(wire.z),
    pitch: numbers(wire.pitch),
    centres: Array.from({ length: rows }, (_, row) => centres.map(([x, z]) => [x[row] ?? null, z[row] ?? null])),
    slip: all(wire.slip),
    load: all(wire.load),
    ground: numbers(wire.ground),
  };
}

export function trialOf(experiment: Experiment, wire: WireModel, axis: string): Trial {
  const signals = (run: Record<string, Packed>, number: number) =>
    Object.fromEntries(Object.entries(run).map(([signal, packed]) => {
      const modelled = numbers(packed);
      return [signal, { modelled, residual: residuals(experiment, number, signal, modelled) }];
    }));
  return { ...wire, runs: wire.runs.map(signals), curves: curvesOf(wire.curves[axis]), motion: wire.motion.map(motionOf) };
}
