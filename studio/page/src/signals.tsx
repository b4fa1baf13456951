/** Measured and modelled: a plot of each signal over one linked axis, with two cursors that give differences. */

import { useMemo } from "preact/hooks";
import { alongCourse, course, overTime, repeats, steady, valueAt, type PlotData } from "./data";
import { axisLabel, column, quantity, short } from "./format";
import { colour, useDark, useStore } from "./hooks";
import { Plot } from "./plot";
import { store } from "./store";
import type { Experiment } from "./types";

const AXES = ["slip", "load", "wheel_speed"];

function matches(experiment: Experiment, signal: string, search: string): boolean {
  const words = `${signal} ${column(experiment, signal).name}`.toLowerCase();
  return search.toLowerCase().split(/\s+/).every((word) => words.includes(word));
}

/** Values at the cursors and their differences, in time and between what is drawn. */
function Readout({ data, experiment, signal, drive }: { data: PlotData; experiment: Experiment; signal: string; drive: boolean }) {
  const { a, b } = store.view;
  if (a === null && b === null) return null;
  const unit = column(experiment, signal).unit;
  const minus = (p: number | null, q: number | null) => (p === null || q === null ? null : p - q);
  const at = (series: PlotData["series"][number]): [number | null, number | null] => {
    return [a === null ? null : valueAt(data.x, series.values, a), b === null ? null : valueAt(data.x, series.values, b)];
  };
  const rows: { name: string; colour?: string; values: [number | null, number | null] }[] = [];
  const difference = (name: string, p: PlotData["series"][number] | undefined, q: PlotData["series"][number] | undefined) => {
    if (!p || !q) return;
    const [[pa, pb], [qa, qb]] = [at(p), at(q)];
    rows.push({ name, values: [minus(pa, qa), minus(pb, qb)] });
  };
  const lines = data.series.filter((series) => !series.points);
  for (const series of lines) {
    const name = drive ? (series.other ? stepName() : series.label) : `${series.other ? `${stepName()}, ` : ""}${series.label || "all rows"}`;
    rows.push({ name, colour: series.stroke, values: at(series) });
  }
  if (drive) {
    difference("measured − model", lines[0], lines[1]);
    difference(`model − ${stepName()}`, lines[1], lines[2]);
  } else {
    for (const series of lines.filter((one) => !one.other)) {
      difference(`model − ${stepName()}${series.label ? `, ${series.label}` : ""}`, series, lines.find((one) => one.other && one.label === series.label));
    }
  }
  return (
    <div class="scroll" tabIndex={0} role="region" aria-label={`Values at the cursors, ${signal}`}>
      <table class="readout">
        <thead>
          <tr>
            <th scope="col">{unit || "value"}</th>
            <th scope="col">at A</th>
            <th scope="col">at B</th>
            <th scope="col">B − A</th>
          </tr>
        </thead>
        <tbody>
          {rows.map(({ name, colour, values: [va, vb] }) => (
            <tr key={name}>
              <th scope="row">{colour && <i class="swatch" style={{ background: colour }} />}{name}</th>
              <td>{short(va)}</td>
              <td>{short(vb)}</td>
              <td>{short(minus(vb, va))}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

/** The step whose model is drawn beside. */
function stepName(): string {
  const { steps, view } = store;
  return view.versus === null ? "other model" : (steps[view.versus]?.label ?? "other model");
}

function Signal({ signal, xName }: { signal: string; xName: string }) {
  const { experiment, trial, other, view } = useStore();
  const dark = useDark();
  const drive = experiment?.kind === "traverse";
  const data = useMemo(() => {
    if (!experiment || !trial) return { x: [], series: [] };
    if (drive) return overTime(experiment, trial, other, view.run, signal, dark);
    return course(experiment) ? alongCourse(experiment, trial, other, signal, dark) : steady(experiment, trial, other, signal, dark);
  }, [experiment, trial?.runs, trial?.curves, other, signal, view.run, dark]);
  const shaded = useMemo(() => {
    const run = experiment?.runs[view.run];
    const time = run?.data.time;
    if (!experiment || !drive || !time) return [];
    const own = experiment.uncounted.filter((rows) => rows.run === run.name);
    return own.map((rows) => [time[rows.first - 1] ?? 0, time[rows.last - 1] ?? 0] as [number, number]);
  }, [experiment, view.run]);
  const begins = useMemo(() => {
    const time = experiment?.runs[view.run]?.data.time;
    const windows = drive ? (trial?.motion[view.run]?.windows ?? []) : [];
    return windows.slice(1).map(([first]) => time?.[first] ?? 0);
  }, [experiment, trial?.motion, view.run]);
  if (!experiment || !trial) return null;
  const shown = column(experiment, signal);
  const ratio = store.ratio(signal, trial.rmse);
  const error = quantity(store.errorOf(signal, trial.rmse), shown);
  const title = `${shown.name}: error ${error}${ratio === null ? "" : `, ${short(ratio)} times the noise`}`;
  return (
    <div class="signal">
      <Plot
        data={data}
        title={title}
        xLabel={axisLabel(column(experiment, xName))}
        yLabel={axisLabel(shown)}
        height={240}
        a={view.a}
        b={view.b}
        range={view.range}
        shaded={shaded}
        begins={begins}
        onRange={(range) => store.go({ range })}
        onCursor={(which, at) => store.go(which === "a" ? { a: at } : { b: at })}
      />
      <Readout data={data} experiment={experiment} signal={signal} drive={drive} />
    </div>
  );
}

function Legend({ experiment }: { experiment: Experiment }) {
  const { trial, other } = useStore();
  const dark = useDark();
  if (experiment.kind === "traverse") {
    return (
      <p class="legend">
        <span><i class="line" style={{ background: colour(6, dark) }} /> measured</span>
        <span><i class="line" style={{ background: colour(1, dark) }} /> model</span>
        {other && <span><i class="line dashed" style={{ "--colour": colour(0, dark) }} /> {stepName()}</span>}
        {experiment.uncounted.length > 0 && <span><i class="swatch shade" /> not counted</span>}
        {(trial?.motion[0]?.windows.length ?? 0) > 1 && <span>dotted: a window begins</span>}
      </p>
    );
  }
  if (course(experiment)) {
    return (
      <p class="legend">
        <span>circles: measured; lines: model{other ? `; dashed: ${stepName()}` : ""}</span>
        {repeats(experiment).map((group, k) => (
          <span key={group.name}><i class="line" style={{ background: colour(k, dark) }} /> {group.name}</span>
        ))}
      </p>
    );
  }
  return (
    <p class="legend">
      <span>circles: measured, bars two standard deviations of the noise; lines: model{other ? `; dashed: ${stepName()}` : ""}</span>
      {trial?.curves?.groups.map((group, k) => (
        <span key={group.name}><i class="line" style={{ background: colour(k, dark) }} /> {group.name || "all rows"}</span>
      ))}
    </p>
  );
}

export function Signals() {
  const { experiment, whole, part, trial, steps, view } = useStore();
  if (!experiment) return null;
  const drive = experiment.kind === "traverse";
  const along = course(experiment);
  const xName = drive ? "time" : (along ?? trial?.curves?.axis ?? view.axis);
  const shown = experiment.signals.filter((signal) => matches(experiment, signal, view.search));
  const nudge = (which: "a" | "b", value: string) =>
    store.go({ [which]: value === "" || !Number.isFinite(Number(value)) ? null : Number(value) });
  return (
    <section class="card" aria-labelledby="signals">
      <h2 id="signals">Measured and modelled{part && `: ${part.part}`}</h2>
      <div class="controls">
        {whole && part && (
          <label>
            Experiment{" "}
            <select value={view.part || part.part} onChange={(event) => store.choosePart(event.currentTarget.value)}>
              {whole.parts.map((one) => <option key={one.part} value={one.part}>{one.part}</option>)}
            </select>
          </label>
        )}
        {experiment.signals.length > 3 && (
          <label>
            Find a signal{" "}
            <input type="search" value={view.search} placeholder="torque 2" onInput={(event) => store.go({ search: event.currentTarget.value })} />
          </label>
        )}
        {drive && experiment.runs.length > 1 && (
          <label>
            Run{" "}
            <select value={view.run} onChange={(event) => store.go({ run: Number(event.currentTarget.value), row: 0, range: null, a: null, b: null }, true)}>
              {experiment.runs.map((run, k) => <option key={run.name} value={k}>{run.name}</option>)}
            </select>
          </label>
        )}
        {!drive && !along && (
          <label>
            Over{" "}
            <select
              value={view.axis}
              onChange={(event) => {
                store.go({ axis: event.currentTarget.value, range: null, a: null, b: null }, true);
                void store.ask("axis");
              }}
            >
              {AXES.map((axis) => <option key={axis} value={axis}>{column(experiment, axis).name}</option>)}
            </select>
          </label>
        )}
        {steps.length > 1 && (
          <label>
            Beside it{" "}
            <select value={view.versus ?? ""} onChange={(event) => store.compareWith(event.currentTarget.value === "" ? null : Number(event.currentTarget.value))}>
              <option value="">no other model</option>
              {steps.map((step, k) => <option key={k} value={k}>{step.label}</option>)}
            </select>
          </label>
        )}
        <label>
          A <input type="number" step="any" class="cursor" value={view.a ?? ""} onChange={(event) => nudge("a", event.currentTarget.value)} />
        </label>
        <label>
          B <input type="number" step="any" class="cursor" value={view.b ?? ""} onChange={(event) => nudge("b", event.currentTarget.value)} />
        </label>
        {(view.a !== null || view.b !== null) && <button type="button" onClick={() => store.go({ a: null, b: null })}>Clear cursors</button>}
        {view.range && <button type="button" onClick={() => store.go({ range: null })}>Show all</button>}
      </div>
      <Legend experiment={experiment} />
      {trial && !drive && !along && !trial.curves && <p>This input was not varied in the experiment: choose another one.</p>}
      {trial && shown.length === 0 && <p>No signal is called so.</p>}
      <div class="plots">{trial && (drive || along || trial.curves) && shown.map((signal) => <Signal key={signal} signal={signal} xName={xName} />)}</div>
      <p class="hint">Click sets cursor A, Shift-click cursor B. Drag across a plot to enlarge a stretch in all of them; double-click shows all again.</p>
    </section>
  );
}
