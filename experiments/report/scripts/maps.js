"use strict";
{
  const { site, element, swatch, scene } = antgym;
  const section = document.getElementById("map");
  const choice = document.getElementById("map-choice");
  const missing = document.getElementById("map-missing");
  const seeds = section.querySelector(".seeds");
  const trials = section.querySelector(".trials");
  const records = {};
  let shown = "";

  const percent = (share) => (100 * share).toFixed(1);
  const heading = (text) => element("th", { scope: "col" }, text);
  const cells = (texts) => texts.map((text) => element("td", {}, text));
  const id = ({ board, map }) => `${board}/${map}`;

  antgym.deliver = (name, record) => { records[name] = record; };

  // a page that was opened from a disk may load scripts, but fetch nothing
  function load(name) {
    const script = element("script", { src: `${site.data}/${name.replace("/", "-")}.js` });
    script.addEventListener("load", follow);
    script.addEventListener("error", () => {
      missing.textContent = `${script.getAttribute("src")} is not beside this page: copy the folder as a whole.`;
      missing.hidden = false;
    });
    document.head.append(script);
  }

  function listMaps() {
    const { maps } = site.boards[antgym.route.board];
    choice.replaceChildren(...maps.map((name, i) => element("option", { value: i }, name)));
    choice.value = String(antgym.route.map);
  }

  function seedRow({ agent, gaps, runs }) {
    const { board, map, agent: chosen, seed } = antgym.route;
    const numbers = gaps.map((gap, i) => {
      if (!runs[i]) return element("td", {}, percent(gap));
      const link = element("a", { href: `#${board}/${map}/${agent}/${i}` }, percent(gap));
      if (agent === chosen && i === seed) link.setAttribute("aria-current", "true");
      return element("td", {}, link);
    });
    const mean = gaps.reduce((sum, gap) => sum + gap, 0) / gaps.length;
    const name = element("th", { scope: "row" }, swatch(site.agents[agent]), site.agents[agent].name);
    const row = element("tr", { "data-agent": agent }, name, element("td", {}, percent(mean)), ...numbers);
    row.hidden = site.agents[agent].kept === false;
    return row;
  }

  function listSeeds({ rows }) {
    const count = Math.max(...rows.map(({ gaps }) => gaps.length));
    const names = Array.from({ length: count }, (_, i) => heading(`seed ${i}`));
    seeds.tHead.replaceChildren(element("tr", {}, heading("agent"), heading("mean"), ...names));
    seeds.tBodies[0].replaceChildren(...rows.map(seedRow));
  }

  // the optimum follows from any run that arrived: gap = (length − optimum) / optimum
  function optimum({ rows }) {
    for (const run of rows.flatMap(({ runs }) => runs)) {
      const i = run ? run.lengths.findIndex((length) => length !== null) : -1;
      if (i >= 0) return run.lengths[i] / (1 + run.gaps[i]);
    }
    return null;
  }

  const names = ({ parameters }, count) => Array.from({ length: count }, (_, i) => parameters[i] ?? `parameter ${i + 1}`);
  const settings = (unit) => unit.map((value) => value.toFixed(3));

  function fill(table, headings, rows) {
    table.tHead.replaceChildren(element("tr", {}, ...headings.map(heading)));
    table.tBodies[0].replaceChildren(...rows);
    table.parentElement.hidden = rows.length === 0;
  }

  function trialRow(trial, i, best, recommended, shortest) {
    const [cost, length] = trial.slice(-2);
    const gap = length === null || shortest === null ? "–" : percent(Math.max(0, length / shortest - 1));
    const reached = length === null ? "no path" : length.toLocaleString("en");
    const row = element("tr", {}, ...cells([String(i), ...settings(trial.slice(0, -2)), cost.toFixed(3), reached, gap]));
    if (i === best) row.classList.add("best");
    row.append(element("td", { class: "mark" }, recommended ? "recommended" : ""));
    return row;
  }

  function listTrials(record, { unit, trials: paid }) {
    const costs = paid.map((trial) => trial.at(-2));
    const best = costs.indexOf(Math.min(...costs));
    const same = (trial) => unit.every((value, i) => value === trial[i]);
    const shortest = optimum(record);
    const rows = paid.map((trial, i) => trialRow(trial, i, best, same(trial), shortest));
    fill(trials, ["trial", ...names(record, unit.length), "cost", "length", "gap %", ""], rows);
  }

  // of a run that was steered: what it was given, one block after the other
  function listBlocks(record, { unit }) {
    const count = unit.length / record.blocks;
    const rows = Array.from({ length: record.blocks }, (_, i) =>
      element("tr", {}, ...cells([String(i + 1), ...settings(unit.slice(i * count, (i + 1) * count))])));
    fill(trials, ["block", ...names(record, count)], rows);
  }

  function note({ blocks }, { unit, gaps, failure, trials: paid }) {
    if (failure) return `It failed and counts as no path: ${failure}`;
    const reached = `gap in per cent: ${gaps.map((gap) => (gap >= 1 ? "100" : percent(gap))).join(", ")}.`;
    if (blocks > 1) return `The run that was steered, ${reached} Below, its settings block by block, each in 0 … 1 of its range.`;
    const spent = paid.length === 0 ? "It paid for no trial." : `Below, what it paid for: ${paid.length} trial${paid.length === 1 ? "" : "s"}; bold is the cheapest.`;
    return `Recommended setting, each number in 0 … 1 of its range: (${settings(unit).join(", ")}). Its fresh runs, ${reached} ${spent}`;
  }

  function showRun(record) {
    const { agent, seed } = antgym.route;
    const run = record.rows.find((row) => row.agent === agent)?.runs[seed];
    document.getElementById("run").hidden = !run;
    if (!run) return;
    document.getElementById("run-title").textContent = `${site.agents[agent].name} on ${record.name}, seed ${seed}`;
    document.getElementById("run-note").textContent = note(record, run);
    if (record.blocks > 1) listBlocks(record, run);
    else listTrials(record, run);
  }

  function showView({ picture }) {
    document.getElementById("view").hidden = !picture;
    if (!picture) return;
    document.getElementById("view-note").textContent = `The shortest path is ${picture.optimum} long. ${picture.notes}`.trim();
    scene.show(picture);
  }

  function show(record) {
    document.getElementById("map-title").textContent = record.name;
    listMaps();
    showView(record);
    listSeeds(record);
    showRun(record);
    const now = location.hash;
    if (now === shown) return;
    shown = now;
    const target = document.getElementById(antgym.route.agent === null ? "map-title" : "run-title");
    target.focus({ preventScroll: true });
    target.scrollIntoView({ block: "start" });
  }

  function follow() {
    section.hidden = antgym.route.map === null;
    if (section.hidden) return;
    const name = id(antgym.route);
    missing.hidden = true;
    if (records[name]) show(records[name]);
    else load(name);
  }

  choice.addEventListener("change", () => { location.hash = `#${antgym.route.board}/${choice.value}`; });
  document.addEventListener("route", follow);
}
