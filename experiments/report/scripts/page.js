"use strict";
// The page's address says what is shown: #A-20 a board, #A-20/3 its fourth map, #A-20/3/7/0 a run of agent 7 there.
const antgym = (() => {
  const site = JSON.parse(document.getElementById("site").textContent);
  const style = getComputedStyle(document.documentElement);
  const filter = document.getElementById("filter");
  let route = { board: site.first, map: null, agent: null, seed: null };

  const colour = (name) => style.getPropertyValue(`--${name}`).trim();
  const tell = (what) => document.dispatchEvent(new CustomEvent(what));

  function parsed(hash) {
    const [board, ...numbers] = decodeURIComponent(hash.slice(1)).split("/");
    if (!Object.hasOwn(site.boards, board)) return null;
    const [map = null, agent = null, seed = null] = numbers.map(Number);
    return { board, map: map in site.boards[board].maps ? map : null, agent, seed };
  }

  function showBoard() {
    for (const panel of document.querySelectorAll(".panel")) panel.hidden = panel.dataset.board !== route.board;
    for (const link of document.querySelectorAll("[data-choice]")) {
      if (link.dataset.choice === route.board) link.setAttribute("aria-current", "true");
      else link.removeAttribute("aria-current");
    }
  }

  function follow() {
    route = parsed(location.hash) ?? route;
    showBoard();
    tell("route");
  }

  function passes(words) {
    const named = ({ name }) => words.length === 0 || words.some((word) => name.toLowerCase().includes(word));
    return site.agents.map(named);
  }

  function applyFilter() {
    const words = filter.value.toLowerCase().split(/[\s,]+/).filter(Boolean);
    const kept = passes(words);
    site.agents.forEach((agent, i) => { agent.kept = kept[i]; });
    for (const node of document.querySelectorAll("[data-agent]")) node.hidden = !kept[Number(node.dataset.agent)];
    const count = kept.filter(Boolean).length;
    document.getElementById("filtered").textContent = words.length === 0 ? "" : count ? `${count} of ${kept.length}` : "no agent matches";
    tell("filter");
  }

  function element(tag, attributes = {}, ...children) {
    const node = document.createElement(tag);
    for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
    node.append(...children); // strings become text, never markup
    return node;
  }

  const swatch = ({ colour: hue, dash }) => element("span", { class: `swatch ${hue} ${dash}`, "aria-hidden": "true" });

  function start() {
    addEventListener("hashchange", follow);
    filter.addEventListener("input", applyFilter);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => tell("theme"));
    follow();
    applyFilter();
  }

  addEventListener("DOMContentLoaded", start); // after the other scripts, which listen
  return { site, colour, element, swatch, deliver: null, get route() { return route; } };
})();
