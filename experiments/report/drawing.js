"use strict";
{
  const scene = document.getElementById("scene");
  const figure = JSON.parse(document.getElementById("figure").textContent);
  const buttons = [...document.querySelectorAll(".toggles button")];
  const style = getComputedStyle(document.documentElement);
  const colour = (name) => style.getPropertyValue(`--${name}`).trim();

  function paintGround() {
    const { ground } = figure;
    if (ground.type === "mesh3d") {
      ground.color = colour(ground.opacity < 1 ? "ground-high" : "ground-middle");
      return;
    }
    ground.colorscale = [[0, colour("ground-low")], [0.5, colour("ground-middle")], [1, colour("ground-high")]];
    ground.contours.z.color = colour("contour");
  }

  function paintLines() {
    buttons.forEach((button, i) => {
      figure.lines[i].line.color = getComputedStyle(button).getPropertyValue("--hue").trim();
      button.setAttribute("aria-pressed", String(figure.lines[i].visible));
    });
  }

  function paintAxes() {
    figure.layout.font = { color: colour("muted"), family: getComputedStyle(document.body).fontFamily, size: 11 };
    for (const axis of ["xaxis", "yaxis", "zaxis"]) figure.layout.scene[axis].gridcolor = colour("rule");
    for (const end of figure.layout.scene.annotations) {
      Object.assign(end, { font: { color: colour("ink"), size: 13 }, arrowcolor: colour("muted"), bgcolor: colour("paper") });
    }
  }

  function draw() {
    paintGround();
    paintLines();
    paintAxes();
    const traces = [figure.ground, ...figure.lines];
    return Plotly.react(scene, traces, figure.layout, { responsive: true, displayModeBar: false });
  }

  function toggle(i) {
    figure.lines[i].visible = !figure.lines[i].visible;
    draw();
  }

  function stepBack() {
    const narrow = Math.max(1, (1.55 * scene.clientHeight) / scene.clientWidth);
    const { eye } = figure.layout.scene.camera;
    for (const axis of ["x", "y", "z"]) eye[axis] *= narrow;
  }

  buttons.forEach((button, i) => button.addEventListener("click", () => toggle(i)));
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", draw);
  stepBack();
  draw();
}
