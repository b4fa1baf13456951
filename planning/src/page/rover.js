// The rover on the ground around it, seen from an angle that dragging changes.
const view = { turn: answer.points[Math.floor(answer.points.length / 2)].heading + 0.9, lift: 0.5 };
// Largest distance between the first wheel and another, m.
const [x0, y0] = rovers[0].wheels[0];
const span = -least(rovers[0].wheels.map(([x, y]) => -Math.hypot(x - x0, y - y0)));

function drawRover(chosen) {
  const { g, wide, tall } = fitted(at("rover"));
  const p = answer.points[chosen];
  const around = 1.35 * span;
  const zoom = (0.46 * wide) / around;
  const to = ([x, y, z]) => {
    const [dx, dy, dz] = [x - p.x, y - p.y, z - p.z];
    const across = -dx * Math.sin(view.turn) + dy * Math.cos(view.turn);
    const away = dx * Math.cos(view.turn) + dy * Math.sin(view.turn);
    return [wide / 2 - across * zoom, tall / 2 - (dz * Math.cos(view.lift) + away * Math.sin(view.lift)) * zoom + 20];
  };
  const path = (points, close) => polyline(g, points.map(to), close);
  g.strokeStyle = colour("--line");
  g.lineWidth = 1;
  const reach = Math.ceil(around / map.cell);
  const c0 = Math.round((p.x - map.origin[0]) / map.cell);
  const r0 = Math.round((p.y - map.origin[1]) / map.cell);
  const node = (c, r) => {
    const z = height(c, r);
    return z === null ? null : [map.origin[0] + c * map.cell, map.origin[1] + r * map.cell, z / 1000];
  };
  // Fine maps are drawn with each second or third line.
  const each = Math.max(1, Math.round(reach / 18));
  for (let i = -reach; i <= reach; i += each) {
    for (const along of [(k) => node(c0 + k, r0 + i), (k) => node(c0 + i, r0 + k)]) {
      const points = [];
      for (let k = -reach; k <= reach; k++) {
        const there = along(k);
        if (there) points.push(there);
      }
      path(points);
    }
  }
  const rover = rovers[chosen];
  g.strokeStyle = colour("--ink");
  g.lineWidth = 2.5;
  rover.bars.forEach((bar) => path(bar));
  g.strokeStyle = HERE;
  if (rover.belly.length) path(rover.belly, true);
  g.strokeStyle = CHOSEN.colour;
  rover.wheels.forEach((centre, k) => {
    const [forward, up] = rover.planes[k];
    const rim = [];
    for (let n = 0; n < 32; n++) {
      const [s, c] = [Math.sin((n * Math.PI) / 16) * radius, Math.cos((n * Math.PI) / 16) * radius];
      rim.push([0, 1, 2].map((axis) => centre[axis] + c * forward[axis] + s * up[axis]));
    }
    path(rim, true);
  });
  at("here").textContent =
    `${p.travelled.toFixed(2)} m from the start, at (${p.x.toFixed(2)}, ${p.y.toFixed(2)}) m: roll ${degrees(p.roll).toFixed(1)}, pitch ` +
    `${degrees(p.pitch).toFixed(1)}, stability ${degrees(p.stability).toFixed(1)} degrees; thrust ${p.thrust.toFixed(1)} N${slip_words(p)}.`;
}
