/** The wheel or the rover on its ground, the measured one as a ghost beside it, with a timeline. */

import { useEffect, useRef, useState } from "preact/hooks";
import { course } from "./data";
import { column, quantity, short } from "./format";
import { useStore } from "./hooks";
import { store } from "./store";
import type { Experiment, Motion, Run, Trial } from "./types";

const WIDTH = 640;
const HEIGHT = 220;

type Point = [number, number];

/** Turns about the origin by an angle, rad. */
function turned([x, z]: Point, angle: number): Point {
  return [x * Math.cos(angle) - z * Math.sin(angle), x * Math.sin(angle) + z * Math.cos(angle)];
}

/** Shows rows one after the other: in their own time where they have one. */
function usePlayback(run: Run, rows: number): [boolean, (on: boolean) => void] {
  const [playing, setPlaying] = useState(false);
  useEffect(() => {
    if (!playing) return;
    const times = run.data.time;
    const first = times?.[0] ?? 0;
    const began = performance.now() - 1000 * (times ? (times[store.view.row] ?? first) - first : 0.25 * store.view.row);
    let frame = 0;
    const next = () => {
      const passed = (performance.now() - began) / 1000;
      let row = store.view.row;
      if (times) while (row < rows - 1 && (times[row + 1] ?? Number.POSITIVE_INFINITY) - first <= passed) row += 1;
      else row = Math.min(rows - 1, Math.floor(passed / 0.25));
      if (row !== store.view.row) store.go({ row });
      if (row >= rows - 1) setPlaying(false);
      else frame = requestAnimationFrame(next);
    };
    frame = requestAnimationFrame(next);
    return () => cancelAnimationFrame(frame);
  }, [playing, run, rows]);
  return [playing, setPlaying];
}

function Timeline({ run, rows, label }: { run: Run; rows: number; label: string }) {
  const { view } = useStore();
  const [playing, setPlaying] = usePlayback(run, rows);
  const toggle = () => {
    if (!playing && view.row >= rows - 1) store.go({ row: 0 });
    setPlaying(!playing);
  };
  return (
    <div class="timeline">
      <button type="button" onClick={toggle} aria-pressed={playing}>{playing ? "Pause" : "Play"}</button>
      <input type="range" min={0} max={rows - 1} value={Math.min(view.row, rows - 1)} aria-label="Row of the run" aria-valuetext={label}
        onInput={(event) => store.go({ row: Number(event.currentTarget.value) })} />
      <span class="soft">{label}</span>
    </div>
  );
}

/** A wheel with a spoke, so that its turning shows. */
function Wheel({ at, radius, angle, ghost }: { at: Point; radius: number; angle: number; ghost?: boolean }) {
  const [x, y] = at;
  return (
    <g class={ghost ? "ghost" : "solid"}>
      <circle cx={x} cy={y} r={radius} />
      <line x1={x} y1={y} x2={x + radius * Math.cos(angle)} y2={y + radius * Math.sin(angle)} />
    </g>
  );
}

