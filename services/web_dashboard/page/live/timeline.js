// The last minutes: a lane for each person, with segments and events as buttons, and early answers below them.

import { colourOf, theme } from "../colours.js";
import { card, drawn, element, percent } from "../elements.js";
import { explain, newest } from "./explanation.js";
import { allSegments, onSegment } from "./answers.js";
import { nowNs, people } from "./people.js";

const SPANS_S = { 30: "30 s", 60: "1 min", 180: "3 min", 600: "10 min" };
const REFRESH_MS = 200;
const EARLY_PX = 12;       // height of the early answers' band

export function timeline() {
  const span = element("select", { "aria-label": "Length of the timeline" },
    ...Object.entries(SPANS_S).map(([value, text]) => element("option", { value }, text)));
  span.value = "60";
  const lanes = element("div", { class: "lanes" });
  const axis = element("div", { class: "axis", "aria-hidden": "true" });
  const none = element("p", { class: "caption" }, "No action yet. Each answer appears here as a button: press it to see the reasons.");
  new Timeline(span, lanes, axis, none);
  return card("timeline", "Timeline", { controls: [span], wide: true }, lanes, axis, none);
}

class Timeline {
  constructor(span, lanes, axis, none) {
    Object.assign(this, { span, lanes, axis, none, rows: new Map() });
    onSegment((segment) => segment.event && newest(segment));
    span.addEventListener("change", () => this.show());
    lanes.addEventListener("pointerenter", ({ pointerType }) => (this.pointed = pointerType === "mouse"));
    lanes.addEventListener("pointerleave", () => (this.pointed = false));
    setInterval(() => !document.hidden && !this.pointed && this.show(), REFRESH_MS);  // what is pointed at stands still
  }

  show() {
    const now = nowNs();
    const span = Number(this.span.value) * 1e9;
    const shown = allSegments().filter(({ start, end }) => start !== null && (end ?? now) > now - span && start <= now + 2e9);
    this.none.hidden = shown.length > 0;
    const agents = [...new Set([...people.present, ...shown.map(({ agent }) => agent ?? 0)])].sort((one, other) => one - other);
    for (const agent of this.rows.keys()) if (!agents.includes(agent)) this.drop(agent);
    for (const agent of agents) this.row(agent).show(shown.filter((segment) => (segment.agent ?? 0) === agent), now, span);
    this.axis.replaceChildren(...[1, 0.75, 0.5, 0.25, 0].map((share) => element("span", {}, share ? `−${ago(share * span)}` : "now")));
  }

  row(agent) {
    if (!this.rows.has(agent)) {
      this.rows.set(agent, new Lane(agent));
      this.lanes.append(this.rows.get(agent).element);
    }
    return this.rows.get(agent);
  }

  drop(agent) {
    this.rows.get(agent).element.remove();
    this.rows.delete(agent);
  }
}

class Lane {
  constructor(agent) {
    this.buttons = new Map();
    this.track = element("div", { class: "track" });
    this.canvas = element("canvas", { class: "early", "aria-hidden": "true" });
    this.redraw = drawn(this.canvas, (context, width) => this.drawEarly(context, width));
    const name = agent ? `Person ${agent}` : "Somebody";
    this.element = element("div", { class: "lane", role: "group", "aria-label": `${name}'s answers` }, element("span", { class: "who" }, name), this.track);
    this.track.append(this.canvas);
  }

  show(segments, now, span) {
    Object.assign(this, { segments, now, span });
    for (const [id, button] of this.buttons) {
      if (segments.some((segment) => segment.id === id)) continue;
      button.remove();
      this.buttons.delete(id);
    }
    for (const segment of segments) this.showSegment(segment);
    this.redraw();
  }

  showSegment(segment) {
    const { event, action, held, start, end, marked } = segment;
    if (!event && !action && end === null && !marked) return;
    const button = this.buttons.get(segment.id) ?? this.add(segment);
    const [left, right] = [start, end ?? this.now].map((stamp) => 100 * (1 - (this.now - stamp) / this.span));
    button.style.left = `${Math.max(left, 0)}%`;
    button.style.width = `${Math.min(right, 100) - Math.max(left, 0)}%`;
    const label = labelOf(segment);
    if (button.textContent !== label) button.textContent = label;
    const sentence = held?.sentence ?? event?.sentence ?? label;
    button.title = sentence;
    button.setAttribute("aria-label", `${sentence}, ${held ? "not told" : marked ? "marked" : "found"}`);
    button.style.setProperty("--action", colourOf(event?.valid === false ? null : (event?.action ?? action?.action)));
    button.classList.toggle("held", Boolean(held));
    button.classList.toggle("marked", Boolean(marked));
    button.classList.toggle("open", end === null);
    button.classList.toggle("invalid", event?.valid === false || Boolean(event?.unknown));
  }

  add(segment) {
    const button = element("button", { type: "button", class: "segment", on: { click: () => explain(segment.id) } });
    this.buttons.set(segment.id, button);
    this.track.append(button);
    return button;
  }

  // A band whose colour is the likeliest action and whose height is how sure that is.
  drawEarly(context, width) {
    context.fillStyle = theme("grid");
    context.fillRect(0, EARLY_PX - 1, width, 1);
    for (const { early } of this.segments ?? []) {
      early.forEach(({ stamp, label, confidence }, i) => {
        const [from, to] = [stamp, early[i + 1]?.stamp ?? stamp + 3.4e7].map((ns) => width * (1 - (this.now - ns) / this.span));
        if (to < 0 || !label) return;
        context.fillStyle = colourOf(label);
        context.fillRect(from, EARLY_PX * (1 - confidence), Math.max(to - from, 1), EARLY_PX * confidence);
      });
    }
  }
}

function labelOf({ event, action, held, end }) {
  if (held) return `${held.action}?`;
  if (event?.valid === false) return "?";
  if (event) return event.unknown ? "unknown" : event.action;
  if (action) return action.action ?? "?";
  return end === null ? "marking" : "…";
}

function ago(ns) {
  const seconds = ns / 1e9;
  return seconds < 90 ? `${Math.round(seconds)} s` : `${(seconds / 60).toFixed(1).replace(".0", "")} min`;
}
