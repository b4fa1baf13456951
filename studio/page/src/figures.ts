/** The figures in the text of a report: each is drawn when it comes into view, from the data that stands beside it. */

import uPlot from "uplot";
import { joined, type Placed } from "./data";
import { axisLook, bands, columns, seriesLook } from "./draw";
import { colour, css, isDark, onTheme } from "./hooks";
import type { Numbers } from "./types";

interface Scale { label: string; names: string[]; logarithmic: boolean }

interface Figure {
  x: Scale;
  y: Scale;
  traces: { name: string; mark: "line" | "dashed" | "points" | "means" | "joined"; colour: number; x: Numbers; y: Numbers; spread: Numbers }[];
  band: number | null;
  level: number | null;
  inside: [number, number] | null;
}

const HEIGHT = 260;

type Trace = Figure["traces"][number];

function isScattered(trace: Trace): boolean {
  return trace.mark === "points" || trace.mark === "means";
}

function placed(trace: Trace): Placed {
  const { spread } = trace;
  const shifted = (sign: number) => trace.y.map((y, k) => (y === null || spread[k] == null ? null : y + sign * spread[k]));
  return {
    label: trace.name,
    at: trace.x,
    values: trace.y,
    points: false,
    group: trace.colour,
    dash: trace.mark === "dashed" ? [6, 4] : undefined,
    width: 2,
    band: spread.length ? [shifted(-1), shifted(1)] : undefined,
  };
}

/** Samples as circles, means as diamonds with bars; many samples stand at one place. */
function scatter(traces: Trace[]): uPlot.Plugin {
  const one = (plot: uPlot, trace: Trace) => {
    const { ctx } = plot;
    const size = devicePixelRatio * (trace.mark === "means" ? 5 : 2.5);
    ctx.fillStyle = ctx.strokeStyle = colour(trace.colour, isDark());
    ctx.globalAlpha = trace.mark === "means" ? 1 : trace.x.length > 100 ? 0.4 : 0.75;
    ctx.lineWidth = 1.5 * devicePixelRatio;
    trace.x.forEach((at, k) => {
      const value = trace.y[k];
      if (at === null || value == null) return;
      const [x, y] = [plot.valToPos(at, "x", true), plot.valToPos(value, "y", true)];
      const half = trace.spread[k];
      ctx.beginPath();
      if (trace.mark === "points") ctx.arc(x, y, size, 0, 2 * Math.PI);
      else for (const [dx, dy] of [[-1, 0], [0, -1], [1, 0], [0, 1]] as const) ctx.lineTo(x + dx * size, y + dy * size);
      ctx.fill();
      if (half == null || half === 0) return;
      ctx.beginPath();
      ctx.moveTo(x, plot.valToPos(value - half, "y", true));
      ctx.lineTo(x, plot.valToPos(value + half, "y", true));
      ctx.stroke();
    });
  };
  return {
    hooks: {
      draw: [
        (plot) => {
          const { ctx } = plot;
          const { left, top, width, height } = plot.bbox;
          ctx.save();
          ctx.beginPath();
          ctx.rect(left, top, width, height);
          ctx.clip();
          for (const trace of traces) one(plot, trace);
          ctx.restore();
        },
      ],
    },
  };
}

/** What lies under the data: the noise, an interval, a level. */
function ground(figure: Figure): uPlot.Plugin {
  return {
    hooks: {
      drawAxes: [
        (plot) => {
          const { ctx } = plot;
          const { left, top, width, height } = plot.bbox;
          const y = (value: number) => Math.min(top + height, Math.max(top, plot.valToPos(value, "y", true)));
          const x = (value: number) => Math.min(left + width, Math.max(left, plot.valToPos(value, "x", true)));
          ctx.save();
          ctx.fillStyle = css("--shade");
          if (figure.band !== null) ctx.fillRect(left, y(figure.band), width, y(-figure.band) - y(figure.band));
          if (figure.inside) ctx.fillRect(x(figure.inside[0]), top, x(figure.inside[1]) - x(figure.inside[0]), height);
          if (figure.level !== null) {
            ctx.strokeStyle = css("--soft");
            ctx.setLineDash([3 * devicePixelRatio, 3 * devicePixelRatio]);
            ctx.beginPath();
            ctx.moveTo(left, y(figure.level));
            ctx.lineTo(left + width, y(figure.level));
            ctx.stroke();
          }
          ctx.restore();
        },
      ],
    },
  };
}

