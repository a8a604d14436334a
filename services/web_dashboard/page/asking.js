// Asking for something to be done, and saying what came of it where the person looks.

import { element } from "./elements.js";

const LONGEST = 500;      // characters of a refusal that are shown
let fields = 0;

// A line that says what came of the last thing asked for.
export function outcome() {
  return element("p", { class: "outcome", role: "status" });
}

// Awaits what `asked` returns, says `done` or why it was refused, and returns the reply; null where it was refused.
export async function attempt(line, asked, done = "") {
  say(line, "");
  try {
    const reply = await asked();
    if (done) say(line, done);
    return reply;
  } catch (error) {
    say(line, error.message, true);
    return null;
  }
}

export function say(line, text, refused = false) {
  line.textContent = text.length > LONGEST ? `${text.slice(0, LONGEST)} …` : text;
  line.classList.toggle("refused", refused);
}

export function button(text, pressed, { label = null, kind = "" } = {}) {
  const made = element("button", { type: "button", class: kind, on: { click: pressed } }, text);
  if (label) made.setAttribute("aria-label", label);
  return made;
}

// A control with its name above it.
export function field(name, control) {
  control.id ||= `field-${++fields}`;
  return element("div", { class: "field" }, element("label", { for: control.id }, name), control);
}

// A text field that suggests what was typed before; `suggest(texts)` sets what.
export function suggesting(id, properties = {}) {
  const list = element("datalist", { id: `${id}-list` });
  const input = element("input", { id, type: "text", autocomplete: "off", spellcheck: "false", ...properties });
  input.setAttribute("list", list.id);
  const suggest = (texts) => list.replaceChildren(...texts.map((text) => element("option", { value: text })));
  return { input, list, suggest };
}

// A date of the trainer, ISO 8601, as people here write it.
export function dated(iso) {
  const date = new Date(iso);
  return Number.isNaN(date.getTime()) ? iso : date.toLocaleString([], { dateStyle: "medium", timeStyle: "short" });
}

export function counted(number, one, several = `${one}s`) {
  return `${number} ${number === 1 ? one : several}`;
}
