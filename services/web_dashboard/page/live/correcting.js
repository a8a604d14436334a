// Saying what was really done in an answer, told or held back, and making a model anew that knows it.

import { attempt, button, counted, field, outcome, say, suggesting } from "../asking.js";
import { element } from "../elements.js";
import { JobView } from "../jobs.js";
import { trainer } from "../trainer.js";

export class Correcting {
  // `held()` is called as somebody turns to the buttons: from then on they have to be those of the same answer.
  constructor(held) {
    // corrected: what became of each segment; job: the id of the training that was started here.
    Object.assign(this, { segment: null, corrected: new Map(), asking: false, job: null, filled: null });
    this.line = outcome();
    this.person = suggesting("corrected-person");
    this.other = element("select");
    this.was = button("", () => this.correct(this.answer.action));
    this.another = element("div", { class: "buttons" }, field("Another action", this.other), button("It was this", () => this.correct(this.other.value)));
    this.choices = element("div", {}, field("Person", this.person.input), this.person.list,
      element("div", { class: "buttons" }, this.was, button("None of the actions", () => this.correct(""))), this.another);
    this.update = button("Update the model", () => this.train(), { kind: "primary" });
    this.training = new JobView(["train"], (job) => this.ended(job));
    this.element = element("div", { class: "correcting", hidden: true, on: { pointerenter: held, focusin: held } },
      element("h3", {}, "What was it really?"), this.choices, this.line, this.update, this.training.element);
    trainer.on(() => this.look());
  }

  // The set that the model in use was trained on, while the trainer has it; else there is nothing to correct in.
  get set() {
    return trainer.all?.sets.find(({ name }) => name === trainer.now?.model_set) ?? null;
  }

  get answer() {
    return this.segment && (this.segment.held ?? this.segment.event ?? this.segment.action);
  }

  show(segment) {
    this.segment = segment;
    say(this.line, this.corrected.get(segment.id) ?? "");
    this.look();
  }

  look() {
    const { answer, set } = this;
    this.element.hidden = !set || !answer?.agent || !answer.end_ns || answer.why === "unanswerable";
    if (this.element.hidden) return;
    const labels = Object.keys(set.actions);
    this.choices.hidden = this.corrected.has(this.segment.id);
    for (const each of this.choices.querySelectorAll("button")) each.disabled = this.asking;
    this.was.hidden = !labels.includes(answer.action);
    this.was.textContent = `It was ${answer.action}`;
    this.another.hidden = !labels.length;
    if (labels.join("/") !== this.other.dataset.labels) {
      this.other.dataset.labels = labels.join("/");
      this.other.replaceChildren(...labels.map((label) => element("option", { value: label }, label)));
    }
    this.fillIn(set);
    this.training.element.hidden = !this.job || this.job !== trainer.now?.job?.id;
    this.update.hidden = !set.corrections || trainer.now?.job?.state === "running";
    this.update.textContent = `Update the model (${counted(set.corrections, "correction")})`;
  }

  // Suggests who it may be; fills the only person in once for each set, so that it can be cleared.
  fillIn({ name, people }) {
    this.person.suggest(people);
    if (this.filled === name) return;
    this.filled = name;
    this.person.input.value = people.length === 1 ? people[0] : "";
  }

  async correct(label) {
    const { segment, set } = this;
    const given = { set: set.name, agent: segment.agent, start_ns: segment.start, end_ns: segment.end, label, person: this.person.input.value };
    this.asking = true;
    this.look();
    const reply = await attempt(this.line, () => trainer.ask("correct", given));
    this.asking = false;
    if (reply) {
      this.corrected.set(segment.id, `Kept in the set ${set.name} as ${label ? `an example of ${label}` : "none of the actions"}.`);
      if (this.segment === segment) say(this.line, this.corrected.get(segment.id));
    }
    this.look();
  }

  async train() {
    const job = await this.training.start("train", { set: this.set.name, update: trainer.now.model });
    if (job) this.job = job.id;
    this.look();
  }

  // Puts the model into use that was trained here; other panels train models, too.
  async ended({ id, result }) {
    if (id !== this.job || !result) return;
    await attempt(this.line, () => trainer.ask("activate", { model: result.model }), "The new model is in use within two seconds.");
    this.look();
  }
}
