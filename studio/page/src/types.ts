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
  /** Of several experiments on one soil those in which it acts; null where it acts in all. */
  parts: string[] | null;
  prior: { mean: number; sd: number } | null;
  fitted: Fitted | null;
}

export type Kind = "single_wheel" | "traverse" | "plate_sinkage" | "shear";

/** What was measured: of an experiment, or of one of several on one soil under its own names. */
export interface Measured {
  name: string;
  kind: Kind;
  signals: string[];
  columns: Record<string, ForPeople>;
  runs: Run[];
  noise: Record<string, { value: number | null; source: string }>;
  uncounted: { run: string; first: number; last: number; why: string; reason: string }[];
  wheel: { radius: number | null };
}

/** One of several experiments on one soil; `part` is its short name, with which names of its signals, runs and parameters begin or end. */
export interface Part extends Measured {
  part: string;
}

/** An effect, and of several experiments where it acts: under one `plain` name it may act in all of `parts`, in one, or in all but one. */
export interface EffectInfo {
  id: string;
  plain: string;
  parts: string[] | null;
  about: string;
  /** Whether it can change anything in this kind of experiment. */
  shows: boolean;
}

/** Of several experiments on one soil `signals` and `noise` are those of all (`part.signal`), and the rest that is measured stands in
 * `parts`. */
export interface Experiment extends Measured {
  id: string;
  example: boolean;
  parameters: Parameter[];
  /** What no calibration moves. */
  known: Parameter[];
  effects: EffectInfo[];
  calibration: { chi_square: number; degrees_of_freedom: number; searches: number; agreeing: number; cautions: string[] } | null;
  doubts: string[];
  sources: string[];
  /** Several experiments on one soil; none where there is one. */
  parts: Part[];
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
  /** By signal; of several experiments of all of them, the rest being of the one that is shown. */
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
  /** Of several experiments those in which each of `effects` acts. */
  where?: Record<string, string[]>;
  /** Effects one of which may act beside those of `effects`. */
  possible_beside: string[];
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
  /** `parts` counts the experiments of a set; 0 where it is one experiment. */
  experiments: { id: string; name: string; kind: Kind; example: boolean; parts: number }[];
  version: string;
  fmu: boolean;
}

export interface Meaning {
  target: string;
  unit: string | null;
  turned: boolean;
  /** The side of the vehicle, where both have a column. */
  side?: "left" | "right" | null;
}

export interface Proposal {
  ready: boolean;
  files?: string[];
  kind: Kind;
  columns: { name: string; examples: string[]; meaning: Meaning | null; note: string }[];
  targets: [string, string][];
  settings: string;
  unsure: string[];
  missing: string[];
}
