// The rover on its ground: two plots, a slider over the rows of a run, and a line of numbers.
function sceneOf(host) {
  const data = JSON.parse(host.querySelector(".scene-data").textContent);
  const part = (name) => host.querySelector(`.${name}`);
  const [runs, models, slider, play] = [part("run"), part("model"), part("time"), part("play")];
  const [whole, near, readout] = [part("whole-run"), part("rover-view"), part("readout")];
  const state = { run: 0, model: data.shown, row: 0, timer: null };
  const text = () => (dark.matches ? "#e6edf3" : "#1b1f24");
  const run = () => data.runs[state.run];
  const model = () => run().models[state.model] || Object.values(run().models)[0];
  const style = () => data.models.find((own) => own.key === state.model) || data.models[0];
  const scale = { color: null, colorscale: data.colours, cmin: 0, cmax: data.large };
  // Height of the ground at x, straight between its points.
  function ground(x) {
    const [xs, zs] = run().ground;
    let k = xs.findIndex((at) => at >= x);
    k = k < 0 ? xs.length - 1 : Math.max(k, 1);
    return zs[k - 1] + (zs[k] - zs[k - 1]) * (x - xs[k - 1]) / (xs[k] - xs[k - 1]);
  }
  // The model's chassis and wheels at a row; null where it has no answer.
  function modelled(row) {
    const own = model();
    if (own.x[row] === null) return null;
    return { x: own.x[row], z: own.z[row], pitch: own.pitch[row], wheels: own.wheels.map(([x, z]) => [x[row], z[row]]) };
  }
  // The measured rover: what was not measured is the model's, carried along the ground.
  function ghost(row) {
    const { x, z, pitch } = run().measured, base = modelled(row);
    if (!x || x[row] === null || !base) return null;
    const at = { x: x[row], pitch: pitch && pitch[row] !== null ? pitch[row] : base.pitch };
    at.z = z && z[row] !== null ? z[row] : base.z + ground(at.x) - ground(base.x);
    const turn = at.pitch - base.pitch, [c, s] = [Math.cos(turn), Math.sin(turn)];
    at.wheels = base.wheels.map(([wx, wz]) => {
      const [dx, dz] = [wx - base.x, wz - base.z];
      return [at.x + c * dx - s * dz, at.z + s * dx + c * dz];
    });
    return at;
  }
  // Lines of a rover: its wheels as circles with a spoke, the chassis from its reference point to each wheel.
  function outline(rover) {
    const x = [], z = [];
    for (const [cx, cz] of rover.wheels) {
      for (let k = 0; k <= 36; k++) {
        x.push(cx + data.radius * Math.sin(k * Math.PI / 18));
        z.push(cz + data.radius * Math.cos(k * Math.PI / 18));
      }
      x.push(null, cx, rover.x, null);
      z.push(null, cz, rover.z, null);
    }
    return [x, z];
  }
  function layout(x, z, more) {
    return themed(Object.assign({
      margin: { l: 50, r: 14, t: 8, b: 40 }, showlegend: true, uirevision: "stay",
      legend: { orientation: "h", x: 0, y: 1.02, yanchor: "bottom" },
      xaxis: Object.assign({ title: { text: "position x (m)" }, zeroline: false }, x),
      yaxis: Object.assign({ title: { text: "height (m)" }, zeroline: false, automargin: true }, z),
    }, more));
  }
  const options = { responsive: true, displayModeBar: false };
  function drawWhole() {
    const own = model(), { measured } = run(), here = modelled(state.row), there = ghost(state.row);
    const under = own.x.map((x) => (x === null ? null : ground(x)));
    const counts = own.error.map((error) => error !== null);
    const pick = (list, keep) => list.filter((_, k) => counts[k] === keep);
    const marker = Object.assign({}, scale, { color: pick(own.error, true), size: 7 });
    const traces = [
      { x: run().ground[0], y: run().ground[1], mode: "lines", line: { color: "#8b949e", width: 1.5 }, name: "ground", hoverinfo: "skip" },
      { x: pick(own.x, false), y: pick(under, false), mode: "markers", name: "not counted", marker: { color: "#8b949e", size: 5, symbol: "x-thin", line: { width: 1.5, color: "#8b949e" } }, hoverinfo: "skip" },
      { x: pick(own.x, true), y: pick(under, true), mode: "markers", name: "error", marker, showlegend: false, customdata: own.x.map((_, k) => k).filter((k) => counts[k]),
        hovertext: pick(own.error, true).map((error, k) => `error ${error.toFixed(1)} times the ${data.measure}`), hoverinfo: "text" },
      { x: own.x, y: own.z, mode: "lines", name: style().short, line: { color: style().colour, width: 1.5 }, hoverinfo: "skip" },
    ];
    if (measured.x && measured.z) {
      traces.push({ x: measured.x, y: measured.z, mode: "markers", name: "measured", marker: { color: text(), size: 3, opacity: 0.5 }, hoverinfo: "skip" });
    }
    const place = (rover, name, colour, symbol) => rover && traces.push({
      x: [rover.x], y: [rover.z], mode: "markers", name, showlegend: false, marker: { color: colour, size: 13, symbol, line: { width: 2, color: colour } }, hoverinfo: "skip",
    });
    place(there, "measured now", text(), "circle-open");
    place(here, "model now", style().colour, "diamond");
    Plotly.react(whole, traces, layout({}, {}, {}), options);
  }
  function drawNear() {
    const here = modelled(state.row), there = ghost(state.row), middle = there || here;
    // The soil under the ground: down to below what is shown.
    const [xs, zs] = run().ground, bottom = Math.min(...zs) - 100 * data.radius;
    const traces = [{ x: [...xs, xs[xs.length - 1], xs[0]], y: [...zs, bottom, bottom], mode: "lines", fill: "toself", fillcolor: "rgba(139, 148, 158, 0.18)", line: { color: "#8b949e", width: 2 }, name: "ground", showlegend: false, hoverinfo: "skip" }];
    const add = (rover, name, line) => {
      if (!rover) return;
      const [x, y] = outline(rover);
      traces.push({ x, y, mode: "lines", name, line, hoverinfo: "skip" });
    };
    add(there, "measured", { color: text(), width: 2, dash: "dot" });
    add(here, style().name, { color: style().colour, width: 3 });
    const reach = middle ? Math.max(...middle.wheels.map(([x]) => Math.abs(x - middle.x))) + 3 * data.radius : 1;
    const [x, z] = middle ? [middle.x, ground(middle.x)] : [0, 0];
    Plotly.react(near, traces, layout(
      { range: [x - 1.3 * reach, x + 1.3 * reach] },
      { range: [z - 0.5 * reach, z + 1.1 * reach], scaleanchor: "x", scaleratio: 1 }, { uirevision: null },
    ), options);
  }
  function tell() {
    const here = modelled(state.row), there = ghost(state.row), own = model(), k = state.row;
    const degrees = (angle) => `${(angle * 180 / Math.PI).toFixed(1)}°`;
    const both = (name, measured, of, unit) => `${name} ${measured === null || measured === undefined ? "not measured" : of(measured) + unit}, model ${here ? of(here[name]) + unit : "has no answer"}`;
    const pitch = run().measured.pitch;
    const parts = [`t = ${run().time[k].toFixed(1)} s`, both("x", there && there.x, (v) => v.toFixed(2), " m"), both("pitch", pitch ? pitch[k] : null, degrees, "")];
    if (own.slope[k] !== null) parts.push(`slope ${degrees(own.slope[k])}`);
    const why = run().why[k];
    if (why > 0) parts.push(`not counted: ${data.reasons[why - 1]}`);
    else if (own.error[k] !== null) parts.push(`error of the worst signal ${own.error[k].toFixed(1)} times its ${data.measure}`);
    readout.textContent = parts.join(" · ");
  }
  function draw() { drawWhole(); drawNear(); tell(); }
  function show(run, time) {
    state.run = run;
    runs.value = String(run);
    slider.max = String(data.runs[run].time.length - 1);
    const at = data.runs[run].time.findIndex((t) => t >= time);
    state.row = at < 0 ? data.runs[run].time.length - 1 : at;
    slider.value = String(state.row);
    if (host.dataset.drawn) draw();
  }
  function stop() {
    clearInterval(state.timer);
    state.timer = null;
    play.textContent = "Play";
  }
  runs.addEventListener("change", () => { stop(); show(Number(runs.value), -Infinity); });
  models.addEventListener("change", () => { state.model = models.value; draw(); });
  slider.addEventListener("input", () => { state.row = Number(slider.value); draw(); });
  play.addEventListener("click", () => {
    if (state.timer) return stop();
    play.textContent = "Stop";
    if (state.row >= Number(slider.max)) state.row = 0;
    const time = run().time, step = Math.max(1, Math.round(0.2 / Math.max((time[time.length - 1] - time[0]) / time.length, 1e-3)));
    state.timer = setInterval(() => {
      state.row = Math.min(state.row + step, Number(slider.max));
      slider.value = String(state.row);
      draw();
      if (state.row >= Number(slider.max)) stop();
    }, 200);
  });
  // It begins where the model fails most.
  let worst = [0, 0, -1];
  data.runs.forEach((own, k) => (own.models[data.shown] || { error: [] }).error.forEach((error, row) => {
    if (error !== null && error > worst[2]) worst = [k, row, error];
  }));
  show(worst[0], data.runs[worst[0]].time[worst[1]]);
  const seenScene = new IntersectionObserver((entries) => {
    if (entries.some((entry) => entry.isIntersecting) && !host.dataset.drawn) {
      host.dataset.drawn = "yes";
      draw();
      whole.on("plotly_click", (event) => {
        const row = event.points.map((point) => point.customdata).find((at) => typeof at === "number");
        if (row !== undefined) show(state.run, run().time[row]);
      });
    }
  }, { rootMargin: "800px" });
  seenScene.observe(host);
  dark.addEventListener("change", () => host.dataset.drawn && draw());
  return show;
}
const scenes = [...document.querySelectorAll(".scene")].map(sceneOf);
// A window chosen in the map of windows is shown on its ground.
document.addEventListener("plot-drawn", (event) => {
  const map = event.target;
  if (!map.closest(".windows")) return;
  map.removeAllListeners && map.removeAllListeners("plotly_click");
  map.on("plotly_click", (clicked) => {
    const [run, time] = clicked.points[0].customdata;
    scenes.forEach((show) => show(run, time));
  });
});
