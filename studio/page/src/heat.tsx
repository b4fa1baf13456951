/** Where the model fails: in words, and as a map of mean residuals over two conditions. */

import { useMemo } from "preact/hooks";
import { course } from "./data";
import { column, quantity, short } from "./format";
import { useStore } from "./hooks";
import { store } from "./store";
import type { Experiment, ForPeople, Numbers, Trial } from "./types";

/** Up to this many different values are levels of their own; more are put into classes of equal width. */
const LEVELS = 9;
const CLASSES = 8;

interface Condition {
  key: string;
  people: ForPeople;
  values: (run: number) => Numbers;
}

function conditions(experiment: Experiment, trial: Trial): Condition[] {
  const names = [...new Set(experiment.runs.flatMap((run) => Object.keys(run.data)))];
  const all: Condition[] = names.map((name) => ({
    key: name,
    people: column(experiment, name),
    values: (run) => experiment.runs[run]?.data[name] ?? [],
  }));
  const wheels = trial.motion[0]?.slip.length ?? 0;
  for (let wheel = 0; wheel < wheels; wheel += 1) {
    all.push({ key: `model slip ${wheel + 1}`, people: { name: `slip of wheel ${wheel + 1} (model)`, unit: "%", factor: 100 }, values: (run) => trial.motion[run]?.slip[wheel] ?? [] });
    all.push({ key: `model load ${wheel + 1}`, people: { name: `load of wheel ${wheel + 1} (model)`, unit: "N", factor: 1 }, values: (run) => trial.motion[run]?.load[wheel] ?? [] });
  }
  return all;
}

/** Edges of classes: place of a value, and the words for each. */
function classes(values: number[], people: ForPeople): { of: (value: number) => number; names: string[] } {
  const sorted = [...new Set(values)].sort((p, q) => p - q);
  const [low, high] = [sorted[0] ?? 0, sorted[sorted.length - 1] ?? 1];
  const gap = 0.02 * (high - low || 1);
  const levels: number[][] = [];
  for (const value of sorted) {
    const last = levels[levels.length - 1];
    if (last && value - (last[last.length - 1] ?? 0) <= gap) last.push(value);
    else levels.push([value]);
  }
  const name = (value: number) => short(value * people.factor);
  // A cloud in which every value has a neighbour is no row of set-points.
  const widest = levels.reduce((most, level) => Math.max(most, (level[level.length - 1] ?? 0) - (level[0] ?? 0)), 0);
  if (levels.length <= LEVELS && widest <= 3 * gap) {
    const middles = levels.map((level) => ((level[0] ?? 0) + (level[level.length - 1] ?? 0)) / 2);
    const of = (value: number) => levels.findIndex((level) => value >= (level[0] ?? 0) && value <= (level[level.length - 1] ?? 0));
    return { of, names: middles.map(name) };
  }
  const edge = (k: number) => low + ((high - low) * k) / CLASSES;
  const names = Array.from({ length: CLASSES }, (_, k) => `${name(edge(k))} to ${name(edge(k + 1))}`);
  return { of: (value) => Math.min(CLASSES - 1, Math.floor((CLASSES * (value - low)) / (high - low))), names };
}

interface Cell { sum: number; count: number }

interface Cells { across: string[]; upward: string[]; cells: Cell[][] }

/** Mean residuals by class of two conditions; null where nothing was recorded. */
function cellsOf(trial: Trial, signal: string, x: Condition, y: Condition): Cells | null {
  const samples: [number, number, number][] = [];
  trial.runs.forEach((run, k) => {
    const [xs, ys] = [x.values(k), y.values(k)];
    run[signal]?.residual.forEach((residual, row) => {
      const [at, up] = [xs[row], ys[row]];
      if (residual !== null && at != null && up != null) samples.push([at, up, residual]);
    });
  });
  if (samples.length === 0) return null;
  const [across, upward] = [classes(samples.map((one) => one[0]), x.people), classes(samples.map((one) => one[1]), y.people)];
  const cells: Cell[][] = upward.names.map(() => across.names.map(() => ({ sum: 0, count: 0 })));
  for (const [at, up, residual] of samples) {
    const cell = cells[upward.of(up)]?.[across.of(at)];
    if (cell) {
      cell.sum += residual;
      cell.count += 1;
    }
  }
  return { across: across.names, upward: upward.names, cells };
}

