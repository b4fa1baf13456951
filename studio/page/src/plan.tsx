/** The map of a plan, as `bekker plan --html` writes it, or the path alone from its `--json`. */

import { useEffect, useRef, useState } from "preact/hooks";
import { short } from "./format";
import { css, useDark, useStore } from "./hooks";
import { store } from "./store";

interface Point { x: number; y: number; z: number; travelled: number; heading: number; roll: number; pitch: number; stability: number; thrust: number; clearance: number | null }
interface Answer { length: number; points: Point[]; failures?: { x: number; y: number; kind: string; reason: string }[] }
interface Heights { columns: number; rows: number; cell: number; origin: [number, number]; heights: (number | null)[] }

export interface Plan {
  name: string;
  answer: Answer;
  /** Absent in the JSON of a plan. */
  map: Heights | null;
  stability_limit: number | null;
  thrust_limit: number | null;
}

/** The plan in a file; an error that says what was expected where it is none. */
export function planOf(name: string, text: string): Plan {
  const wrong = new Error(`\`${name}\` is no plan: expected what \`bekker plan --html\` or \`--json\` writes`);
  const begin = text.indexOf("const data = ");
  const json = begin < 0 ? text : text.slice(begin + "const data = ".length, text.indexOf(";\n", begin));
  let data: Partial<Plan> & Partial<Answer>;
  try {
    data = JSON.parse(json);
  } catch {
    throw wrong;
  }
  const answer = data.answer ?? (data as Answer);
  const number = (point: Partial<Point>) => [point.x, point.y, point.z, point.travelled, point.stability, point.thrust].every(Number.isFinite);
  if (!Array.isArray(answer.points) || answer.points.length === 0 || !answer.points.every(number)) throw wrong;
  return { name, answer, map: data.map ?? null, stability_limit: data.stability_limit ?? null, thrust_limit: data.thrust_limit ?? null };
}

const SIZE = 420;

function draw(canvas: HTMLCanvasElement, plan: Plan, at: number): void {
  const { map, answer } = plan;
  const xs = answer.points.map((point) => point.x);
  const ys = answer.points.map((point) => point.y);
  const margin = 0.15 * Math.max(Math.max(...xs) - Math.min(...xs), Math.max(...ys) - Math.min(...ys), 0.5);
  const [x0, y0] = map ? map.origin : [Math.min(...xs) - margin, Math.min(...ys) - margin];
  const wide = map ? (map.columns - 1) * map.cell : Math.max(...xs) + margin - x0;
  const high = map ? (map.rows - 1) * map.cell : Math.max(...ys) + margin - y0;
  const scale = SIZE / Math.max(wide, high);
  canvas.width = Math.ceil(wide * scale);
  canvas.height = Math.ceil(high * scale);
  const to = (x: number, y: number): [number, number] => [(x - x0) * scale, canvas.height - (y - y0) * scale];
  const ctx = canvas.getContext("2d");
  if (!ctx) return;
  if (map) {
    const known = map.heights.filter((height) => height !== null);
    const [low, top] = known.reduce(([a, b], height) => [Math.min(a, height), Math.max(b, height)], [Number.POSITIVE_INFINITY, Number.NEGATIVE_INFINITY]);
    const side = map.cell * scale;
    map.heights.forEach((height, k) => {
      const [x, y] = to(x0 + (k % map.columns) * map.cell, y0 + Math.floor(k / map.columns) * map.cell);
      const light = height === null ? 0 : 30 + (55 * (height - low)) / (top - low || 1);
      ctx.fillStyle = height === null ? css("--page") : `hsl(36 25% ${light}%)`;
      ctx.fillRect(x - side / 2, y - side / 2, side + 1, side + 1);
    });
  }
  const dot = (x: number, y: number, size: number, fill: string) => {
    ctx.fillStyle = fill;
    ctx.beginPath();
    ctx.arc(...to(x, y), size, 0, 2 * Math.PI);
    ctx.fill();
  };
  for (const { x, y } of answer.failures ?? []) dot(x, y, 2.5, "#b3261e");
  ctx.strokeStyle = "#0b57c4";
  ctx.lineWidth = 3;
  ctx.beginPath();
  for (const { x, y } of answer.points) ctx.lineTo(...to(x, y));
  ctx.stroke();
  const here = answer.points[at];
  if (here) {
    dot(here.x, here.y, 7, "#ffffff");
    dot(here.x, here.y, 5, "#0b57c4");
  }
}

export function PlanMap() {
  const { plan } = useStore();
  const canvas = useRef<HTMLCanvasElement>(null);
  const [at, setAt] = useState(0);
  const dark = useDark();
  useEffect(() => {
    if (canvas.current && plan) draw(canvas.current, plan, at);
  }, [plan, at, dark]);
  if (!plan) return null;
  const { points, length } = plan.answer;
  const here = points[Math.min(at, points.length - 1)];
  const degrees = (angle: number | undefined) => `${short(((angle ?? Number.NaN) * 180) / Math.PI)}°`;
  const label = `${short(here?.travelled)} m of ${short(length)} m`;
  const rows: [string, string, string][] = [
    ["height", `${short(here?.z)} m`, ""],
    ["pitch, roll", `${degrees(here?.pitch)}, ${degrees(here?.roll)}`, ""],
    ["stability angle, worst case", degrees(here?.stability), plan.stability_limit === null ? "" : degrees(plan.stability_limit)],
    ["thrust in reserve, worst case", `${short(here?.thrust)} N`, plan.thrust_limit === null ? "" : `${short(plan.thrust_limit)} N`],
    ["clearance", here?.clearance == null ? "no belly" : `${short(here.clearance)} m`, ""],
  ];
  return (
    <section class="card" aria-labelledby="plan">
      <h2 id="plan">Plan: {plan.name}</h2>
      <div class="pair">
        <div>
          <canvas ref={canvas} class="map" role="img" aria-label={`${plan.map ? "Heights, dark low and light high, and the" : "The"} planned path of ${short(length)} m`} />
          <p class="legend"><span>line: path; red: places where the rover would fail{plan.map ? "; dark low, light high" : "; without a map: give the page that `bekker plan --html` writes"}</span></p>
        </div>
        <div>
          <label class="slider">
            <span>Along the path</span><output>{label}</output>
            <input type="range" min={0} max={points.length - 1} value={at} aria-valuetext={label} onInput={(event) => setAt(Number(event.currentTarget.value))} />
          </label>
          <table class="readout">
            <thead><tr><th scope="col">here</th><th scope="col">value</th><th scope="col">least allowed</th></tr></thead>
            <tbody>{rows.map(([name, value, limit]) => <tr key={name}><th scope="row">{name}</th><td>{value}</td><td>{limit}</td></tr>)}</tbody>
          </table>
          <button type="button" onClick={() => { store.plan = null; store.changed(); }}>Close the plan</button>
        </div>
      </div>
    </section>
  );
}
