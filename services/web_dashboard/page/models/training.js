// Training a model on the chosen set, and putting it into use.

import { attempt, button, field, outcome } from "../asking.js";
import { card, element, percent } from "../elements.js";
import { JobView } from "../jobs.js";
import { setChoice } from "../setchoice.js";
import { trainer } from "../trainer.js";
import { advice } from "./advice.js";

export function training() {
  const made = new Training();
  return card("training", "Train", {}, made.form, made.job.element, made.use, made.line, made.advice.element);
}

class Training {
  constructor() {
    this.preset = element("select");
    this.continued = element("input", { type: "checkbox" });
    this.job = new JobView(["train"], (job) => this.ended(job));
    this.line = outcome();
    this.advice = advice();
    this.model = null;
    this.use = element("div", { class: "buttons", hidden: true }, button("Use this model", () => this.activate(), { kind: "primary" }));
    this.form = element("form", { on: { submit: (event) => this.submitted(event) } },
      element("div", { class: "fields" }, field("Set", setChoice()), field("Training parameters", this.preset)),
      element("label", { class: "check" }, this.continued, "Also learn how postures go on"),
      element("div", { class: "buttons" }, element("button", { class: "primary" }, "Train")));
    trainer.on(() => this.offer());
    trainer.onChoice(() => this.forget());
  }

  forget() {
    this.model = null;
    this.job.quiet();
    this.line.textContent = "";
    this.advice.tell();
  }

  offer() {
    const presets = trainer.all?.presets ?? [];
    if (presets.length !== this.preset.length) this.preset.replaceChildren(...presets.map((name) => element("option", { value: name }, name)));
    this.use.hidden = !this.model || this.model === trainer.all?.active || !trainer.all?.models.some(({ id }) => id === this.model);
  }

  async submitted(event) {
    event.preventDefault();
    this.forget();
    await this.job.start("train", { set: trainer.set?.name ?? "", preset: this.preset.value, continued: this.continued.checked });
    this.offer();
  }

  ended({ result }) {
    if (!result) return;
    const { model, scores, left_out: leftOut, advice: sentences } = result;
    this.model = model;
    const held = scores.accuracy_held_out;
    const right = held === undefined ? [] : [`${percent(held)} of the examples recognised correctly, each by a model trained without it.`];
    const lost = leftOut.length ? [`Examples that cannot be used, with the reason: ${leftOut.join("; ")}.`] : [];
    this.line.textContent = [...right, ...lost].join(" ");
    this.advice.tell(sentences);
    this.offer();
  }

  activate() {
    return attempt(this.line, () => trainer.ask("activate", { model: this.model }), "In use: the classifier loads it within two seconds.");
  }
}
