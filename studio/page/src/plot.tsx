/** One plot: uPlot with a linked range, a linked pointer and two cursors. */

import { useEffect, useRef } from "preact/hooks";
import uPlot from "uplot";
import type { PlotData } from "./data";
import { axisLook, bands, columns, errorBars, seriesLook } from "./draw";
import { css, useDark } from "./hooks";
import { store } from "./store";

interface Properties {
  data: PlotData;
  title: string;
  xLabel: string;
  yLabel: string;
  height: number;
  a: number | null;
  b: number | null;
  range: [number, number] | null;
  onRange: (range: [number, number] | null) => void;
  onCursor: (which: "a" | "b", at: number) => void;
  /** Bands in which rows do not count. */
  shaded?: [number, number][];
  /** Where windows begin. */
  begins?: number[];
}

const LINK = "plots";

function aligned(data: PlotData): uPlot.AlignedData {
  return columns(data) as uPlot.AlignedData;
}

/** Puts the two cursors where they belong: elements over the plot, so that moving them draws nothing again. */
function placeCursors(plot: uPlot, { a, b }: Properties): void {
  for (const [name, at] of [["A", a], ["B", b]] as const) {
    let line = plot.over.querySelector<HTMLElement>(`.place-${name}`);
    if (!line) {
      line = document.createElement("div");
      line.className = `place place-${name}`;
      line.textContent = name;
      plot.over.append(line);
    }
    const x = at === null ? -1 : plot.valToPos(at, "x");
    line.hidden = x < 0 || x > plot.over.clientWidth;
    line.style.transform = `translateX(${Math.round(x)}px)`;
  }
}

/** What does not count and where windows begin, under the data; the cursors follow the scale. */
function marks(own: { current: Properties }): uPlot.Plugin {
  return {
    hooks: {
      drawAxes: [
        (plot) => {
          const { ctx } = plot;
          const { top, height } = plot.bbox;
          ctx.save();
          ctx.fillStyle = css("--shade");
          for (const [from, to] of own.current.shaded ?? []) {
            const [left, right] = [plot.valToPos(from, "x", true), plot.valToPos(to, "x", true)];
            ctx.fillRect(left, top, right - left, height);
          }
          ctx.strokeStyle = css("--soft");
          ctx.setLineDash([2 * devicePixelRatio, 4 * devicePixelRatio]);
          ctx.beginPath();
          for (const begin of own.current.begins ?? []) {
            const x = plot.valToPos(begin, "x", true);
            if (x < plot.bbox.left || x > plot.bbox.left + plot.bbox.width) continue;
            ctx.moveTo(x, top);
            ctx.lineTo(x, top + height);
          }
          ctx.stroke();
          ctx.restore();
        },
      ],
      draw: [
        (plot) => {
          placeCursors(plot, own.current);
          store.drawn();
        },
      ],
    },
  };
}

function options(own: { current: Properties }, width: number): uPlot.Options {
  const { data, xLabel, yLabel, height } = own.current;
  const axis = axisLook();
  return {
    width,
    height,
    padding: [8, 10, 0, 0],
    legend: { show: false },
    pxAlign: 0,
    cursor: {
      sync: { key: LINK, scales: ["x", null] },
      drag: { x: true, y: false },
      points: { size: 6 },
    },
    scales: { x: { time: false, range: (_plot, low, high) => own.current.range ?? [low, high] } },
    axes: [
      { ...axis, label: xLabel, size: 34 },
      { ...axis, label: yLabel, size: 52 },
    ],
    series: [{}, ...data.series.map(seriesLook)],
    hooks: {
      setSelect: [
        (plot) => {
          const { left, width: wide } = plot.select;
          if (wide < 4) return;
          own.current.onRange([plot.posToVal(left, "x"), plot.posToVal(left + wide, "x")]);
          plot.setSelect({ left: 0, top: 0, width: 0, height: 0 }, false);
        },
      ],
    },
    plugins: [bands(() => own.current.data), errorBars(() => own.current.data), marks(own)],
  };
}

export function Plot(properties: Properties) {
  const host = useRef<HTMLDivElement>(null);
  const plot = useRef<uPlot | null>(null);
  const own = useRef(properties);
  const dark = useDark();
  own.current = properties;
  const { data, height, xLabel, yLabel, title } = properties;
  // Another number of series, another theme or another axis is another plot; other values are not.
  const shape = `${data.series.map((one) => `${one.stroke}${one.points}${one.dash ?? ""}${Boolean(one.band)}`).join()} ${dark} ${xLabel} ${yLabel}`;

  useEffect(() => {
    const place = host.current;
    if (!place) return;
    const made = new uPlot(options(own, place.clientWidth || 320), aligned(own.current.data), place);
    plot.current = made;
    const seen = new ResizeObserver(() => made.setSize({ width: place.clientWidth, height }));
    seen.observe(place);
    let pressed: number | null = null;
    const down = (event: MouseEvent) => (pressed = event.clientX);
    const up = (event: MouseEvent) => {
      const still = pressed !== null && Math.abs(event.clientX - pressed) < 4;
      pressed = null;
      if (!still) return;
      const at = made.posToVal(event.clientX - made.over.getBoundingClientRect().left, "x");
      own.current.onCursor(event.shiftKey ? "b" : "a", at);
    };
    const all = () => own.current.onRange(null);
    made.over.addEventListener("mousedown", down);
    made.over.addEventListener("mouseup", up);
    made.over.addEventListener("dblclick", all);
    return () => {
      seen.disconnect();
      made.destroy();
      plot.current = null;
    };
  }, [shape, height]);

  useEffect(() => {
    plot.current?.setData(aligned(data), true);
  }, [data]);

  useEffect(() => {
    const made = plot.current;
    if (!made) return;
    const [low, high] = properties.range ?? [data.x[0] ?? 0, data.x[data.x.length - 1] ?? 1];
    made.setScale("x", { min: low, max: high });
  }, [properties.range?.[0], properties.range?.[1], shape]);

  useEffect(() => {
    plot.current?.redraw(false, false);
  }, [properties.shaded, properties.begins]);

  useEffect(() => {
    if (plot.current) placeCursors(plot.current, properties);
  }, [properties.a, properties.b]);

  return (
    <figure class="plot">
      <figcaption>{title}</figcaption>
      <div ref={host} class="canvas" role="img" aria-label={`${title}: measured and modelled over ${xLabel}`} style={{ height: `${height}px` }} />
    </figure>
  );
}
