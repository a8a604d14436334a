// Saying what was really done in an answer, told or held back, and making a model anew that knows it.

import { attempt, button, counted, field, outcome, say } from "../asking.js";
import { element } from "../elements.js";
import { JobView } from "../jobs.js";
import { trainer } from "../trainer.js";

export class Correcting {
  constructor() {
    Object.assign(this, { segment: null, corrected: new Map(), since: 0, job: null });
    this.line = outcome();
    this.other = element("select");
    this.was = button("", () => this.correct(this.answered));
    this.choices = element("div", { class: "buttons" }, this.was,
      button("None of the actions", () => this.correct("")), field("Another action", this.other), button("It was this", () => this.correct(this.other.value)));
    this.update = button("Update the model", () => this.train(), { kind: "primary" });
    this.training = new JobView(["train"], (job) => this.ended(job));
    this.element = element("div", { class: "correcting", hidden: true }, element("h3", {}, "What was it really?"), this.choices, this.line, this.update, this.training.element);
    trainer.on(() => this.look());
  }

  // The set that the model in use was trained on, while the trainer has it; else there is nothing to correct in.
  get set() {
    return trainer.all?.sets.find(({ name }) => name === trainer.now?.model_set) ?? null;
  }

  get answered() {
    const { held, event, action } = this.segment;
    return (held ?? event ?? action).action;
  }

  show(segment) {
    this.segment = segment;
    say(this.line, this.corrected.get(segment.id) ?? "");
    this.look();
  }

  look() {
    const { segment, set } = this;
    const answer = segment && (segment.held ?? segment.event ?? segment.action);
    this.element.hidden = !set || !answer?.agent || !answer.end_ns;
    if (this.element.hidden) return;
    const labels = Object.keys(set.actions);
    this.choices.hidden = this.corrected.has(segment.id);
    this.was.hidden = !labels.includes(answer.action);
    this.was.textContent = `It was ${answer.action}`;
    if (labels.join("/") !== this.other.dataset.labels) {
      this.other.dataset.labels = labels.join("/");
      this.other.replaceChildren(...labels.map((label) => element("option", { value: label }, label)));
    }
    this.training.element.hidden = !this.job || this.job !== trainer.now?.job?.id;
    this.update.hidden = !this.since || trainer.now?.job?.state === "running";
    this.update.textContent = `Update the model (${counted(this.since, "correction")})`;
  }

  async correct(label) {
    const { segment, set } = this;
    const given = { set: set.name, agent: segment.agent, start_ns: segment.start, end_ns: segment.end, label };
    const done = `Kept in the set ${set.name} as ${label ? `an example of ${label}` : "none of the actions"}.`;
    if (!(await attempt(this.line, () => trainer.ask("correct", given), done))) return;
    this.corrected.set(segment.id, done);
    this.since += 1;
    this.look();
  }

  async train() {
    const job = await this.training.start("train", { set: this.set.name });
    if (!job) return;
    Object.assign(this, { job: job.id, since: 0 });
    this.look();
  }

  // Puts the model into use that was trained here; other panels train models, too.
  async ended({ id, result }) {
    if (id !== this.job || !result) return;
    await attempt(this.line, () => trainer.ask("activate", { model: result.model }), "The new model is in use within two seconds.");
  }
}
