// Along the path, one strip each: margins, and slip with its band.
const strips = [
  { name: "stability angle, degrees", of: (p) => degrees(p.stability), limit: degrees(data.stability_limit) },
  { name: "thrust in reserve, N", of: (p) => p.thrust, limit: data.thrust_limit },
];
if (answer.points.some((p) => p.clearance !== null)) {
  strips.push({ name: "clearance, m", of: (p) => p.clearance, limit: data.clearance_limit });
}
if (on_soil) {
  strips.push({ name: "slip, % (shaded: its band)", of: (p) => p.slip === null ? null : 100 * p.slip, limit: 100 * data.slip_limit, slip: true });
}
const [TALL, GAP, LEFT, RIGHT] = [96, 46, 46, 12];
at("margins").style.height = `${strips.length * (TALL + GAP) + 20}px`;
const length = Math.max(1e-9, answer.length);

// Numbers for the axis of a strip: from 0, or below it, to what is largest.
function range(strip) {
  const values = answer.points.map(strip.of).filter((value) => value !== null);
  if (!strip.slip) return [Math.min(0, least(values)), Math.max(-least(values.map((v) => -v)), strip.limit * 1.1) || 1];
  // An end beyond every slip reaches the frame.
  const open = answer.points.some((p) => p.slip_high === null);
  const ends = answer.points.flatMap((p) => [p.slip_low, p.slip_high].filter((end) => end !== null).map((end) => 100 * end));
  const all = [...values, ...ends, strip.limit];
  return [Math.min(0, least(all)), open ? 100 : Math.min(100, -least(all.map((v) => -v)) * 1.05)];
}

function drawStrip(g, strip, k, wide, chosen) {
  const top = k * (TALL + GAP) + 24;
  const [from, to] = range(strip);
  const x = (p) => LEFT + (p.travelled / length) * (wide - LEFT - RIGHT);
  const y = (value) => top + TALL - ((Math.max(from, Math.min(to, value)) - from) / (to - from)) * TALL;
  const ink = colour("--ink");
  g.fillStyle = ink;
  g.textAlign = "left";
  g.fillText(strip.name, LEFT, top - 8);
  g.textAlign = "right";
  g.fillText(Number(to.toPrecision(3)), LEFT - 5, top + 10);
  g.fillText("0", LEFT - 5, y(0) + (from < 0 ? 4 : 0));
  g.strokeStyle = colour("--line");
  g.lineWidth = 1;
  g.strokeRect(LEFT, top, wide - LEFT - RIGHT, TALL);
  if (strip.slip) drawBand(g, x, y, top, from, to);
  g.setLineDash([6, 4]);
  g.strokeStyle = UNSAFE;
  g.lineWidth = 1.5;
  polyline(g, [[LEFT, y(strip.limit)], [wide - RIGHT, y(strip.limit)]]);
  g.setLineDash([]);
  g.strokeStyle = CHOSEN.colour;
  g.lineWidth = 2;
  // The line is interrupted where there is no value.
  let run = [];
  for (const p of [...answer.points, null]) {
    const value = p && strip.of(p);
    if (p && value !== null) run.push([x(p), y(value)]);
    else if (run.length) {
      polyline(g, run);
      run = [];
    }
  }
  const p = answer.points[chosen];
  const value = strip.of(p);
  g.fillStyle = HERE;
  g.beginPath();
  g.arc(x(p), value === null ? top : y(value), 5, 0, 7);
  g.fill();
  g.textAlign = "left";
}

// The band of the slip; open ends reach the frame, and ground on which no slip is enough is marked.
function drawBand(g, x, y, top, from, to) {
  const points = answer.points;
  g.fillStyle = CHOSEN.colour + "33";
  g.beginPath();
  points.forEach((p, k) => g[k ? "lineTo" : "moveTo"](x(p), y(p.slip_high === null ? to : 100 * p.slip_high)));
  [...points].reverse().forEach((p) => g.lineTo(x(p), y(p.slip_low === null ? from : 100 * p.slip_low)));
  g.fill();
  let told = false;
  points.forEach((p, k) => {
    if (p.slip !== null) return;
    const [before, after] = [points[Math.max(0, k - 1)], points[Math.min(points.length - 1, k + 1)]];
    const [left, right] = [(x(before) + x(p)) / 2, (x(p) + x(after)) / 2];
    g.fillStyle = UNSAFE + "55";
    g.fillRect(left, top, Math.max(2, right - left), TALL);
    if (told) return;
    told = true;
    g.fillStyle = colour("--ink");
    g.textAlign = x(p) < 260 ? "left" : "right";
    g.fillText(p.pitch > 0 ? "too steep: no slip is enough" : "braking does not hold", x(p) + (x(p) < 260 ? 6 : -6), top + 16);
    g.textAlign = "left";
  });
}

function drawMargins(chosen) {
  const { g, wide, tall } = fitted(at("margins"));
  strips.forEach((strip, k) => drawStrip(g, strip, k, wide, chosen));
  g.fillStyle = colour("--ink");
  g.fillText(`way from the start, 0 to ${length.toFixed(2)} m`, LEFT, tall - 6);
}
