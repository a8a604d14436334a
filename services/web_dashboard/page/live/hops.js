// Where the time goes: how long after its cause each message reaches the page's service, over the last minute.

import { element } from "../elements.js";
import { link } from "../link.js";

const HEADS = ["From → to", "p50", "p99", "Measured"];

export function hops() {
  const body = element("tbody");
  const head = element("thead", {}, element("tr", {}, ...HEADS.map((text) => element("th", { scope: "col" }, text))));
  const table = element("table", {}, element("caption", {}, "Where the time goes, last minute"), head, body);
  const note = element("p", { class: "caption" }, "Each time is between the arrivals of two messages at web_dashboard, by its own clock.");
  const box = element("div", { class: "hops", hidden: true }, element("div", { class: "scrolled", tabindex: "0", role: "region", "aria-label": "Where the time goes" }, table), note);
  link.on("status", ({ service, hops: measured = [] }) => {
    if (service !== "web_dashboard") return;
    box.hidden = !measured.length;
    body.replaceChildren(...measured.map(row));
  });
  return box;
}

function row({ cause, effect, count, p50_ms: p50, p99_ms: p99 }) {
  const cells = [milliseconds(p50), milliseconds(p99), `${count} ×`];
  return element("tr", {}, element("th", { scope: "row" }, `${cause} → ${effect}`),
    ...cells.map((text, i) => element("td", { class: "number", "data-head": HEADS[i + 1] }, text)));
}

function milliseconds(value) {
  return `${value < 100 ? value.toFixed(1) : Math.round(value)} ms`;
}
