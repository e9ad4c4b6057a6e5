"use strict";
{
  const { site, colour, element, swatch } = antgym;
  const legend = document.querySelector(".legend");
  const symbols = { solid: "circle", dot: "square", dash: "diamond", dashdot: "triangle-up" };
  const bands = 3; // of so many curves, or of the one that is pointed at: more are a fog
  const wanted = new Map(); // what a reader has pressed holds on every track; all else is as a track begins
  let pointed = null;
  const options = { responsive: true, displayModeBar: false };

  function rgba(hue, share) {
    const number = parseInt(colour(hue).slice(1), 16);
    return `rgba(${number >> 16},${(number >> 8) & 255},${number & 255},${share})`;
  }

  function axis(title, more) {
    const line = { gridcolor: colour("rule"), linecolor: colour("rule"), zeroline: false, fixedrange: true };
    return { title: { text: title, standoff: 8 }, ticks: "outside", tickcolor: colour("rule"), ...line, ...more };
  }

  // axes around nothing would say that there is something
  function layout(xaxis, yaxis, drawn) {
    const why = site.agents.some(({ kept }) => kept) ? "no curve is chosen" : "no agent matches";
    const note = { text: why, xref: "paper", yref: "paper", x: 0.5, y: 0.5, showarrow: false, font: { size: 14 } };
    const visible = drawn.length > 0;
    return {
      xaxis: { ...xaxis, visible }, yaxis: { ...yaxis, visible }, annotations: visible ? [] : [note], showlegend: false, hovermode: "closest", margin: { l: 48, r: 12, t: 10, b: 44 },
      paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
      font: { color: colour("muted"), family: getComputedStyle(document.body).fontFamily, size: 12 },
      hoverlabel: { bgcolor: colour("raised"), bordercolor: colour("rule"), font: { color: colour("ink") } },
    };
  }

  const isShown = (agent) => wanted.get(agent) ?? site.shown[site.boards[antgym.route.board].track].includes(agent);
  const isDrawn = ({ agent }) => agent === pointed || (isShown(agent) && site.agents[agent].kept);
  const ranks = () => site.boards[antgym.route.board].order;
  const banded = (curves) => (pointed === null
    ? [...curves].filter(({ agent }) => ranks().includes(agent)).sort((a, b) => ranks().indexOf(a.agent) - ranks().indexOf(b.agent)).slice(0, bands)
    : curves.filter(({ agent }) => agent === pointed));
  const percent = (values) => values.map((value) => 100 * value);
  const escaped = (text) => text.replace(/&/g, "&amp;").replace(/</g, "&lt;"); // plotly reads some markup in names

  function line({ agent }, x, y, more, shape = "linear") {
    const { name, colour: hue, dash } = site.agents[agent];
    const opacity = pointed === null || agent === pointed ? 1 : 0.25;
    const width = agent === pointed ? 3.5 : 2;
    return { type: "scatter", name: escaped(name), x, y, opacity, line: { color: colour(hue), width, dash, shape }, ...more };
  }

  function band({ agent, lows, highs }, x) {
    const around = { x: [...x, ...x.toReversed()], y: percent([...lows, ...highs.toReversed()]) };
    const fill = { fill: "toself", fillcolor: rgba(site.agents[agent].colour, 0.14), line: { width: 0 } };
    return { type: "scatter", mode: "lines", hoverinfo: "skip", ...fill, ...around };
  }

  // a logarithm has no place for a budget of 0: it stands one step left of the smallest other one
  const placed = (budget, least) => (budget > 0 ? budget : least / 3);

  function budgetTraces(drawn, least, what) {
    const x = ({ budgets }) => budgets.map((budget) => placed(budget, least));
    const hovertemplate = `%{fullData.name}: %{y:.1f} %${what}<br>%{customdata} trials<extra></extra>`;
    const lines = drawn.map((curve) => {
      const { colour: hue, dash } = site.agents[curve.agent];
      const marker = { symbol: symbols[dash], size: 7, color: colour(hue) };
      return line(curve, x(curve), percent(curve.means), { mode: "lines+markers", marker, customdata: curve.budgets, hovertemplate });
    });
    return [...banded(drawn).map((curve) => band(curve, x(curve))), ...lines];
  }

  function drawOverBudgets(plot, what, yaxis) {
    const { track } = site.boards[antgym.route.board];
    const curves = site[plot][track];
    const budgets = [...new Set(curves.flatMap((curve) => curve.budgets))].sort((a, b) => a - b);
    const figure = document.getElementById(`${plot}-figure`);
    figure.hidden = budgets.length < 2;
    if (figure.hidden) return;
    const least = budgets.find((budget) => budget > 0);
    const ticks = { tickvals: budgets.map((budget) => placed(budget, least)), ticktext: budgets.map(String) };
    figure.querySelector(".track-note").textContent =
      `Track ${track}.${budgets[0] === 0 ? " No trial stands at the left edge of the logarithmic axis." : ""}`;
    const drawn = curves.filter(isDrawn);
    const shape = layout(axis("trials on a new map", { type: "log", ...ticks }), yaxis, drawn);
    Plotly.react(plot, budgetTraces(drawn, least, what), shape, options);
  }

  // as many as a logarithmic axis has room for, however little of it there is
  function roundNumbers(low, high) {
    const factors = high > 10 * low ? [1, 2, 5] : high > 3 * low ? [1, 1.5, 2, 3, 4, 5, 7] : [1, 1.2, 1.5, 2, 2.5, 3, 4, 5, 6, 7, 8, 9];
    const all = [-1, 0, 1, 2].flatMap((power) => factors.map((factor) => Number((factor * 10 ** power).toPrecision(2))));
    return all.filter((number) => low <= number && number <= high);
  }

  function drawProfile() {
    const { profile } = site.boards[antgym.route.board];
    document.getElementById("profile-figure").hidden = profile === null;
    if (profile === null) return;
    const x = percent(profile.gaps);
    const hovertemplate = "%{fullData.name}: %{y:.0f} % of runs<br>within a gap of %{x:.1f} %<extra></extra>";
    const drawn = profile.rows.filter(isDrawn);
    const lines = drawn.map((row) => line(row, x, percent(row.shares), { mode: "lines", hovertemplate }, "hv"));
    const around = pointed === null ? [] : banded(drawn).map((row) => band(row, x));
    const [low, high] = [x[0], x.at(-1)];
    const tickvals = roundNumbers(low, high);
    const ticks = { tickvals, ticktext: tickvals.map(String), type: "log", range: [Math.log10(low), Math.log10(high)] };
    const shape = layout(axis("gap, %", ticks), axis("runs within it, %", { range: [0, 102] }), drawn);
    Plotly.react("profile", [...around, ...lines], shape, options);
  }

  // a board's legend holds no name that has no curve on it
  function offer() {
    const { track, profile } = site.boards[antgym.route.board];
    const there = new Set([...site.anytime[track], ...(profile?.rows ?? [])].map(({ agent }) => agent));
    for (const item of legend.children) {
      const agent = Number(item.dataset.agent);
      item.hidden = !site.agents[agent].kept || !there.has(agent);
      item.firstChild.setAttribute("aria-pressed", String(isShown(agent)));
    }
  }

  let due = false;

  // at most once a frame, whatever happens within it
  function draw() {
    if (due) return;
    due = true;
    requestAnimationFrame(() => {
      due = false;
      offer();
      drawOverBudgets("anytime", "", axis("mean gap, %", { rangemode: "tozero" }));
      drawOverBudgets("reached", " of targets", axis("targets reached, %", { range: [0, 102] }));
      drawProfile();
      document.getElementById("curves").hidden = document.querySelectorAll("#curves figure:not([hidden])").length === 0;
      document.getElementById("curves-title").textContent = document.getElementById("anytime-figure").hidden ? "Tails" : "Budgets and tails";
    });
  }

  function press(agent) {
    wanted.set(agent, !isShown(agent));
    pointed = null;
    draw();
  }

  function point(i) {
    pointed = i;
    draw();
  }

  function listLegend() {
    for (const i of site.legend) {
      const agent = site.agents[i];
      const button = element("button", { type: "button" }, swatch(agent), agent.name);
      button.addEventListener("click", () => press(i));
      button.addEventListener("pointerenter", () => point(i));
      button.addEventListener("focus", () => { if (button.matches(":focus-visible")) point(i); }); // a touch focuses, too
      for (const event of ["pointerleave", "blur"]) button.addEventListener(event, () => point(null));
      legend.append(element("li", { "data-agent": i }, button));
    }
  }

  listLegend();
  for (const event of ["route", "filter", "theme"]) document.addEventListener(event, draw);
}
