// The services: whether each is there, what it does, how fast, and what it lost or refused; and where the time goes.

import { card, element } from "../elements.js";
import { link } from "../link.js";
import { isThere } from "../waiting.js";
import { hops } from "./hops.js";

const HEADS = ["Service", "State", "Messages/s", "Latency p50 / p99", "Lost", "Refused", "Up"];
const ORDER = ["sensor_gateway", "pose_preprocessor", "som_classifier", "marker_tracker", "action_fusion", "model_trainer", "web_dashboard"];
const PREFIX = /^actum\/[^/]+\//;
const LONGEST = 200;     // characters of an error that are shown

const rows = new Map();
const infos = new Map();

export function health() {
  const body = element("tbody");
  const head = element("thead", {}, element("tr", {}, ...HEADS.map((text) => element("th", { scope: "col" }, text))));
  const table = element("table", {}, element("caption", { class: "unseen" }, "Services"), head, body);
  link.on("info", (info) => infos.set(info.service, info));
  link.on("status", (status) => {
    if (!rows.has(status.service)) add(body, status.service);
    rows.get(status.service).status = status;
  });
  setInterval(() => rows.forEach((row) => row.show()), 1000);
  const scrolled = element("div", { class: "scrolled", tabindex: "0", role: "region", "aria-label": "Table of services" }, table);
  return card("health", "Services", { wide: true }, scrolled, hops());
}

function add(body, name) {
  rows.set(name, new Row(name));
  const rank = (service) => (ORDER.includes(service) ? ORDER.indexOf(service) : ORDER.length);
  const sorted = [...rows.keys()].sort((one, other) => rank(one) - rank(other));
  body.replaceChildren(...sorted.map((service) => rows.get(service).element));
}

class Row {
  constructor(name) {
    this.name = name;
    this.about = element("small");
    this.details = element("dl");
    this.dot = element("span", { "aria-hidden": "true" });
    this.state = element("span");
    this.numbers = HEADS.slice(2).map((head) => element("td", { class: "number", "data-head": head }));
    const open = element("details", {}, element("summary", {}, name), this.about, this.details);
    const state = element("td", { "data-head": "State" }, this.dot, this.state);
    this.element = element("tr", {}, element("th", { scope: "row" }, open), state, ...this.numbers);
  }

  show() {
    const { status } = this;
    const there = isThere(this.name);
    const { host, source, model, version } = infos.get(this.name) ?? {};
    this.about.textContent = [source, model && `model ${model.slice(0, 8)}`, host, version && `actum ${version}`].filter(Boolean).join(" · ");
    this.dot.className = `dot ${!there ? "trouble" : status.state.startsWith("running") ? "well" : "idle"}`;
    this.state.textContent = there ? status.state : "not running";
    const { rates, drops, rejects, uptime_s: uptime } = status;
    const numbers = [there ? total(rates).toFixed(0) : "–", latency(status.latency_ms), total(drops), total(rejects), duration(uptime)];
    this.numbers.forEach((cell, i) => (cell.textContent = numbers[i]));
    this.tell({
      "Messages/s": each(rates), Lost: each(drops), Refused: each(rejects), Counted: each(status.counts),
      "Latest problem": status.last_error?.slice(0, LONGEST),
    });
  }

  tell(details) {
    const known = Object.entries(details).filter(([, text]) => text);
    this.details.replaceChildren(...known.flatMap(([term, text]) => [element("dt", {}, term), element("dd", {}, text)]));
  }
}

function total(counts) {
  return Object.values(counts).reduce((sum, value) => sum + value, 0);
}

function each(counts) {
  return Object.entries(counts).map(([name, value]) => `${name.replace(PREFIX, "")} ${Math.round(value)}`).join(", ");
}

function latency({ p50, p99 }) {
  return p50 === undefined ? "–" : `${p50.toFixed(1)} / ${(p99 ?? NaN).toFixed(1)} ms`;
}

function duration(seconds) {
  if (seconds < 90) return `${Math.round(seconds)} s`;
  return seconds < 5400 ? `${Math.round(seconds / 60)} min` : `${(seconds / 3600).toFixed(1)} h`;
}