function Map({ experiment, trial, signal, x, y }: { experiment: Experiment; trial: Trial; signal: string; x: Condition; y: Condition }) {
  const found = useMemo(() => cellsOf(trial, signal, x, y), [experiment, trial.runs, trial.motion, signal, x.key, y.key]);
  if (!found) return <p>There is nothing to map: these conditions were not recorded beside this signal.</p>;
  const { across, upward, cells } = found;
  const shown = column(experiment, signal);
  const noise = experiment.noise[signal]?.value ?? store.errorOf(signal, trial.rmse) ?? 1;
  const known = experiment.noise[signal]?.value != null;
  return (
    <>
      <p class="hint" id="heat">Mean of measured less modelled {shown.name}, in multiples of {known ? "the noise of one measurement" : "its usual error (noise unknown)"}</p>
      <div class="scroll" tabIndex={0} role="region" aria-labelledby="heat">
        <table class="heat" aria-labelledby="heat">
          <thead>
            <tr>
              <th scope="col">{y.people.name}{y.people.unit && `, ${y.people.unit}`} ↓ {x.people.name}{x.people.unit && `, ${x.people.unit}`} →</th>
              {across.map((name) => <th scope="col" key={name}>{name}</th>)}
            </tr>
          </thead>
          <tbody>
            {cells.map((row, k) => (
              <tr key={upward[k]}>
                <th scope="row">{upward[k]}</th>
                {row.map((cell, j) => {
                  if (cell.count === 0) return <td key={across[j]} class="none">·</td>;
                  const mean = cell.sum / cell.count / noise;
                  const strength = Math.min(1, Math.abs(mean) / 4);
                  return (
                    <td key={across[j]} class={mean < 0 ? "less" : "more"} style={{ "--strength": strength }} title={`${quantity(cell.sum / cell.count, shown)}, ${cell.count} measurements`}>
                      {mean > 0 ? "+" : mean < 0 ? "−" : ""}{Math.abs(mean).toFixed(1)}
                    </td>
                  );
                })}
              </tr>
            ))}
          </tbody>
        </table>
      </div>
    </>
  );
}

export function Failures() {
  const { experiment, part, trial, view } = useStore();
  if (!experiment || !trial) return null;
  const all = conditions(experiment, trial);
  const drive = experiment.kind === "traverse";
  const usual = drive ? (trial.motion.length ? ["model slip 1", "model load 1"] : ["time", "x"]) : [course(experiment) ?? "slip", course(experiment) ? "normal_stress" : "load"];
  const find = (key: string, otherwise: string | undefined) => all.find((one) => one.key === key) ?? all.find((one) => one.key === otherwise) ?? all[0];
  const signal = experiment.signals.includes(view.heat[0]) ? view.heat[0] : (experiment.signals[0] ?? "");
  const [x, y] = [find(view.heat[1], usual[0]), find(view.heat[2], usual[1])];
  if (!x || !y) return null;
  const worst = (trial.failures ?? []).filter((failure) => (failure.ratio ?? 2) > 1).slice(0, 4);
  const pick = (change: Partial<Record<0 | 1 | 2, string>>) =>
    store.go({ heat: [change[0] ?? signal, change[1] ?? x.key, change[2] ?? y.key] });
  const select = (label: string, value: string, options: [string, string][], set: (value: string) => void) => (
    <label>{label}{" "}
      <select value={value} onChange={(event) => set(event.currentTarget.value)}>{options.map(([key, name]) => <option key={key} value={key}>{name}</option>)}</select>
    </label>
  );
  const named = all.map((one): [string, string] => [one.key, one.people.name]);
  return (
    <section class="card" aria-labelledby="failures">
      <h2 id="failures">Where the model fails{part && `: ${part.part}`}</h2>
      {trial.failures === null ? null : worst.length === 0 ? <p>No mean residual exceeds the noise of one measurement.</p> : (
        <ul>
          {worst.map((failure) => (
            <li key={failure.signal + failure.condition}>
              {column(experiment, failure.signal).name}: measured {quantity(Math.abs(failure.mean), column(experiment, failure.signal))} {failure.mean < 0 ? "less" : "more"} than modelled
              {failure.place ? ` at ${failure.place.replaceAll("_", " ")}` : ""}{failure.ratio === null ? "" : `, ${short(failure.ratio)} times the noise`}
            </li>
          ))}
        </ul>
      )}
      {trial.unanswered.length > 0 && (
        <details><summary>The model has no answer in some rows, which its errors leave out</summary>
          <ul>{trial.unanswered.slice(0, 12).map((rows) => <li key={rows.run + rows.first_row}>run {rows.run}, rows {rows.first_row} to {rows.last_row}: {rows.reason}</li>)}</ul>
        </details>
      )}
      <div class="controls">
        {select("Residual of", signal, experiment.signals.map((name) => [name, column(experiment, name).name]), (value) => pick({ 0: value }))}
        {select("over", x.key, named, (value) => pick({ 1: value }))}
        {select("and", y.key, named, (value) => pick({ 2: value }))}
      </div>
      <Map experiment={experiment} trial={trial} signal={signal} x={x} y={y} />
    </section>
  );
}
