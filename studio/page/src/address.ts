/** The state of the page as the part of the address behind `#`, so that a reload, a link and the browser's back lead to it. */

import type { Values } from "./types";

export interface View {
  experiment: string;
  /** Which of several experiments on one soil is shown, by its short name; the first where it is empty. */
  part: string;
  /** The step of the history. */
  at: number;
  /** Effects that are on. */
  on: string[];
  /** Values that differ from the step's. */
  set: Values;
  /** Another step whose model is drawn beside; null for none. */
  versus: number | null;
  /** The input over which a wheel's signals are drawn. */
  axis: string;
  run: number;
  /** What is shown of the horizontal axis; null for all. */
  range: [number, number] | null;
  /** Places of the two cursors along the horizontal axis. */
  a: number | null;
  b: number | null;
  search: string;
  /** What the heat map is over. */
  heat: [string, string, string];
  /** The row that is shown in the scene. */
  row: number;
}

const EMPTY: View = {
  experiment: "",
  part: "",
  at: 0,
  on: [],
  set: {},
  versus: null,
  axis: "slip",
  run: 0,
  range: null,
  a: null,
  b: null,
  search: "",
  heat: ["", "", ""],
  row: 0,
};

function numbers(text: string | null): number[] {
  return (text ?? "").split(",").filter(Boolean).map(Number).filter(Number.isFinite);
}

export function readView(hash: string = location.hash): View {
  const all = new URLSearchParams(hash.replace(/^#/, ""));
  const [from, to] = numbers(all.get("range"));
  const set: Values = {};
  for (const pair of (all.get("set") ?? "").split(",").filter(Boolean)) {
    const at = pair.lastIndexOf(":");
    const value = Number(pair.slice(at + 1));
    if (at > 0 && Number.isFinite(value)) set[pair.slice(0, at)] = value;
  }
  const heat = (all.get("heat") ?? "").split("|");
  return {
    ...EMPTY,
    experiment: all.get("e") ?? "",
    part: all.get("part") ?? "",
    at: numbers(all.get("at"))[0] ?? 0,
    on: (all.get("on") ?? "").split(",").filter(Boolean),
    set,
    versus: numbers(all.get("versus"))[0] ?? null,
    axis: all.get("axis") ?? "slip",
    run: numbers(all.get("run"))[0] ?? 0,
    range: from !== undefined && to !== undefined ? [from, to] : null,
    a: numbers(all.get("a"))[0] ?? null,
    b: numbers(all.get("b"))[0] ?? null,
    search: all.get("search") ?? "",
    heat: [heat[0] ?? "", heat[1] ?? "", heat[2] ?? ""],
    row: numbers(all.get("row"))[0] ?? 0,
  };
}

function written(view: View): string {
  const all = new URLSearchParams();
  const put = (name: string, value: string, unless = "") => value !== unless && all.set(name, value);
  put("e", view.experiment);
  put("part", view.part);
  put("at", String(view.at));
  put("on", view.on.join(","));
  put("set", Object.entries(view.set).map(([name, value]) => `${name}:${value}`).join(","));
  put("versus", view.versus === null ? "" : String(view.versus));
  put("axis", view.axis, "slip");
  put("run", String(view.run), "0");
  put("range", view.range?.map((x) => Number(x.toPrecision(7))).join(",") ?? "");
  put("a", view.a === null ? "" : String(Number(view.a.toPrecision(7))));
  put("b", view.b === null ? "" : String(Number(view.b.toPrecision(7))));
  put("search", view.search);
  put("heat", view.heat.join("|"), "||");
  put("row", String(view.row), "0");
  return `#${all.toString().replaceAll("%2C", ",").replaceAll("%3A", ":").replaceAll("%7C", "|")}`;
}

export function sameView(a: View, b: View): boolean {
  return written(a) === written(b);
}

let timer = 0;
let waiting: View | null = null;

/** A page inside of another, as in a notebook, may have no address of its own; it then works without one. */
function inHistory(change: () => void): void {
  try {
    change();
  } catch {
    // Nothing is lost but the way back.
  }
}

/** Browsers refuse many changes of the address in a short time: those of a slider are written once it rests. */
export function writeView(view: View, push: boolean): void {
  clearTimeout(timer);
  const depth = (history.state?.depth as number | undefined) ?? 0;
  const replace = (view: View) => inHistory(() => history.replaceState({ depth }, "", written(view)));
  if (push) {
    if (waiting) replace(waiting);
    waiting = null;
    inHistory(() => history.pushState({ depth: depth + 1 }, "", written(view)));
    return;
  }
  waiting = view;
  timer = window.setTimeout(() => {
    replace(view);
    waiting = null;
  }, 120);
}

/** Whether the browser's back stays on this page. */
export function canUndo(): boolean {
  return ((history.state?.depth as number | undefined) ?? 0) > 0;
}
