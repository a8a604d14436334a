// Recording a take: what is done, by whom, how often; then the page counts along until it has ended.

import { attempt, button, field, outcome, say, suggesting } from "../asking.js";
import { card, element } from "../elements.js";
import { markSwitch } from "../live/switch.js";
import { trainer } from "../trainer.js";
import { TakeView } from "./takeview.js";
import { simulatedPerson } from "./simulated.js";

const USUAL = 5;          // repetitions: fewer say little of how they differ
const MOST = 40;
const GONE = "This take was not kept: it was discarded on another page, or the trainer was started anew.";

export function recording() {
  const made = new Recording();
  return { card: made.card, form: made.form };
}

// What is done, by whom and how often, as the form says it.
class Form {
  constructor() {
    this.label = suggesting("label", { placeholder: "wave" });
    this.person = suggesting("person", { placeholder: "anna" });
    this.count = element("input", { type: "number", min: "1", max: String(MOST), value: String(USUAL) });
    this.element = element("div", { class: "fields" },
      field("Action", this.label.input), field("Person", this.person.input), field("How many times", this.count),
      this.label.list, this.person.list);
    trainer.on(() => this.suggest());
  }

  get fields() {
    return { set: trainer.set?.name ?? "", label: this.label.input.value.trim(), person: this.person.input.value.trim(), count: Number(this.count.value) };
  }

  suggest() {
    if (this.revision === trainer.all?.revision) return;
    this.revision = trainer.all?.revision;
    const sets = trainer.all?.sets ?? [];
    this.label.suggest([...new Set(sets.flatMap(({ actions }) => Object.keys(actions)))].sort());
    this.person.suggest([...new Set(sets.flatMap(({ people }) => people))].sort());
  }
}

class Recording {
  constructor() {
    this.form = new Form();
    this.line = outcome();
    this.doubts = element("ul", { class: "doubts" });
    this.view = new TakeView();
    this.mark = markSwitch("take-switch", "Mark by hand");
    const record = element("button", { class: "primary" }, "Record");
    const background = button("Record background", () => this.begin("background"));
    const begin = element("form", { on: { submit: (event) => this.submitted(event) } },
      this.form.element, element("div", { class: "buttons" }, record, background));
    this.begins = element("div", { class: "begins" }, begin,
      element("p", { class: "caption" }, "Do the action, stand still for a second or two, do it again. Background is everything else that people do: none of the actions."));
    this.stops = element("div", { class: "buttons" }, button("Stop", () => this.stop(), { kind: "primary" }), button("Discard", () => this.discard()), simulatedPerson());
    this.going = element("div", { class: "begins", hidden: true }, this.stops, this.mark);
    const left = element("div", { class: "left" }, this.begins, this.going, this.line, this.doubts);
    this.card = card("record", "2 · Record", {}, element("div", { class: "record" }, left, this.view.element));
    trainer.on(() => this.show(trainer.now?.recording));
    trainer.onChoice(() => this.forget());
  }

  submitted(event) {
    event.preventDefault();
    this.begin("action");
  }

  async begin(kind) {
    const fields = this.form.fields;
    if (!fields.set) return say(this.line, "Create a set first, in the card before this one.", true);
    const { label, count, ...others } = fields;
    const wanted = kind === "background" ? others : { ...others, label, count };
    await attempt(this.line, () => trainer.ask("record", { ...wanted, kind }), "");
  }

  stop() {
    return attempt(this.line, () => trainer.ask("stop"));
  }

  discard() {
    return attempt(this.line, () => trainer.ask("discard"), "Discarded: nothing was kept.");
  }

  show(take) {
    const isGoing = Boolean(take) && take.phase !== "done";
    const isFocused = this.card.contains(document.activeElement);
    const [began, ended] = [isGoing && this.going.hidden, !isGoing && !this.going.hidden];
    this.begins.hidden = isGoing;
    this.going.hidden = !isGoing;
    this.mark.hidden = take?.kind !== "action";
    if (began) this.began(isFocused);
    if (ended && take) this.ended(take, isFocused);
    else if (ended && !this.line.textContent) say(this.line, GONE, true);
    this.view.show(take);
  }

  forget() {
    this.doubts.replaceChildren();
    say(this.line, "");
  }

  began(isFocused) {
    this.forget();
    if (isFocused) (this.mark.hidden ? this.stops : this.mark).querySelector("button").focus({ preventScroll: true });
  }

  ended({ kind, label, asked, counted, doubts }, isFocused) {
    const isShort = kind === "action" && counted < asked;
    const what = kind === "background" ? "background recorded" : `${isShort ? `only ${counted} of ${asked}` : counted} of ${label} recorded`;
    if (!this.line.classList.contains("refused")) say(this.line, isShort && !counted ? `This take of ${label} does not count.` : what, isShort);
    this.doubts.replaceChildren(...doubts.map((text) => element("li", { class: "doubt" }, text)));
    if (isFocused) this.form.label.input.select();
  }
}
