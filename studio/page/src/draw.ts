/** What plots and figures share: the look of axes and series, bands, error bars. */

import uPlot from "uplot";
import type { PlotData, Series } from "./data";
import { css } from "./hooks";

export function axisLook(): uPlot.Axis {
  const line = { stroke: css("--grid"), width: 1 };
  return { stroke: css("--soft"), grid: line, ticks: line, font: "12px system-ui", labelFont: "12px system-ui", labelSize: 18 };
}

/** A series as uPlot draws it, and before it the two edges of its band. */
export function seriesLook(series: Series): uPlot.Series[] {
  const own: uPlot.Series = {
    label: series.label,
    stroke: series.stroke,
    width: series.points ? 0 : (series.width ?? 2),
    pxAlign: 0,
    points: series.points ? { show: true, size: 6, width: series.width ?? 1.5, stroke: series.stroke, fill: css("--card") } : { show: false },
  };
  if (series.dash) own.dash = series.dash;
  if (series.points) own.paths = () => null;
  const edge: uPlot.Series = { label: `${series.label}, band`, stroke: "transparent", width: 0, pxAlign: 0, points: { show: false } };
  return series.band ? [edge, edge, own] : [own];
}

/** The columns that belong to these series. */
export function columns(data: PlotData): (number | null)[][] {
  return [data.x, ...data.series.flatMap((series) => (series.band ? [series.band[0], series.band[1], series.values] : [series.values]))];
}

/** Which columns are the edges of which band. */
export function bandsOf(data: PlotData): uPlot.Band[] {
  const bands: uPlot.Band[] = [];
  let at = 1;
  for (const series of data.series) {
    if (series.band) {
      bands.push({ series: [at + 1, at], fill: `${series.stroke}2a` });
      at += 2;
    }
    at += 1;
  }
  return bands;
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
