/** Every window of every run of a traverse at a glance, coloured by the error over the noise; a click shows a window. */

import { useMemo, useState } from "preact/hooks";
import { column, short } from "./format";
import { useStore } from "./hooks";
import { store } from "./store";
import type { Experiment, Trial } from "./types";

/** Runs that are not cut are shown in parts of about this length, s, which is that of a window. */
const LENGTH = 6;
/** From noise to large errors; told apart also by those who do not see red and green. */
const COLOURS: [number, string][] = [[1, "#3b82f6"], [2, "#e8c31e"], [3.5, "#e8871e"], [Number.POSITIVE_INFINITY, "#b3261e"]];

interface Stretch { first: number; last: number; from: number; to: number; ratio: number | null; signal: string }

function stretches(experiment: Experiment, trial: Trial, run: number, of: string): Stretch[] {
  const time = experiment.runs[run]?.data.time ?? [];
  const end = time[time.length - 1] ?? 0;
  const begin = time[0] ?? 0;
  let windows = trial.motion[run]?.windows ?? [];
  if (windows.length < 2) {
    const parts = Math.max(1, Math.round((end - begin) / LENGTH));
    const edge = (k: number) => {
      const at = time.findIndex((t) => (t ?? 0) >= begin + ((end - begin) * k) / parts);
      return at < 0 ? time.length : at;
    };
    windows = Array.from({ length: parts }, (_, k) => [edge(k), k + 1 === parts ? time.length : edge(k + 1)] as [number, number]);
  }
  return windows.map(([first, last]) => {
    let [worst, signal]: [number | null, string] = [null, ""];
    for (const name of of ? [of] : experiment.signals) {
      const own = (trial.runs[run]?.[name]?.residual ?? []).slice(first, last).filter((value) => value !== null);
      const scale = experiment.noise[name]?.value ?? store.errorOf(name, trial.rmse);
      if (own.length === 0 || !scale) continue;
      const ratio = Math.sqrt(own.reduce((sum, value) => sum + value * value, 0) / own.length) / scale;
      if (worst === null || ratio > worst) [worst, signal] = [ratio, name];
    }
    return { first, last, from: time[first] ?? 0, to: time[Math.min(last, time.length - 1)] ?? end, ratio: worst, signal };
  });
}

interface Line { name: string; runs: number[] }

/** Runs that are stretches of one recording, one after the other in its time, share a line. */
function lines(experiment: Experiment): Line[] {
  const all: (Line & { until: number })[] = [];
  experiment.runs.forEach((run, k) => {
    const time = run.data.time ?? [];
    const [from, until] = [time[0] ?? 0, time[time.length - 1] ?? 0];
    const name = run.name.replace(/#\d+$/, "");
    const last = all[all.length - 1];
    if (last && name !== run.name && last.name === name && from > last.until) {
      last.runs.push(k);
      last.until = until;
    } else {
      all.push({ name, runs: [k], until });
    }
  });
  return all.map(({ name, runs }) => ({ name: runs.length > 1 ? name : (experiment.runs[runs[0] ?? 0]?.name ?? name), runs }));
}

export function Windows() {
  const { experiment, trial } = useStore();
  const [of, setOf] = useState("");
  const drive = experiment?.kind === "traverse";
  const all = useMemo(
    () => (experiment && trial && drive ? experiment.runs.map((_, k) => stretches(experiment, trial, k, of)) : []),
    [experiment, trial?.runs, trial?.motion, of],
  );
  if (!experiment || !trial || !drive) return null;
  const longest = Math.max(...experiment.runs.map((run) => run.data.time?.[run.data.time.length - 1] ?? 0), 1e-9);
  const fill = (ratio: number | null) => (ratio === null ? "var(--grid)" : COLOURS.find(([most]) => ratio <= most)?.[1]);
  const known = experiment.signals.every((signal) => experiment.noise[signal]?.value != null);
  const place = (at: number) => `${((100 * at) / longest).toFixed(2)}%`;
  return (
    <section class="card" aria-labelledby="windows">
      <h2 id="windows">Every window of every run</h2>
      <label class="controls">
        Error of{" "}
        <select value={of} onChange={(event) => setOf(event.currentTarget.value)}>
          <option value="">the worst signal</option>
          {experiment.signals.map((signal) => <option key={signal} value={signal}>{column(experiment, signal).name}</option>)}
        </select>
      </label>
      <ul class="windows">
        {lines(experiment).map((line) => (
          <li key={line.runs[0]}>
            <span class="name" title={line.name}>{line.name}</span>
            <span class="bar">
              {line.runs.flatMap((k) => (all[k] ?? []).map((one) => {
                const words = one.ratio === null
                  ? "not counted"
                  : `${column(experiment, one.signal).name} ${short(one.ratio)} times its ${known ? "noise" : "noise or usual error"}`;
                return (
                  <button type="button" key={`${k} ${one.first}`} style={{ left: place(one.from), width: `calc(${place(one.to - one.from)} - 1px)`, background: fill(one.ratio) }}
                    aria-label={`run ${experiment.runs[k]?.name ?? ""}, ${short(one.from)} to ${short(one.to)} s: ${words}`} title={`${short(one.from)} to ${short(one.to)} s: ${words}`}
                    onClick={() => store.go({ run: k, row: one.first, range: [one.from, one.to], a: null, b: null }, true)} />
                );
              }))}
            </span>
          </li>
        ))}
      </ul>
      <p class="legend">
        {["noise", "twice", "three times", "more"].map((word, k) => <span key={word}><i class="swatch" style={{ background: COLOURS[k]?.[1] }} />{word}</span>)}
        <span><i class="swatch" style={{ background: "var(--grid)" }} />not counted</span>
      </p>
    </section>
  );
}
