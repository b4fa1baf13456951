const slider = at("point");
slider.max = answer.points.length - 1;
function draw() {
  const chosen = Number(slider.value);
  drawMap(chosen);
  drawRover(chosen);
  drawMargins(chosen);
}
slider.addEventListener("input", draw);
at("layer").addEventListener("change", () => {
  legend();
  draw();
});
plan.addEventListener("click", (event) => {
  const box = plan.getBoundingClientRect();
  const place = place_in(box.width, box.height);
  const far = answer.points.map((p) => {
    const [x, y] = place(p.x, p.y);
    return Math.hypot(x - event.clientX + box.left, y - event.clientY + box.top);
  });
  slider.value = far.indexOf(least(far));
  draw();
});
at("margins").addEventListener("click", (event) => {
  const box = at("margins").getBoundingClientRect();
  const way = ((event.clientX - box.left - LEFT) / (box.width - LEFT - RIGHT)) * length;
  const far = answer.points.map((p) => Math.abs(p.travelled - way));
  slider.value = far.indexOf(least(far));
  draw();
});
at("rover").addEventListener("pointerdown", (event) => event.target.setPointerCapture(event.pointerId));
at("rover").addEventListener("pointermove", (event) => {
  if (event.buttons !== 1) return;
  view.turn += event.movementX * 0.01;
  view.lift = Math.max(0, Math.min(1.5, view.lift + event.movementY * 0.01));
  drawRover(Number(slider.value));
});
window.addEventListener("resize", draw);
window.matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
slider.value = Math.floor(answer.points.length / 2);
legend();
draw();
