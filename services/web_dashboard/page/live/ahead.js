// What the shown person is about to touch: one line below the large words, grey until it is all but certain.

import { element } from "../elements.js";
import { link } from "../link.js";
import { isShown } from "./people.js";

export const LEAST = 0.3;   // hands always move a little towards something
const CERTAIN = 0.9;
const MOST_PEOPLE = 64;   // people come with ever new numbers
const SILENT_MS = 500;   // intents come with each posture: the person was lost from view, and no empty one comes

export function ahead() {
  const line = element("p", { class: "ahead idle" });
  new Ahead(line);
  return line;
}

class Ahead {
  constructor(line) {
    this.line = line;
    this.newest = new Map();
    this.done = new Map();
    link.on("intent", (intent) => {
      this.newest.set(intent.agent, { intent, at: performance.now() });
      this.show();
    });
    link.on("event", (event) => {
      if (this.done.size > MOST_PEOPLE) this.done.clear();
      this.done.set(event.agent, nameOf(event));
      this.newest.delete(event.agent);
      this.show();
    });
    setInterval(() => this.show(), 300);
  }

  show() {
    for (const [agent, { at }] of this.newest) if (performance.now() - at > SILENT_MS) this.newest.delete(agent);
    const { intent } = [...this.newest.values()].find(({ intent: { agent } }) => isShown(agent)) ?? {};
    const told = intent && nameOf(intent) !== this.done.get(intent.agent);
    const likeliest = told ? intent.intended.find(({ soon_probability: soon }) => soon >= LEAST) : undefined;
    this.line.classList.toggle("idle", !likeliest);
    this.line.classList.toggle("certain", (likeliest?.soon_probability ?? 0) >= CERTAIN);
    if (likeliest) this.line.textContent = `→ ${likeliest.object_name}, ${when(likeliest.contact_s)}`;
  }
}

// Tells segments apart: a source that is started anew may use its names again.
function nameOf({ session_id: session, segment_id: id }) {
  return id === null ? null : `${session}/${id}`;
}

function when(seconds) {
  return seconds < 0.05 ? "now" : `in ${seconds.toFixed(1)} s`;
}
