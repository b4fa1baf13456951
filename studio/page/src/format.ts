/** Numbers and names for people. */

import type { Experiment, ForPeople } from "./types";

/** Three significant digits without trailing zeros. */
export function short(value: number | null | undefined): string {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e-3 && size < 1e5) return String(Number(value.toPrecision(3)));
  return value.toExponential(2).replace(/\.?0+e/, "e").replace("e+", "e");
}

/** A value in SI units with the unit in which people read it. */
export function quantity(value: number | null | undefined, column: ForPeople | undefined): string {
  if (value === null || value === undefined) return "–";
  const unit = column?.unit ? ` ${column.unit}` : "";
  return short(value * (column?.factor ?? 1)) + unit;
}

export function axisLabel(column: ForPeople): string {
  return column.unit ? `${column.name}, ${column.unit}` : column.name;
}

export function column(experiment: Experiment, name: string): ForPeople {
  return experiment.columns[name] ?? { name: spoken(name), unit: "", factor: 1 };
}

/** `slip_sinkage` is slip sinkage; where it acts, behind ` in ` or ` not in `, keeps its name. */
export function spoken(id: string): string {
  return id.replace(/ in \S+|_/g, (found) => (found === "_" ? " " : found));
}

export function listed(ids: string[]): string {
  const words = ids.map(spoken);
  if (words.length < 2) return words.join("");
  return `${words.slice(0, -1).join(", ")} and ${words[words.length - 1]}`;
}

/** A ratio of error and noise in words. */
export function times(ratio: number | null): string {
  if (ratio === null) return "noise unknown";
  return ratio < 9.95 ? `${ratio.toFixed(1)} ×` : `${ratio.toFixed(0)} ×`;
}
