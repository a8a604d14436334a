// The examples of the chosen set, action by action, as films that can be mended.

import { attempt, button, counted, outcome, say } from "../asking.js";
import { colourOf } from "../colours.js";
import { confirmed } from "../dialogs.js";
import { card, element } from "../elements.js";
import { reportBug } from "../guarded.js";
import { trainer } from "../trainer.js";
import { Example } from "./example.js";
import { arePlaying, play } from "./film.js";

const NONE = "none";            // the label of what is like an action and is none
const AGAIN_MS = 1000;          // until a film that was refused is asked for again: twice as long after each refusal
const LONGEST_AGAIN_MS = 60_000;

export function examples() {
  return new Examples().card;
}

class Examples {
  constructor() {
    Object.assign(this, { shown: "", tiles: new Map(), films: Promise.resolve() });
    this.line = outcome();
    this.trouble = outcome();
    this.redo = button("Redo the last take", () => trainer.set && this.redoLast());
    this.list = element("div", { class: "groups" });
    const playing = element("input", { type: "checkbox", checked: arePlaying() });
    playing.addEventListener("change", () => play(playing.checked));
    const controls = [element("label", { class: "check" }, playing, "Play the films"), this.redo];
    this.card = card("examples", "3 · Examples", { wide: true, controls }, this.trouble, this.line, this.list);
    trainer.on(() => this.look());
    trainer.onChoice(() => say(this.line, ""));
  }

  // Lists the examples anew where the set, or what is in it, has changed.
  async look() {
    const set = trainer.set?.name;
    const wanted = `${set}/${trainer.all?.revision}/${trainer.all?.active}`;
    this.redo.disabled = !Object.keys(trainer.set?.actions ?? {}).length;
    if (wanted === this.shown || !trainer.all) return;
    this.shown = wanted;
    const asked = set ? trainer.ask("examples", { set }) : Promise.resolve({ examples: [] });
    const { examples: listed, message = "" } = await asked.catch(({ message }) => ({ message }));
    if (this.shown !== wanted) return;
    say(this.trouble, message, true);
    if (listed) this.show(set, listed);
    else this.shown = "";
  }

  show(set, listed) {
    const before = this.tiles;
    this.tiles = new Map(listed.map((each) => [keyOf(set, each), before.get(keyOf(set, each)) ?? this.tile(set, each)]));
    const labels = [...new Set(listed.map(({ label }) => label))].sort();
    const groups = labels.map((label) => this.group(set, label, listed.filter((each) => each.label === label)));
    const none = element("p", { class: "none" }, set ? "No examples yet: record an action, or drop a video." : "Create a set first.");
    const focused = document.activeElement?.closest?.(".example")?.dataset.example;
    this.list.replaceChildren(...(groups.length ? groups : [none]));
    this.refocus(focused);
  }

  // Keeps the keyboard where it was; after a deletion at the list.
  refocus(focused) {
    if (focused === undefined || document.activeElement !== document.body) return;
    const tile = [...this.tiles.values()].find((each) => each.element.dataset.example === focused);
    (tile?.element.querySelector("button") ?? this.redo).focus({ preventScroll: true });
  }

  tile(set, listed) {
    const tile = new Example(set, listed, this.line);
    this.load(tile, AGAIN_MS);
    return tile;
  }

  // Loads one film after the other: the trainer reads a take for each.
  load(tile, againMs) {
    const again = () => setTimeout(() => this.load(tile, Math.min(2 * againMs, LONGEST_AGAIN_MS)), againMs);
    this.films = this.films.then(() => tile.load()).then((isMissing) => isMissing && again()).catch(reportBug);
  }

  group(set, label, listed) {
    const isNone = label === NONE;
    const remove = isNone ? null : button("Delete all", () => this.deleteAction(set, label, listed.length), { label: `Delete all examples of ${label}` });
    const head = element("div", { class: "group-head", style: { "--action": colourOf(label) } },
      element("i", { class: "swatch" }), element("h3", {}, isNone ? "none of the actions" : label), element("span", { class: "caption" }, counted(listed.length, "example")), remove);
    const tiles = listed.map((each) => this.tiles.get(keyOf(set, each)));
    tiles.forEach((tile, i) => tile.call(i + 1));
    return element("section", { class: "group", "aria-label": `Examples of ${label}` }, head, element("ul", { class: "tiles" }, ...tiles.map((tile) => tile.element)));
  }

  async deleteAction(set, label, number) {
    if (!(await confirmed(`Delete ${counted(number, "example")} of ${label}?`, "Delete all"))) return;
    await attempt(this.line, () => trainer.ask("delete_action", { set, label }), `All examples of ${label} deleted.`);
  }

  redoLast() {
    return attempt(this.line, () => trainer.ask("redo_last", { set: trainer.set.name }), "Do the take again. The new take replaces the last one.");
  }
}

// Tells examples apart, and the same one before and after it was mended or another model was put into use.
function keyOf(set, { id, label, start_ns: start, end_ns: end, mirrored }) {
  return [set, id, label, start, end, mirrored, trainer.all.active].join("/");
}
