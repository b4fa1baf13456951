/** What the server sends; all numbers in SI units unless a factor stands beside them. */

export type Values = Record<string, number>;
/** Numbers of a plot; null where there is none. */
export type Numbers = (number | null)[];

export interface ForPeople {
  name: string;
  unit: string;
  factor: number;
}

export interface Run {
  name: string;
  group: string | null;
  parameters: Values;
  measured: string[];
  inputs: string[];
  data: Record<string, Numbers>;
  terrain: Record<string, Numbers> | null;
}

export interface Fitted {
  value: number;
  std: number | null;
  at_bound: boolean;
  prior_shift: number | null;
}

export interface Parameter {
  name: string;
  about: string;
  source: string;
  unit: string;
  factor: number;
  min: number;
  max: number;
  start: number;
  typical: number;
  effect: string | null;
  prior: { mean: number; sd: number } | null;
  fitted: Fitted | null;
}

export interface Experiment {
  id: string;
  name: string;
  kind: "single_wheel" | "traverse";
  example: boolean;
  signals: string[];
  columns: Record<string, ForPeople>;
  runs: Run[];
  noise: Record<string, { value: number | null; source: string }>;
  parameters: Parameter[];
  /** What no calibration moves. */
  known: Parameter[];
  /** `shows` is whether the effect can change anything in this kind of experiment. */
  effects: { id: string; about: string; shows: boolean }[];
  calibration: { chi_square: number; degrees_of_freedom: number; searches: number; agreeing: number; cautions: string[] } | null;
  doubts: string[];
  sources: string[];
  uncounted: { run: string; first: number; last: number; why: string; reason: string }[];
  wheel: { radius: number | null };
}

export interface Curve {
  value: Numbers;
  /** Lowest and highest over the inputs of the group, where they were computed. */
  band: [Numbers, Numbers] | null;
}

export interface Curves {
  axis: string;
  groups: { name: string; rows: [number, number][]; at: Numbers; signals: Record<string, Curve> | null }[];
}

export interface Motion {
  windows: [number, number][];
  x: Numbers;
  z: Numbers;
  pitch: Numbers;
  /** By row and wheel. */
  centres: (number | null)[][][];
  radius: number;
  slip: Numbers[];
  load: Numbers[];
  ground: Numbers;
}

export interface Failure {
  signal: string;
  condition: string;
  place: string | null;
  mean: number;
  ratio: number | null;
}

export interface Trial {
  rmse: Values;
  runs: Record<string, { modelled: Numbers; residual: Numbers }>[];
  unanswered: { run: string; first_row: number; last_row: number; reason: string }[];
  /** Null where the model was interpolated. */
  failures: Failure[] | null;
  curves: Curves | null;
  motion: Motion[];
  milliseconds: number;
}

export interface Step {
  label: string;
  parent: number | null;
  effects: string[];
  values: Values;
  rmse: Values;
  /** The model, in a saved report. */
  toml?: string | null;
}

export interface Found {
  effects: string[];
  values: Values;
  chi_square: number;
  fitted: Record<string, Fitted> | null;
}

export interface Job {
  kind: JobKind;
  running: boolean;
  stage?: string;
  trying?: string;
  share?: number;
  left?: string;
  error?: string | null;
}

export type JobKind = "calibrate" | "fit" | "rank" | "separate";

export interface Candidate {
  effect: string;
  probability: number | null;
  tied: boolean;
  p_value: number;
  gain: number;
  left: number;
  refitted: boolean;
}

export interface Diagnosis {
  verdict: "explained" | "effect_missing" | "unexplained" | "undetermined";
  effects: string[];
  candidates: Candidate[];
  invisible: string[];
  suggestions: { text: string }[];
  cautions: string[];
  not_tried: string[];
  interrupted: boolean;
  improved_is: string;
  probability_enough: number | null;
  probability_other: number | null;
}

export interface Separation {
  effects: { effect: string; visible: boolean; visible_share: number; smallest: { parameter: string; unit: string; value: number | null }[] }[];
  invisible: string[];
  pairs: { effects: string[]; cosine: number; likeness: string }[];
}

export interface Snapshot {
  steps: Step[];
  found: Found[];
  diagnosis: Diagnosis | null;
  separation: Separation | null;
  jobs: Job[];
}

export interface Listed {
  experiments: { id: string; name: string; kind: string; example: boolean }[];
  version: string;
  fmu: boolean;
}

export interface Meaning {
  target: string;
  unit: string | null;
  turned: boolean;
}

export interface Proposal {
  ready: boolean;
  files?: string[];
  kind: "single_wheel" | "traverse";
  columns: { name: string; examples: string[]; meaning: Meaning | null; note: string }[];
  targets: [string, string][];
  settings: string;
  unsure: string[];
  missing: string[];
}
