"use strict";
antgym.scene = (() => {
  const { site, colour, element, swatch } = antgym;
  const scene = document.getElementById("scene");
  const toggles = document.querySelector(".toggles");
  let picture = null;

  function paintGround() {
    const { ground } = picture;
    if (ground.type === "mesh3d") {
      ground.color = colour(ground.opacity < 1 ? "ground-high" : "ground-middle");
      return;
    }
    ground.colorscale = [[0, colour("ground-low")], [0.5, colour("ground-middle")], [1, colour("ground-high")]];
    ground.contours.z.color = colour("contour");
  }

  function paintLines() {
    picture.lines.forEach((line, i) => {
      const agent = site.agents[picture.paths[i].agent];
      Object.assign(line.line, { color: colour(agent.colour), dash: agent.dash, width: agent.dash === "solid" ? 5 : 7 });
      toggles.children[i].firstElementChild.setAttribute("aria-pressed", String(line.visible));
    });
  }

  function paintAxes() {
    const { layout } = picture;
    layout.font = { color: colour("muted"), family: getComputedStyle(document.body).fontFamily, size: 11 };
    for (const axis of ["xaxis", "yaxis", "zaxis"]) layout.scene[axis].gridcolor = colour("rule");
    for (const end of layout.scene.annotations) {
      Object.assign(end, { font: { color: colour("ink"), size: 13 }, arrowcolor: colour("muted"), bgcolor: colour("paper") });
    }
  }

  function draw() {
    paintGround();
    paintLines();
    paintAxes();
    return Plotly.react(scene, [picture.ground, ...picture.lines], picture.layout, { responsive: true, displayModeBar: false });
  }

  function toggle(line) {
    line.visible = !line.visible;
    draw();
  }

  function listPaths() {
    toggles.replaceChildren(...picture.paths.map(({ agent, note }, i) => {
      const named = element("span", { class: "name" }, site.agents[agent].name.replace(/[_:]/g, "$&\u200b")); // may break there
      const button = element("button", { type: "button" }, swatch(site.agents[agent]), named, element("span", { class: "note" }, note));
      button.addEventListener("click", () => toggle(picture.lines[i]));
      return element("li", {}, button);
    }));
  }

  function stepBack() {
    const narrow = Math.max(1, (1.55 * scene.clientHeight) / scene.clientWidth);
    const { eye } = picture.layout.scene.camera;
    for (const axis of ["x", "y", "z"]) eye[axis] *= narrow;
  }

  function show(given) {
    if (picture === given) return;
    picture = given;
    if (!picture.stepped) stepBack();
    picture.stepped = true;
    listPaths();
    draw();
  }

  document.addEventListener("theme", () => { if (picture) draw(); });
  return { show };
})();
