const { map, answer, rovers, radius } = data;
const degrees = (angle) => (angle * 180) / Math.PI;
const least = (values) => values.reduce((a, b) => Math.min(a, b), Infinity);
const known = map.heights.filter((z) => z !== null);
const low = least(known);
const high = -least(known.map((z) => -z));
const height = (c, r) => (c >= 0 && r >= 0 && c < map.columns && r < map.rows ? map.heights[r * map.columns + c] : null);
const at = (id) => document.getElementById(id);
const on_soil = answer.slip_told !== null;
const number = (value, digits, none = "\u2013") => (value === null ? none : value.toFixed(digits));

// Colours of the routes, told apart also by people who confuse red and green, and by their dashes.
const CHOSEN = { colour: "#1f77ff", dash: [] };
const STYLES = [
  { colour: "#d6409f", dash: [9, 4] },
  { colour: "#00a88f", dash: [3, 3] },
  { colour: "#9a6cff", dash: [12, 3, 3, 3] },
  { colour: "#c98a00", dash: [6, 6] },
  { colour: "#7d8a00", dash: [2, 5] },
];
const routes = answer.alternatives.map((route, k) => ({ ...route, ...STYLES[k % STYLES.length] }));
const HERE = "#ffb000";
const UNSAFE = "#e5484d";

// Colours of text and lines as the page has them now: they change with the scheme.
const colour = (name) => getComputedStyle(document.documentElement).getPropertyValue(name).trim();

// A canvas in the size in which it is shown, with the screen's own pixels; its context and its width and height.
function fitted(canvas) {
  const [wide, tall] = [canvas.clientWidth, canvas.clientHeight];
  const pixels = window.devicePixelRatio || 1;
  if (canvas.width !== Math.round(wide * pixels) || canvas.height !== Math.round(tall * pixels)) {
    canvas.width = Math.round(wide * pixels);
    canvas.height = Math.round(tall * pixels);
  }
  const g = canvas.getContext("2d");
  g.setTransform(pixels, 0, 0, pixels, 0, 0);
  g.clearRect(0, 0, wide, tall);
  g.font = "13px system-ui, sans-serif";
  return { g, wide, tall };
}

function polyline(g, points, close) {
  g.beginPath();
  points.forEach(([x, y], k) => (k ? g.lineTo(x, y) : g.moveTo(x, y)));
  if (close) g.closePath();
  g.stroke();
}

// The slip at a point in words.
function slip_words(p) {
  if (!on_soil) return "";
  const percent = (slip) => `${(100 * slip).toFixed(0)} %`;
  const stuck = p.slip_none > 0 ? `; none is enough on ${percent(p.slip_none)} of the soils looked at` : "";
  if (p.slip === null) {
    return p.pitch > 0 ? "; no slip is enough here: the slope is too steep for the soil" + stuck : "; braking does not hold the rover here" + stuck;
  }
  const [from, to] = [p.slip_low, p.slip_high].map((end) => (end === null ? "where none is enough" : percent(end)));
  return `; slip ${percent(p.slip)} (${from} to ${to})${stuck}`;
}
