const { map, answer, rovers, radius } = data;
const style = getComputedStyle(document.documentElement);
const ink = style.getPropertyValue("--ink");
const line = style.getPropertyValue("--line");
const degrees = (angle) => (angle * 180) / Math.PI;
const known = map.heights.filter((z) => z !== null);
const low = known.reduce((a, b) => Math.min(a, b), Infinity);
const high = known.reduce((a, b) => Math.max(a, b), -Infinity);
const height = (c, r) =>
  c >= 0 && r >= 0 && c < map.columns && r < map.rows ? map.heights[r * map.columns + c] : null;
const least = (values) => values.reduce((a, b) => Math.min(a, b), Infinity);

document.getElementById("summary").textContent =
  `Least ${data.cost}; ${answer.searches} searches, ${answer.evaluations} places evaluated, ` +
  `${answer.failures.length} of them unsafe. Smallest stability angle ${degrees(least(answer.points.map((p) => p.stability))).toFixed(1)} degrees.` +
  answer.remarks.map((remark) => ` Map: ${remark}.`).join("");

// The map: shaded heights, north up.
const plan = document.getElementById("map");
const scale = Math.min(plan.width / map.columns, plan.height / map.rows);
const place = (x, y) => [
  ((x - map.origin[0]) / map.cell + 0.5) * scale,
  plan.height - ((y - map.origin[1]) / map.cell + 0.5) * scale,
];
function drawMap(chosen) {
  const g = plan.getContext("2d");
  g.clearRect(0, 0, plan.width, plan.height);
  for (let r = 0; r < map.rows; r++) {
    for (let c = 0; c < map.columns; c++) {
      const z = height(c, r);
      const east = height(c + 1, r) ?? z;
      const north = height(c, r + 1) ?? z;
      const shade = z === null ? 0 : (z - east - (z - north)) / (1000 * map.cell);
      const grey = 60 + (130 * (z - low)) / Math.max(1, high - low) + Math.max(-50, Math.min(50, 60 * shade));
      g.fillStyle = z === null ? "#7a3b8f" : `rgb(${grey},${grey},${grey * 0.9})`;
      g.fillRect(c * scale, plan.height - (r + 1) * scale, scale + 0.5, scale + 0.5);
    }
  }
  g.fillStyle = "#d23b3b";
  for (const failure of answer.failures) {
    const [x, y] = place(failure.x, failure.y);
    g.fillRect(x - 1.5, y - 1.5, 3, 3);
  }
  g.strokeStyle = "#1f77ff";
  g.lineWidth = 2.5;
  g.beginPath();
  answer.points.forEach((p, k) => (k ? g.lineTo(...place(p.x, p.y)) : g.moveTo(...place(p.x, p.y))));
  g.stroke();
  g.fillStyle = "#ffb000";
  g.beginPath();
  g.arc(...place(answer.points[chosen].x, answer.points[chosen].y), 6, 0, 7);
  g.fill();
}

// The rover on the ground around it, seen from an angle that dragging changes.
const view = { turn: 0.7, lift: 0.5 };
function drawRover(chosen) {
  const canvas = document.getElementById("rover");
  const g = canvas.getContext("2d");
  g.clearRect(0, 0, canvas.width, canvas.height);
  const p = answer.points[chosen];
  const zoom = 420;
  const to = ([x, y, z]) => {
    const [dx, dy, dz] = [x - p.x, y - p.y, z - p.z];
    const across = -dx * Math.sin(view.turn) + dy * Math.cos(view.turn);
    const away = dx * Math.cos(view.turn) + dy * Math.sin(view.turn);
    return [canvas.width / 2 - across * zoom, canvas.height / 2 - (dz * Math.cos(view.lift) + away * Math.sin(view.lift)) * zoom + 20];
  };
  const path = (points, close) => {
    g.beginPath();
    points.forEach((at, k) => (k ? g.lineTo(...to(at)) : g.moveTo(...to(at))));
    if (close) g.closePath();
    g.stroke();
  };
  g.strokeStyle = line;
  g.lineWidth = 1;
  const reach = Math.ceil(0.7 / map.cell);
  const c0 = Math.round((p.x - map.origin[0]) / map.cell);
  const r0 = Math.round((p.y - map.origin[1]) / map.cell);
  const node = (c, r) => {
    const z = height(c, r);
    return z === null ? null : [map.origin[0] + c * map.cell, map.origin[1] + r * map.cell, z / 1000];
  };
  for (let i = -reach; i <= reach; i++) {
    for (const along of [(k) => node(c0 + k, r0 + i), (k) => node(c0 + i, r0 + k)]) {
      const points = [];
      for (let k = -reach; k <= reach; k++) {
        const at = along(k);
        if (at) points.push(at);
      }
      path(points);
    }
  }
  const rover = rovers[chosen];
  g.strokeStyle = ink;
  g.lineWidth = 2.5;
  rover.bars.forEach((bar) => path(bar));
  g.strokeStyle = "#ffb000";
  if (rover.belly.length) path(rover.belly, true);
  g.strokeStyle = "#1f77ff";
  rover.wheels.forEach((centre, k) => {
    const [forward, up] = rover.planes[k];
    const rim = [];
    for (let n = 0; n < 32; n++) {
      const [s, c] = [Math.sin((n * Math.PI) / 16) * radius, Math.cos((n * Math.PI) / 16) * radius];
      rim.push([0, 1, 2].map((axis) => centre[axis] + c * forward[axis] + s * up[axis]));
    }
    path(rim, true);
  });
  document.getElementById("here").textContent =
    `${p.travelled.toFixed(2)} m from the start, at (${p.x.toFixed(2)}, ${p.y.toFixed(2)}) m: roll ${degrees(p.roll).toFixed(1)}, pitch ` +
    `${degrees(p.pitch).toFixed(1)}, stability ${degrees(p.stability).toFixed(1)} degrees; thrust ${p.thrust.toFixed(1)} N`;
}

