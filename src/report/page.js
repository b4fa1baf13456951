// Draws every plot when it comes into view and gives it the colours of the reader's theme, also when the theme changes.
const dark = window.matchMedia("(prefers-color-scheme: dark)");
const hosts = [...document.querySelectorAll(".plot")];
const sources = new Map();
function source(host) {
  const id = host.dataset.again || host.id;
  if (!sources.has(id)) sources.set(id, JSON.parse(document.querySelector(`script[data-plot='${id}']`).textContent));
  return sources.get(id);
}
function themed(layout) {
  const text = dark.matches ? "#e6edf3" : "#1b1f24", grid = dark.matches ? "#30363d" : "#e3e7eb";
  const axis = (a) => Object.assign({}, a, { gridcolor: grid, zerolinecolor: dark.matches ? "#6e7681" : "#9aa4ae", linecolor: grid });
  return Object.assign({}, layout, {
    paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
    font: { color: text, family: "system-ui, sans-serif", size: 12 },
    hoverlabel: { font: { family: "system-ui, sans-serif" } },
    dragmode: false,
    xaxis: axis(layout.xaxis), yaxis: axis(layout.yaxis),
  });
}
// Whether the buttons, boxes and lists around a plot show a trace: its meta is `key=value;..`.
function chosen(host, meta) {
  const frame = host.closest(".filtered");
  if (!frame || typeof meta !== "string") return true;
  return meta.split(";").every((pair) => {
    const [key, value] = pair.split("=");
    const controls = [...frame.querySelectorAll(`[data-key="${key}"]`)];
    const holds = (c) => c.value === "all" || c.value.split(" ").includes(value);
    const agrees = (c) => (c.type === "checkbox" || c.type === "radio" ? c.checked : true) && holds(c);
    return controls.length === 0 || controls.some(agrees);
  });
}
function trace(host, data) {
  const shown = Object.assign({}, data, { visible: chosen(host, data.meta) });
  if (data.type === "heatmap") {
    const middle = dark.matches ? "#161b22" : "#f6f8fa";
    shown.colorscale = [[0, "#2f6fd6"], [0.5, middle], [1, "#d97706"]];
  }
  return shown;
}
function draw(host) {
  const plot = source(host);
  if (plot.layout.height) host.style.height = `${plot.layout.height}px`;
  const options = { responsive: true, displayModeBar: false };
  Plotly.react(host, plot.data.map((data) => trace(host, data)), themed(plot.layout), options);
  host.dataset.drawn = "yes";
  host.dispatchEvent(new Event("plot-drawn", { bubbles: true }));
}
// Parts of a filtered frame that stand there only under some choice.
function show(frame) {
  for (const part of frame.querySelectorAll("[data-when]")) part.hidden = !chosen(part, part.dataset.when);
}
document.querySelectorAll(".filtered").forEach(show);
const drawn = () => hosts.filter((host) => host.dataset.drawn);
const seen = new IntersectionObserver((entries) => {
  for (const entry of entries) if (entry.isIntersecting && !entry.target.dataset.drawn) draw(entry.target);
}, { rootMargin: "800px" });
hosts.forEach((host) => seen.observe(host));
dark.addEventListener("change", () => drawn().forEach(draw));
window.addEventListener("beforeprint", () => hosts.forEach(draw));
document.addEventListener("change", (event) => {
  const frame = event.target.closest(".filtered");
  if (!frame) return;
  show(frame);
  drawn().filter((host) => frame.contains(host)).forEach(draw);
});