function legend(figure: Figure, host: HTMLElement): void {
  const named = figure.traces.filter((trace) => trace.name !== "samples");
  if (host.nextElementSibling?.classList.contains("legend") || named.length < 2 || named.length > 12) return;
  const list = document.createElement("p");
  list.className = "legend";
  for (const trace of named) {
    const mark = document.createElement("i");
    mark.className = trace.mark === "dashed" ? "line dashed" : isScattered(trace) ? "swatch round" : "line";
    mark.style.setProperty("--colour", `var(--c${trace.colour})`);
    const entry = document.createElement("span");
    entry.append(mark, ` ${trace.name}`);
    list.append(entry);
  }
  host.after(list);
}

function draw(host: HTMLElement): uPlot | null {
  const text = host.parentElement?.querySelector("script")?.textContent;
  if (!text) return null;
  const figure = JSON.parse(text) as Figure;
  const dark = isDark();
  const scattered = figure.traces.filter(isScattered);
  const data = joined(figure.traces.filter((trace) => !isScattered(trace)).map(placed), (group) => colour(group, dark));
  const own = figure.traces.flatMap(({ y, spread }) => y.flatMap((value, k) => (value === null ? [] : [value - (spread[k] ?? 0), value + (spread[k] ?? 0)])));
  const level = figure.level === null ? [] : [figure.level];
  const [low, high] = [Math.min(...own, ...level), Math.max(...own, ...level)];
  const margin = 0.05 * (high - low || 1);
  const names = figure.x.names;
  const last = names.length - 1;
  const xs = [...figure.traces.flatMap((trace) => trace.x), ...(figure.inside ?? [])].filter((x) => x !== null);
  // A figure of samples alone has no line that would span the axes.
  if (data.x.length === 0) data.x = [Math.min(...xs), Math.max(...xs)];
  const [from, to] = [Math.min(...xs), Math.max(...xs)];
  const room = 0.03 * (to - from || 1);
  const look = axisLook();
  const plot = new uPlot(
    {
      width: host.clientWidth || 320,
      height: HEIGHT,
      padding: [8, 12, 0, 0],
      legend: { show: false },
      cursor: { drag: { x: true, y: false }, points: { size: 6 } },
      scales: {
        x: { time: false, ...(names.length ? { range: [-0.3, last + 0.3] as [number, number] } : { range: [from - room, to + room] as [number, number] }) },
        y: figure.y.logarithmic ? { distr: 3 } : { range: [low - margin, high + margin] },
      },
      axes: [
        names.length
          ? { ...look, size: 34, splits: () => names.map((_, k) => k), values: () => names }
          : { ...look, label: figure.x.label, size: 34 },
        { ...look, label: figure.y.label, size: 56 },
      ],
      series: [{}, ...data.series.map(seriesLook)],
      plugins: [ground(figure), bands(() => data), scatter(scattered)],
    },
    columns(data) as uPlot.AlignedData,
    host,
  );
  legend(figure, host);
  return plot;
}

/** Draws each figure of the text when it comes near, and again in the colours of another theme. */
export function drawFigures(): void {
  const drawn = new Map<HTMLElement, uPlot>();
  const hosts = [...document.querySelectorAll<HTMLElement>("#report .plot")];
  const one = (host: HTMLElement) => {
    drawn.get(host)?.destroy();
    const plot = draw(host);
    if (plot) drawn.set(host, plot);
  };
  const seen = new IntersectionObserver(
    (entries) => {
      for (const { isIntersecting, target } of entries) if (isIntersecting && !drawn.has(target as HTMLElement)) one(target as HTMLElement);
    },
    { rootMargin: "600px" },
  );
  for (const host of hosts) seen.observe(host);
  const sized = new ResizeObserver((entries) => {
    for (const { target, contentRect } of entries) drawn.get(target as HTMLElement)?.setSize({ width: contentRect.width || 320, height: HEIGHT });
  });
  for (const host of hosts) sized.observe(host);
  onTheme(() => [...drawn.keys()].forEach(one));
  window.addEventListener("beforeprint", () => hosts.filter((host) => !drawn.has(host)).forEach(one));
}
