// Draws every plot and gives it the colours of the reader's theme, also when the theme changes.
const dark = window.matchMedia("(prefers-color-scheme: dark)");
function themed(layout) {
  const text = dark.matches ? "#e6edf3" : "#1b1f24", grid = dark.matches ? "#30363d" : "#e3e7eb";
  const axis = (a) => Object.assign({}, a, { gridcolor: grid, zerolinecolor: dark.matches ? "#6e7681" : "#9aa4ae", linecolor: grid });
  return Object.assign({}, layout, {
    paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
    font: { color: text, family: "system-ui, sans-serif", size: 12 },
    xaxis: axis(layout.xaxis), yaxis: axis(layout.yaxis),
  });
}
function draw() {
  for (const source of document.querySelectorAll("script[data-plot]")) {
    const plot = JSON.parse(source.textContent);
    Plotly.react(source.dataset.plot, plot.data, themed(plot.layout), { responsive: true, displayModeBar: false });
  }
}
draw();
dark.addEventListener("change", draw);
