// What is being done, what was done last, and what comes next: large enough to read across a room.

import { colourOf } from "../colours.js";
import { element, percent } from "../elements.js";
import { link } from "../link.js";
import { ahead } from "./ahead.js";
import { nowNs } from "./people.js";

const GOING_ON_MS = 600;   // early answers come with each frame
const RECENT_S = 8;

export function now() {
  const parts = {
    kicker: element("p", { class: "kicker" }),
    action: element("p", { class: "action" }),
    object: element("p", { class: "object" }),
    ahead: ahead(),
    done: element("div", { class: "done", role: "progressbar", "aria-label": "Share of the action that is done", "aria-valuemin": "0", "aria-valuemax": "100" }, element("span")),
    spoken: element("p", { class: "spoken", "aria-live": "polite" }),
  };
  new Now(parts);
  return element("section", { id: "now", class: "card", "aria-label": "The action" }, ...Object.values(parts));
}

class Now {
  constructor(parts) {
    this.parts = parts;
    this.event = null;
    this.early = null;
    this.over = new Set();
    link.on("event", (event) => {
      this.event = event;
      this.over.add(nameOf(event));
      this.parts.spoken.textContent = `Person ${event.agent}: ${event.sentence}`;
      this.show();
    });
    link.on("action", (action) => {
      if (action.final) this.over.add(nameOf(action));
      else if (!this.over.has(nameOf(action))) this.early = { ...action, at: performance.now() };
      this.show();
    });
    setInterval(() => this.show(), 300);
  }

  show() {
    const early = this.early && performance.now() - this.early.at < GOING_ON_MS && !this.over.has(nameOf(this.early));
    if (early && this.early.action) this.showEarly(this.early);
    else if (this.event) this.showEvent(this.event);
    else this.tell("Recognised", "–", "No action yet", null, null);
  }

  showEarly({ action, confidence, completeness }) {
    const share = completeness === null ? "" : `, ${percent(completeness)} of the action done`;
    this.tell("So far it looks like", action, `${percent(confidence)} sure${share}`, action, completeness);
  }

  showEvent(event) {
    const ago = Math.max(0, (nowNs() - event.end_ns) / 1e9);
    const when = ago < RECENT_S ? "Just now" : ago < 90 ? `${Math.round(ago)} s ago` : `${Math.round(ago / 60)} min ago`;
    const who = event.agent ? `, person ${event.agent}` : "";
    if (!event.valid) return this.tell(`${when}${who}`, "no answer", event.reason, null, null);
    const what = event.unknown ? "unknown" : event.action;
    this.tell(`${when}${who}, ${percent(event.confidence)} sure`, what, objectOf(event), event.action, null);
  }

  tell(kicker, action, object, coloured, completeness) {
    const { parts } = this;
    parts.kicker.textContent = kicker;
    parts.action.textContent = action;
    parts.object.textContent = object;
    parts.action.style.setProperty("--action", coloured ? colourOf(coloured) : "transparent");
    parts.done.classList.toggle("idle", completeness === null);
    parts.done.setAttribute("aria-valuenow", String(Math.round(100 * (completeness ?? 0))));
    parts.done.firstChild.style.width = `${100 * Math.min(completeness ?? 0, 1)}%`;
  }
}

// Tells segments apart: a source that is started anew may use its names again.
function nameOf({ session_id: session, segment_id: id }) {
  return `${session}/${id}`;
}

// What was acted on and what became of it, in words: `box 2 · 0.18 m up`.
function objectOf({ object, result, why }) {
  return [object ? `${object.name} ${object.id}` : (why ?? "no object"), result].filter(Boolean).join(" · ");
}
