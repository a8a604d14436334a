// One parameter: a control of its type, its range, unit and default, and what the service said to the last change.

import { button, outcome, say } from "../asking.js";
import { element } from "../elements.js";

const SLIDES = new Set(["number", "integer"]);

export class Parameter {
  constructor(service, told, set) {
    Object.assign(this, { told, set, line: outcome(), edited: false });
    const id = `${service}-${told.name}`;
    const about = element("p", { class: "caption", id: `${id}-about` }, told.description, element("br"), element("span", { class: "range" }, rangeOf(told)));
    this.control = controlOf(told);
    this.control.id = id;
    this.control.setAttribute("aria-describedby", about.id);
    this.control.addEventListener("input", () => (this.edited = true));
    this.control.addEventListener("change", () => this.change());
    this.control.addEventListener("blur", () => this.leave());
    const unit = told.unit ? element("span", { class: "unit" }, told.unit) : null;
    this.reset = button("Default", () => this.put(this.told.default), { label: `Default of ${told.name} of ${service}`, kind: "small" });
    const label = element("label", { for: id }, titleOf(told));
    this.element = element("div", { class: "parameter" }, label, element("div", { class: "row" }, this.control, unit, this.slider(service), this.reset), about, this.line);
  }

  slider(service) {
    const { name, type, minimum, maximum } = this.told;
    if (!SLIDES.has(type) || minimum === null || maximum === null) return null;
    const step = type === "integer" ? "1" : "any";
    this.slide = element("input", { type: "range", min: String(minimum), max: String(maximum), step, "aria-label": `${name} of ${service}, by a slider` });
    this.slide.addEventListener("input", () => {
      this.edited = true;
      this.control.value = String(Number(Number(this.slide.value).toPrecision(3)));
    });
    this.slide.addEventListener("change", () => this.change());
    this.slide.addEventListener("blur", () => this.leave());
    return this.slide;
  }

  // Shows a value that was read, but not in place of one that is being typed.
  show(told) {
    this.told = told;
    this.reset.disabled = asText(told.value) === asText(told.default);
    if (this.edited) return;
    if (this.control.type === "checkbox") this.control.checked = told.value;
    else this.control.value = asText(told.value);
    if (this.slide) this.slide.value = String(told.value);
    this.control.removeAttribute("aria-invalid");
  }

  // An edit that was undone makes no change: what was read meanwhile is shown.
  leave() {
    if (!this.edited) return;
    this.edited = false;
    this.show(this.told);
  }

  change() {
    this.edited = false;
    let value;
    try {
      value = this.control.type === "checkbox" ? this.control.checked : asValue(this.control.value, this.told);
    } catch {
      return this.refuse(`${this.control.value} is not a valid ${this.told.type}.`);
    }
    return this.put(value);
  }

  async put(value) {
    try {
      await this.set(value);
      say(this.line, "Set.");
    } catch (error) {
      const still = asText(this.told.value) || "unset";
      this.refuse(error.refused ? `Refused: ${error.message}. The value is still ${still}.` : `The value may not be set: ${error.message}. Press 'Read again' to see the value.`);
    }
  }

  refuse(text) {
    this.control.setAttribute("aria-invalid", "true");
    say(this.line, text, true);
  }
}

function controlOf({ type, choices }) {
  if (type === "boolean") return element("input", { type: "checkbox" });
  if (choices) return element("select", {}, ...choices.map((choice) => element("option", { value: asText(choice) }, asText(choice))));
  return element("input", { type: "text", inputmode: SLIDES.has(type) ? "decimal" : "text", autocomplete: "off", spellcheck: "false" });
}

// Its name in words, without the unit, which stands behind the control.
function titleOf({ name, unit }) {
  const words = name.split("_");
  return (unit && !name.includes("_per_") ? words.slice(0, -1) : words).join(" ");
}

// How far a value may go, and what it is where nothing is set, in words.
function rangeOf({ type, choices, minimum, above, maximum, below, default: usual, optional }) {
  const bounds = [
    minimum !== null && `from ${minimum}`, above !== null && `more than ${above}`,
    maximum !== null && `to ${maximum}`, below !== null && `less than ${below}`,
    optional && "or empty",
  ].filter(Boolean).join(" ");
  return [bounds, `default: ${asText(usual) || "empty"}`].filter(Boolean).join(" · ");
}

// A list is written with commas, a map with equals signs too; nothing as an empty text.
function asText(value) {
  if (Array.isArray(value)) return value.join(", ");
  if (typeof value === "boolean") return value ? "on" : "off";
  return value === null || value === undefined ? "" : typeof value === "object" ? asText(Object.entries(value).map((pair) => pair.join("="))) : String(value);
}

function asValue(text, { type, choices, optional }) {
  const trimmed = text.trim();
  if (choices) return choices.find((choice) => asText(choice) === text);
  if (!trimmed && optional) return null;
  const parts = trimmed ? trimmed.split(",").map((part) => part.trim()) : [];
  if (type === "array") return parts;
  if (type === "object") return Object.fromEntries(parts.map((part) => part.split("=")));
  return type === "string" ? text : JSON.parse(trimmed);
}
