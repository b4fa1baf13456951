// What was planned and what there was to choose from, in words and a table.
function stuck() {
  const places = on_soil ? answer.points.filter((p) => p.slip === null) : [];
  if (!places.length) return "";
  const first = places[0].travelled.toFixed(2);
  return ` At ${places.length} of ${answer.points.length} places, first ${first} m from the start, no slip is enough on the soil as it is stated, with an equal share of the load on each wheel.`;
}

at("summary").textContent =
  `Least ${data.cost}; ${answer.searches} searches, ${answer.evaluations} places evaluated, ` +
  `${answer.failures.length} of them unsafe. Smallest stability angle ${degrees(least(answer.points.map((p) => p.stability))).toFixed(1)} degrees.` +
  stuck() +
  answer.remarks.map((remark) => ` Map: ${remark}.`).join("");

function swatch({ colour: ink, dash }) {
  const svg = document.createElementNS("http://www.w3.org/2000/svg", "svg");
  svg.setAttribute("viewBox", "0 0 36 8");
  svg.setAttribute("class", "swatch");
  svg.setAttribute("aria-hidden", "true");
  svg.innerHTML = `<line x1="0" y1="4" x2="36" y2="4" stroke="${ink}" stroke-width="4" stroke-dasharray="${dash.join(" ")}"/>`;
  return svg;
}

function row(route, style, chosen) {
  const cells = [
    [number(route.length, 2), "length, m"],
    [number(route.cost, data.by_energy ? 1 : 3), data.by_energy ? "energy by the ground's slopes, J" : "performance index"],
    ...(on_soil ? [[number(route.energy, 1), "energy by the rover's slopes, J"]] : []),
    [route.stability === null ? "\u2013" : degrees(route.stability).toFixed(1), "least stability, degrees"],
    [number(route.thrust, 1), "least thrust, N"],
    ...(on_soil ? [[route.slip === null ? "\u2013" : (100 * route.slip).toFixed(0), "largest slip, %"]] : []),
  ];
  const line = document.createElement("tr");
  const name = document.createElement("th");
  name.scope = "row";
  name.append(swatch(style), " ", route.name);
  line.append(name);
  for (const [text, label] of cells) {
    const cell = line.insertCell();
    cell.textContent = text;
    cell.dataset.label = label;
  }
  const verdict = line.insertCell();
  verdict.className = "verdict";
  if (chosen) verdict.textContent = "chosen: safe at every place, at the least cost the planner found";
  else {
    const mark = document.createElement("b");
    mark.textContent = route.safe ? "safe" : "not safe";
    mark.className = route.safe ? "safe" : "unsafe";
    verdict.append(mark, route.verdict.replace(/^(not )?safe/, ""));
  }
  return { line, names: cells.map(([, text]) => text) };
}

if (data.chosen) {
  const table = at("routes");
  const first = row(data.chosen, CHOSEN, true);
  const head = table.createTHead().insertRow();
  for (const text of ["path", ...first.names, "beside the plan"]) {
    const cell = document.createElement("th");
    cell.scope = "col";
    cell.textContent = text;
    head.append(cell);
  }
  table.createTBody().append(first.line, ...routes.map((route) => row(route, route, false).line));
  at("missing").append(
    ...answer.alternatives_missing.map((text) => {
      const item = document.createElement("li");
      item.textContent = text;
      return item;
    }),
  );
  const unit = data.by_energy ? "energy by the ground's slopes" : "performance index";
  at("told").textContent =
    `The plan has the least ${unit} of what its planner knows. Thrust and stability are the worst of all cases.` +
    (on_soil ? ` Energy by the rover's slopes is that of the soil as it is stated; a dash where the path is not safe, or needs more slip than ${(100 * data.slip_limit).toFixed(0)} %.` : "");
  at("alternatives").hidden = false;
}
at("slip").textContent = answer.slip_told ?? "";