// Margins along the path, one strip each.
function drawMargins(chosen) {
  const canvas = document.getElementById("margins");
  const g = canvas.getContext("2d");
  g.clearRect(0, 0, canvas.width, canvas.height);
  const strips = [
    ["stability angle, degrees", (p) => degrees(p.stability), degrees(data.stability_limit)],
    ["thrust in reserve, N", (p) => p.thrust, data.thrust_limit],
    ["clearance, m", (p) => p.clearance ?? 0, 0],
  ];
  const length = Math.max(1e-9, answer.length);
  const at = (p) => 60 + (p.travelled / length) * (canvas.width - 80);
  g.font = "13px system-ui";
  strips.forEach(([name, of, limit], k) => {
    const [top, tall] = [k * 140 + 24, 100];
    const most = answer.points.reduce((a, p) => Math.max(a, of(p)), limit * 1.1 || 1e-9);
    const y = (value) => top + tall - (value / most) * tall;
    g.fillStyle = ink;
    g.fillText(name, 60, top - 8);
    g.fillText(most.toPrecision(3), 8, top + 8);
    g.fillText("0", 40, top + tall + 4);
    g.strokeStyle = line;
    g.lineWidth = 1;
    g.strokeRect(60, top, canvas.width - 80, tall);
    g.setLineDash([6, 4]);
    g.strokeStyle = "#d23b3b";
    g.beginPath();
    g.moveTo(60, y(limit));
    g.lineTo(canvas.width - 20, y(limit));
    g.stroke();
    g.setLineDash([]);
    g.strokeStyle = "#1f77ff";
    g.lineWidth = 2;
    g.beginPath();
    answer.points.forEach((p, n) => (n ? g.lineTo(at(p), y(of(p))) : g.moveTo(at(p), y(of(p)))));
    g.stroke();
    g.fillStyle = "#ffb000";
    g.beginPath();
    g.arc(at(answer.points[chosen]), y(of(answer.points[chosen])), 4, 0, 7);
    g.fill();
  });
  g.fillStyle = ink;
  g.fillText(`way from the start, 0 to ${length.toFixed(2)} m`, 60, canvas.height - 8);
}

const slider = document.getElementById("point");
slider.max = answer.points.length - 1;
function draw() {
  const chosen = Number(slider.value);
  drawMap(chosen);
  drawRover(chosen);
  drawMargins(chosen);
}
slider.addEventListener("input", draw);
plan.addEventListener("click", (event) => {
  const box = plan.getBoundingClientRect();
  const [x, y] = [((event.clientX - box.left) * plan.width) / box.width, ((event.clientY - box.top) * plan.height) / box.height];
  const far = answer.points.map((p) => Math.hypot(place(p.x, p.y)[0] - x, place(p.x, p.y)[1] - y));
  slider.value = far.indexOf(least(far));
  draw();
});
document.getElementById("rover").addEventListener("pointermove", (event) => {
  if (event.buttons !== 1) return;
  view.turn += event.movementX * 0.01;
  view.lift = Math.max(0, Math.min(1.5, view.lift + event.movementY * 0.01));
  drawRover(Number(slider.value));
});
slider.value = Math.floor(answer.points.length / 2);
draw();
