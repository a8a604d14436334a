// One example: its film, its path over the map of postures, what may be wrong with it, and how to mend it.

import { attempt, button } from "../asking.js";
import { colourOf } from "../colours.js";
import { typed } from "../dialogs.js";
import { drawn, element, seconds } from "../elements.js";
import { trainer } from "../trainer.js";
import { drawTrace, Film } from "./film.js";
import { postureMap } from "./postures.js";
import { trimmed } from "./trimming.js";

const ORIGINS = { cut: "cut automatically", manual: "marked by hand" };
const RETRY_MS = 1000;
const TRIES = 5;          // the classifier takes a new model within a second or two

export class Example {
  constructor(set, listed, line) {
    Object.assign(this, { set, listed, line, trace: null, map: null, refusal: null, number: 0 });
    const film = element("canvas", { class: "film", role: "img" });
    this.trail = element("canvas", { class: "trail", role: "img", hidden: true });
    this.about = element("p", { class: "caption" });
    this.buttons = this.mending();
    this.element = element("li", { class: "example", style: { "--action": colourOf(listed.label) } },
      element("div", { class: "pictures" }, film, this.trail), this.about,
      ...listed.doubts.map((text) => element("p", { class: "doubt" }, text)), element("div", { class: "buttons" }, ...this.buttons));
    this.element.dataset.example = listed.id;
    this.film = new Film(film);
    this.drawTrail = drawn(this.trail, (context, width, height) => this.map && drawTrace(context, width, height, this.trace, this.map, colourOf(listed.label)));
  }

  // Names it by its number among the examples of its action: ids are long.
  call(number) {
    this.number = number;
    this.name = `${this.listed.label} ${number}`;
    this.describe();
    this.element.setAttribute("aria-label", this.name);
    this.film.canvas.setAttribute("aria-label", `Film of ${this.name}`);
    this.trail.setAttribute("aria-label", `Path of ${this.name} over the map of postures`);
    for (const each of this.buttons) each.setAttribute("aria-label", `${each.textContent} ${this.name}`);
  }

  describe() {
    const { person, origin, mirrored, start_ns: start, end_ns: end } = this.listed;
    const about = [this.number, person, seconds((end - start) / 1e9), ORIGINS[origin] ?? origin, mirrored && "mirrored", this.refusal];
    this.about.textContent = about.filter(Boolean).join(" · ");
  }

  mending() {
    const given = { set: this.set, example: this.listed.id };
    return [
      button("Trim", () => this.trim()),
      button("Relabel", () => this.relabel()),
      button("Mirror", () => attempt(this.line, () => trainer.ask("mirror", given), `Left and right of ${this.name} exchanged.`)),
      button("Delete", () => attempt(this.line, () => trainer.ask("delete", given), `${this.name} deleted.`)),
    ];
  }

  // Shows its film; resolves to whether it is to be asked for again, as the trainer may have been busy.
  async load() {
    if (!this.element.isConnected) return false;
    let film = null;
    try {
      film = await trainer.ask("film", { set: this.set, example: this.listed.id });
      this.refusal = null;
    } catch (error) {
      this.refusal = `no film: ${error.message}`;
    }
    this.describe();
    if (film) this.show(film);
    return !film;
  }

  show(film) {
    this.film.show(film);
    this.trace = film.trace;
    if (film.trace?.length) this.findMap(TRIES);
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
    await attempt(this.line, () => trainer.ask("relabel", { set: this.set, example: this.listed.id, label: label.trim() }), `${this.name} is now labelled ${label}.`);
  }

  async trim() {
    const bounds = await trimmed(this.name, this.listed, this.film.film);
    if (!bounds) return;
    await attempt(this.line, () => trainer.ask("trim", { set: this.set, example: this.listed.id, ...bounds }), `${this.name} trimmed.`);
  }
}
