// One example: its film, its way over the map, what may be wrong with it, and what can be done about that.

import { attempt, button } from "../asking.js";
import { colourOf } from "../colours.js";
import { typed } from "../dialogs.js";
import { drawn, element, seconds } from "../elements.js";
import { trainer } from "../trainer.js";
import { drawTrace, Film } from "./film.js";
import { postureMap } from "./postures.js";
import { trimmed } from "./trimming.js";

const ORIGINS = { cut: "cut by itself", manual: "marked by hand" };
const RETRY_MS = 1000;
const TRIES = 5;          // the classifier takes a new model within a second or two

export class Example {
  constructor(set, listed, line) {
    Object.assign(this, { set, listed, line, trace: null, map: null });
    const film = element("canvas", { class: "film", role: "img", "aria-label": `Film of ${this.name}` });
    this.trail = element("canvas", { class: "trail", role: "img", "aria-label": `Way of ${this.name} over the map of postures`, hidden: true });
    this.element = element("li", { class: "example", "aria-label": this.name, style: { "--action": colourOf(listed.label) } },
      element("div", { class: "pictures" }, film, this.trail), ...this.texts(), this.buttons());
    this.element.dataset.example = listed.id;
    this.film = new Film(film);
    this.drawTrail = drawn(this.trail, (context, width, height) => this.map && drawTrace(context, width, height, this.trace, this.map, colourOf(listed.label)));
  }

  // What the example is called among the others: their ids are long.
  get name() {
    const { label, person, start_ns: start } = this.listed;
    return `${label}${person ? ` by ${person}` : ""} at ${(start / 1e9 % 1000).toFixed(1)} s`;
  }

  get lengthS() {
    return (this.listed.end_ns - this.listed.start_ns) / 1e9;
  }

  texts() {
    const { person, origin, mirrored, doubts } = this.listed;
    const about = [person, seconds(this.lengthS), ORIGINS[origin] ?? origin, mirrored && "mirrored"].filter(Boolean).join(" · ");
    return [element("p", { class: "caption" }, about), ...doubts.map((text) => element("p", { class: "doubt" }, text))];
  }

  buttons() {
    const called = (verb) => ({ label: `${verb} ${this.name}`, kind: "small" });
    const given = { set: this.set, example: this.listed.id };
    return element("div", { class: "buttons" },
      button("Trim", () => this.trim(), called("Trim")),
      button("Relabel", () => this.relabel(), called("Relabel")),
      button("Mirror", () => attempt(this.line, () => trainer.ask("mirror", given), "left and right exchanged"), called("Mirror")),
      button("Delete", () => attempt(this.line, () => trainer.ask("delete", given), `${this.name} deleted`), called("Delete")));
  }

  async load() {
    if (!this.element.isConnected) return;
    try {
      const film = await trainer.ask("film", { set: this.set, example: this.listed.id });
      this.film.show(film);
      this.trace = film.trace;
      if (film.trace?.length) this.findMap(TRIES);
    } catch (error) {
      this.element.querySelector(".caption").textContent += ` · no film: ${error.message}`;
    }
  }

  async findMap(tries) {
    this.map = await postureMap(trainer.all?.active);
    this.trail.hidden = !this.map;
    if (this.map) this.drawTrail();
    else if (tries > 1) setTimeout(() => this.findMap(tries - 1), RETRY_MS);
  }

  async relabel() {
    const labels = Object.keys(trainer.set?.actions ?? {});
    const label = await typed(`Relabel ${this.name}`, "Action", this.listed.label, labels, "Relabel");
    if (label === null || label === this.listed.label) return;
    await attempt(this.line, () => trainer.ask("relabel", { set: this.set, example: this.listed.id, label: label.trim() }), `now ${label}`);
  }

  async trim() {
    const bounds = await trimmed(this.name, this.listed, this.film.film);
    if (!bounds) return;
    await attempt(this.line, () => trainer.ask("trim", { set: this.set, example: this.listed.id, ...bounds }), "trimmed");
  }
}
