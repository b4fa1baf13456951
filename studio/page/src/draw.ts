/** What plots and figures share: the look of axes and series, bands, error bars. */

import uPlot from "uplot";
import type { PlotData, Series } from "./data";
import { css } from "./hooks";
import type { Numbers } from "./types";

export function axisLook(): uPlot.Axis {
  const line = { stroke: css("--grid"), width: 1 };
  return { stroke: css("--soft"), grid: line, ticks: line, font: "12px system-ui", labelFont: "12px system-ui", labelSize: 18 };
}

/** A series as uPlot draws it. */
export function seriesLook(series: Series): uPlot.Series {
  const own: uPlot.Series = {
    label: series.label,
    stroke: series.stroke,
    width: series.points ? 0 : (series.width ?? 2),
    pxAlign: 0,
    points: series.points ? { show: true, size: 6, width: series.width ?? 1.5, stroke: series.stroke, fill: css("--card") } : { show: false },
  };
  if (series.dash) own.dash = series.dash;
  if (series.points) own.paths = () => null;
  return own;
}

/** The columns that belong to these series. */
export function columns(data: PlotData): (number | null)[][] {
  return [data.x, ...data.series.map((series) => series.values)];
}

/** A linear scale in pixels of the canvas: a place is offset + step × value. */
function pixels(plot: uPlot, scale: "x" | "y"): (value: number) => number {
  const offset = plot.valToPos(0, scale, true);
  const step = plot.valToPos(1, scale, true) - offset;
  return (value) => offset + step * value;
}

/** The outline of a band from `from` to `to` (not included): of many points the lowest and highest in each pixel. */
function outline(plot: uPlot, x: number[], [low, high]: [Numbers, Numbers], from: number, to: number): Path2D {
  const path = new Path2D();
  const [across, up] = [pixels(plot, "x"), pixels(plot, "y")];
  const below: [number, number][] = [];
  const above: [number, number][] = [];
  const close = () => {
    above.forEach(([px, py], k) => (k ? path.lineTo(px, py) : path.moveTo(px, py)));
    for (const [px, py] of below.reverse()) path.lineTo(px, py);
    if (above.length) path.closePath();
    below.length = above.length = 0;
  };
  for (let k = from; k < to; k += 1) {
    const [bottom, top] = [low[k], high[k]];
    if (bottom === undefined) continue;
    if (bottom === null || top == null) {
      close();
      continue;
    }
    const px = Math.round(across(x[k] as number));
    const lower = up(bottom);
    const upper = up(top);
    const last = above.length - 1;
    const [before, under] = [above[last], below[last]];
    if (to - from > 2 * plot.bbox.width && before && under && before[0] === px) {
      before[1] = Math.min(before[1], upper);
      under[1] = Math.max(under[1], lower);
    } else {
      above.push([px, upper]);
      below.push([px, lower]);
    }
  }
  close();
  return path;
}

/** Bands, under the data. */
export function bands(of: () => PlotData): uPlot.Plugin {
  return {
    hooks: {
      drawAxes: [
        (plot) => {
          const { x, series } = of();
          const { ctx } = plot;
          const { left, width, top, height } = plot.bbox;
          const { min, max } = plot.scales.x ?? {};
          // One point more on either side, so that a band goes on to the edge.
          const first = Math.max(0, x.findIndex((at) => at >= (min ?? Number.NEGATIVE_INFINITY)) - 1);
          let end = x.length;
          while (end > 1 && (x[end - 2] as number) > (max ?? Number.POSITIVE_INFINITY)) end -= 1;
          ctx.save();
          ctx.beginPath();
          ctx.rect(left, top, width, height);
          ctx.clip();
          ctx.globalAlpha = 0.17;
          for (const one of series) {
            if (!one.band) continue;
            ctx.fillStyle = one.stroke;
            ctx.fill(outline(plot, x, one.band, first, end));
          }
          ctx.restore();
        },
      ],
    },
  };
}

/** Upright lines through points. */
export function errorBars(of: () => PlotData): uPlot.Plugin {
  return {
    hooks: {
      drawAxes: [
        (plot) => {
          const data = of();
          const { ctx } = plot;
          const { left, width, top, height } = plot.bbox;
          ctx.save();
          ctx.beginPath();
          ctx.rect(left, top, width, height);
          ctx.clip();
          ctx.globalAlpha = 0.6;
          ctx.lineWidth = 1.2 * devicePixelRatio;
          for (const series of data.series.filter((one) => one.points && one.spread)) {
            ctx.strokeStyle = series.stroke;
            ctx.beginPath();
            series.values.forEach((value, k) => {
              const half = series.spread?.[k];
              if (value == null || half == null) return;
              const x = plot.valToPos(data.x[k] ?? 0, "x", true);
              ctx.moveTo(x, plot.valToPos(value - half, "y", true));
              ctx.lineTo(x, plot.valToPos(value + half, "y", true));
            });
            ctx.stroke();
          }
          ctx.restore();
        },
      ],
    },
  };
}
