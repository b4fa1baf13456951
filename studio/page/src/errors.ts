/** Errors in multiples of the noise. */

import type { Measured, Values } from "./types";

/** Share of a noise floor above which an error is more than noise. */
export const AT_NOISE = 1.25;

/** An error over its noise; null where one of them is not known. */
export function over(error: number | undefined, noise: number | null | undefined): number | null {
  return noise == null || error === undefined || noise <= 0 ? null : error / noise;
}

/** Root mean square of error over noise; `before` stands before the names of the signals in `rmse`. */
export function together(of: Measured, rmse: Values | undefined, before: string): number | null {
  const ratios = of.signals.map((signal) => over(rmse?.[before + signal], of.noise[signal]?.value)).filter((ratio) => ratio !== null);
  return ratios.length ? Math.sqrt(ratios.reduce((sum, ratio) => sum + ratio * ratio, 0) / ratios.length) : null;
}