function Carriage({ experiment, trial }: { experiment: Experiment; trial: Trial }) {
  const { view } = useStore();
  const index = Math.min(view.run, experiment.runs.length - 1);
  const run = experiment.runs[index];
  if (!run) return null;
  const rows = run.data.load?.length ?? 0;
  const row = Math.min(view.row, rows - 1);
  const measured = (name: string) => run.data[name]?.[row] ?? null;
  const modelled = (name: string) => trial.runs[index]?.[name]?.modelled[row] ?? null;
  const radius = experiment.wheel.radius ?? 0.1;
  const scale = 68 / radius;
  const ground = 152;
  const centre = (sinkage: number): Point => [WIDTH / 2, ground - (radius - sinkage) * scale];
  const [own, ghost] = [modelled("sinkage"), measured("sinkage")];
  const sunk = own ?? ghost ?? 0;
  const rut = Math.max(0, sunk) * scale;
  const force = (measured("load") ?? 1) / 180;
  const arrow = (value: number | null, y: number, kind: string) =>
    value === null ? null : <line class={`arrow ${kind}`} x1={WIDTH / 2} y1={y} x2={WIDTH / 2 + value / force} y2={y} marker-end={`url(#tip-${kind})`} />;
  const facts = ["load", "slip", "wheel_speed"].map((name) => `${column(experiment, name).name} ${quantity(measured(name), column(experiment, name))}`);
  return (
    <>
      <div class="controls">
        <label>
          Run{" "}
          <select value={index} onChange={(event) => store.go({ run: Number(event.currentTarget.value), row: 0 })}>
            {experiment.runs.map((one, k) => <option key={one.name} value={k}>{one.name}</option>)}
          </select>
        </label>
      </div>
      <svg class="scene" viewBox={`0 0 ${WIDTH} ${HEIGHT}`} role="img" aria-label={`A wheel in soil at ${facts.join(", ")}; model beside measurement`}>
        <defs>
          {["model", "measured"].map((kind) => (
            <marker key={kind} id={`tip-${kind}`} viewBox="0 0 8 8" refX="7" refY="4" markerWidth="5" markerHeight="5" orient="auto">
              <path d="M0 0 L8 4 L0 8 z" class={kind} />
            </marker>
          ))}
        </defs>
        <path class="ground" d={`M0 ${ground + rut} H${WIDTH / 2 - 0.2 * radius * scale} L${WIDTH / 2 + 0.8 * radius * scale} ${ground} H${WIDTH} V${HEIGHT} H0 z`} />
        {ghost !== null && <Wheel at={centre(ghost)} radius={radius * scale} angle={0.6} ghost />}
        <Wheel at={centre(sunk)} radius={radius * scale} angle={0.6} />
        {arrow(modelled("drawbar_pull"), centre(sunk)[1] - 6, "model")}
        {arrow(measured("drawbar_pull"), centre(sunk)[1] + 6, "measured")}
      </svg>
      <Timeline run={run} rows={rows} label={facts[1] ?? ""} />
      <p class="legend"><span>{facts.join(", ")}</span><span>solid: model; dashed: measured; arrows: drawbar pull</span></p>
      <table class="readout">
        <thead><tr><th scope="col">at this point</th><th scope="col">measured</th><th scope="col">model</th><th scope="col">difference</th></tr></thead>
        <tbody>
          {experiment.signals.map((signal) => {
            const [m, f] = [measured(signal), modelled(signal)];
            return (
              <tr key={signal}>
                <th scope="row">{column(experiment, signal).name}</th>
                <td>{quantity(m, column(experiment, signal))}</td>
                <td>{quantity(f, column(experiment, signal))}</td>
                <td>{m !== null && f !== null ? quantity(m - f, column(experiment, signal)) : "–"}</td>
              </tr>
            );
          })}
        </tbody>
      </table>
    </>
  );
}

/** Height of the ground at x: straight between its points, flat where none was recorded. */
function groundAt(terrain: Run["terrain"], x: number): number {
  const [xs, zs] = [terrain?.x, terrain?.z];
  if (!xs || !zs || xs.length < 2) return 0;
  let k = 1;
  while (k < xs.length - 1 && (xs[k] ?? 0) < x) k += 1;
  const [x0, x1, z0, z1] = [xs[k - 1] ?? 0, xs[k] ?? 1, zs[k - 1] ?? 0, zs[k] ?? 0];
  return z0 + ((x - x0) / (x1 - x0)) * (z1 - z0);
}

interface Pose { chassis: Point; pitch: number; wheels: Point[] }

function modelPose(motion: Motion, row: number): Pose | null {
  const [x, z, pitch, wheels] = [motion.x[row], motion.z[row], motion.pitch[row], motion.centres[row]];
  if (x == null || z == null || pitch == null || !wheels) return null;
  return { chassis: [x, z], pitch, wheels: wheels.map(([wx, wz]) => [wx ?? x, wz ?? z]) };
}

