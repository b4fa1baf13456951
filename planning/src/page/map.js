// The map: heights with shades, or the cost, north up; the routes over it.
const plan = at("map");
plan.style.aspectRatio = `${map.columns} / ${map.rows}`;
const STOPS = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]];
const UNKNOWN = [122, 59, 143];
const BARRED = [25, 25, 25];

function shade_of(c, r) {
  const z = height(c, r);
  if (z === null) return UNKNOWN;
  const [east, north] = [height(c + 1, r) ?? z, height(c, r + 1) ?? z];
  const slope = (z - east - (z - north)) / (1000 * map.cell);
  const grey = 60 + (130 * (z - low)) / Math.max(1, high - low) + Math.max(-50, Math.min(50, 60 * slope));
  return [grey, grey, grey * 0.9];
}

function cost_of(c, r) {
  if (height(c, r) === null) return UNKNOWN;
  const level = data.cost_map.levels[r * map.columns + c];
  if (level === null) return BARRED;
  const place = (level / 255) * (STOPS.length - 1);
  const below = Math.min(Math.floor(place), STOPS.length - 2);
  return STOPS[below].map((from, k) => from + (place - below) * (STOPS[below + 1][k] - from));
}

// One picture a layer, a pixel a node; made once.
function layer(of) {
  const picture = document.createElement("canvas");
  [picture.width, picture.height] = [map.columns, map.rows];
  const g = picture.getContext("2d");
  const pixels = g.createImageData(map.columns, map.rows);
  for (let r = 0; r < map.rows; r++) {
    for (let c = 0; c < map.columns; c++) {
      const place = 4 * ((map.rows - 1 - r) * map.columns + c);
      of(c, r).forEach((value, k) => (pixels.data[place + k] = value));
      pixels.data[place + 3] = 255;
    }
  }
  g.putImageData(pixels, 0, 0);
  return picture;
}
const layers = { heights: layer(shade_of), cost: layer(cost_of) };

// A place in the pixels of a map so wide and tall.
const place_in = (wide, tall) => (x, y) => [
  (((x - map.origin[0]) / map.cell + 0.5) * wide) / map.columns,
  tall - (((y - map.origin[1]) / map.cell + 0.5) * tall) / map.rows,
];

function route_line(g, points, { colour: ink, dash }, thick) {
  g.lineJoin = "round";
  g.setLineDash([]);
  g.strokeStyle = "rgba(255,255,255,0.75)";
  g.lineWidth = thick + 2;
  polyline(g, points);
  g.setLineDash(dash);
  g.strokeStyle = ink;
  g.lineWidth = thick;
  polyline(g, points);
  g.setLineDash([]);
}

function cross(g, [x, y], ink) {
  g.strokeStyle = ink;
  g.lineWidth = 2;
  polyline(g, [[x - 4, y - 4], [x + 4, y + 4]]);
  polyline(g, [[x - 4, y + 4], [x + 4, y - 4]]);
}

function drawMap(chosen) {
  const { g, wide, tall } = fitted(plan);
  const place = place_in(wide, tall);
  g.imageSmoothingEnabled = false;
  g.drawImage(layers[at("layer").value], 0, 0, wide, tall);
  g.fillStyle = UNSAFE;
  for (const { x, y } of answer.failures) {
    const [left, top] = place(x, y);
    g.fillRect(left - 1.5, top - 1.5, 3, 3);
  }
  for (const route of routes) {
    route_line(g, route.points.map(([x, y]) => place(x, y)), route, 2);
    route.failures.forEach(({ x, y }) => cross(g, place(x, y), route.colour));
  }
  route_line(g, answer.points.map((p) => place(p.x, p.y)), CHOSEN, 3);
  const p = answer.points[chosen];
  g.fillStyle = HERE;
  g.strokeStyle = "#1d2330";
  g.lineWidth = 1;
  g.beginPath();
  g.arc(...place(p.x, p.y), 6, 0, 7);
  g.fill();
  g.stroke();
}

function legend() {
  const cost = at("layer").value === "cost";
  const parts = cost
    ? [`${data.cost_map.name}: dark ${data.cost_map.least} to light ${data.cost_map.most}${data.cost_map.scale === "logarithm" ? ", by its logarithm" : ""}; black where the rover cannot go.`]
    : [`Heights: dark ${(low / 1000).toFixed(2)} m to light ${(high / 1000).toFixed(2)} m.`];
  if (known.length < map.heights.length) parts.push("Violet: unknown ground.");
  if (answer.failures.length) parts.push("Red dots: places where the rover would fail, found on the way to the plan.");
  if (routes.some((route) => !route.safe)) parts.push("Crosses: places where the rover would fail on another path, in its colour.");
  at("legend").textContent = parts.join(" ");
}
