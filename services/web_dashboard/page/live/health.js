// The services: whether each is there, what it does, how fast, and what it lost or refused.

import { card, element } from "../elements.js";
import { link } from "../link.js";
import { isThere } from "../waiting.js";

const HEADS = ["Service", "State", "Messages/s", "Latency p50 / p99", "Lost", "Refused", "Up"];
const ORDER = ["sensor_gateway", "pose_preprocessor", "som_classifier", "marker_tracker", "action_fusion", "model_trainer", "web_dashboard"];
const PREFIX = /^actum\/[^/]+\//;

export function health() {
  const body = element("tbody");
  const head = element("thead", {}, element("tr", {}, ...HEADS.map((text) => element("th", { scope: "col" }, text))));
  const table = element("table", {}, element("caption", { class: "unseen" }, "Services"), head, body);
  new Health(body);
  const scrolled = element("div", { class: "scrolled", tabindex: "0", role: "region", "aria-label": "Table of services" }, table);
  return card("health", "Services", { wide: true }, scrolled);
}

class Health {
  constructor(body) {
    this.body = body;
    this.statuses = new Map();
    this.infos = new Map();
    link.on("status", (status) => this.statuses.set(status.service, status));
    link.on("info", (info) => this.infos.set(info.service, info));
    setInterval(() => this.show(), 1000);
  }

  show() {
    const rank = (name) => (ORDER.indexOf(name) + ORDER.length + 1) % (ORDER.length + 1);
    const names = [...this.statuses.keys()].sort((one, other) => rank(one) - rank(other));
    this.body.replaceChildren(...names.map((name) => this.row(name, this.statuses.get(name))));
  }

  row(name, status) {
    const there = isThere(name);
    const well = there && status.state.startsWith("running");
    const { host, source, model } = this.infos.get(name) ?? {};
    const about = [source, model && `model ${model.slice(0, 8)}`, host].filter(Boolean).join(" · ");
    const state = there ? status.state : "silent: it does not run";
    const cells = [
      element("td", {}, element("span", { class: `dot ${well ? "well" : there ? "idle" : "trouble"}`, "aria-hidden": "true" }), state),
      element("td", { class: "number", title: each(status.rates) }, there ? total(status.rates).toFixed(0) : "–"),
      element("td", { class: "number" }, latency(status.latency_ms)),
      element("td", { class: "number", title: each(status.drops) }, String(total(status.drops))),
      element("td", { class: "number", title: each(status.rejects) }, String(total(status.rejects))),
      element("td", { class: "number" }, duration(status.uptime_s)),
    ];
    cells.forEach((cell, i) => cell.setAttribute("data-head", HEADS[i + 1]));
    const error = status.last_error && element("small", { class: "error" }, `latest: ${status.last_error.slice(0, 160)}`);
    return element("tr", {}, element("th", { scope: "row" }, name, element("small", {}, about), error), ...cells);
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