/** The rover where it was measured; what was not measured is the model's, carried along the ground. */
function measuredPose(run: Run, pose: Pose, row: number): Pose | null {
  const x = run.data.x?.[row];
  if (x == null) return null;
  const lift = pose.chassis[1] - groundAt(run.terrain, pose.chassis[0]);
  const z = run.data.z?.[row] ?? groundAt(run.terrain, x) + lift;
  const pitch = run.data.pitch?.[row] ?? pose.pitch;
  const wheels = pose.wheels.map(([wx, wz]): Point => {
    const [dx, dz] = turned([wx - pose.chassis[0], wz - pose.chassis[1]], pitch - pose.pitch);
    return [x + dx, z + dz];
  });
  return { chassis: [x, z], pitch, wheels };
}

function Drive({ experiment, trial }: { experiment: Experiment; trial: Trial }) {
  const { view } = useStore();
  const run = experiment.runs[view.run];
  const motion = trial.motion[view.run];
  if (!run) return null;
  const times = run.data.time ?? [];
  const row = Math.min(view.row, times.length - 1);
  const label = `${short(times[row])} s`;
  const pose = motion ? modelPose(motion, row) : null;
  const ghost = pose ? measuredPose(run, pose, row) : null;
  const middle = pose ?? ghost;
  const span = middle ? Math.max(...middle.wheels.map(([x]) => Math.abs(x - middle.chassis[0]))) : 1;
  const scale = WIDTH / (9 * Math.max(span, 0.1));
  const [x0, z0] = middle?.chassis ?? [0, 0];
  const to = ([x, z]: Point): Point => [WIDTH / 2 + (x - x0) * scale, HEIGHT * 0.55 - (z - z0) * scale];
  const profile: Point[] = [];
  for (let k = 0; k <= 160; k += 1) {
    const x = x0 + (k / 160 - 0.5) * (WIDTH / scale);
    profile.push(to([x, groundAt(run.terrain, x)]));
  }
  const radius = (motion?.radius ?? 0.1) * scale;
  const body = (one: Pose, kind: string) => {
    const points = [...one.wheels, one.chassis].map(to).sort((p, q) => p[0] - q[0]);
    return <polyline class={kind} points={points.map((p) => p.join()).join(" ")} />;
  };
  const angle = (x: number) => x / (motion?.radius ?? 0.1);
  return (
    <>
      <svg class="scene" viewBox={`0 0 ${WIDTH} ${HEIGHT}`} role="img" aria-label={`The rover on its ground at ${label}; model solid, measured dashed`}>
        <path class="ground" d={`M${profile.map((p) => p.join(" ")).join(" L")} V${HEIGHT} H0 z`} />
        {ghost && body(ghost, "ghost")}
        {ghost?.wheels.map((wheel, k) => <Wheel key={k} at={to(wheel)} radius={radius} angle={angle(wheel[0])} ghost />)}
        {pose && body(pose, "solid")}
        {pose?.wheels.map((wheel, k) => <Wheel key={k} at={to(wheel)} radius={radius} angle={angle(wheel[0])} />)}
      </svg>
      <Timeline run={run} rows={times.length} label={label} />
      <p class="legend">
        <span>solid: model; dashed: measured</span>
        {motion?.slip.map((slip, k) => <span key={k}>wheel {k + 1}: slip {quantity(slip[row], { name: "", unit: "%", factor: 100 })}, load {quantity(motion.load[k]?.[row], { name: "", unit: "N", factor: 1 })}</span>)}
      </p>
      {motion && motion.windows.length > 1 && <p class="hint">The model begins anew from the measured state every few seconds, as in a diagnosis.</p>}
    </>
  );
}

export function Scene() {
  const { experiment, trial } = useStore();
  const place = useRef<HTMLElement>(null);
  if (!experiment || course(experiment)) return null;
  return (
    <section class="card" aria-labelledby="scene" ref={place}>
      <h2 id="scene">{experiment.kind === "traverse" ? "The drive" : "The wheel"}</h2>
      {trial && (experiment.kind === "traverse" ? <Drive experiment={experiment} trial={trial} /> : <Carriage experiment={experiment} trial={trial} />)}
    </section>
  );
}
