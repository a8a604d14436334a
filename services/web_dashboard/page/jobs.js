// The trainer's job: how far it is, a button that cancels it, and who wants to know when it has ended.

import { attempt, button, outcome, say } from "./asking.js";
import { element, percent } from "./elements.js";
import { trainer } from "./trainer.js";

const KINDS = { train: "Training", evaluate: "Testing", import: "Reading the video" };

// Shows jobs of some kinds while they run; calls `ended(job)`, with its result, once for each that has ended.
export class JobView {
  constructor(kinds, ended) {
    Object.assign(this, { kinds, ended, running: null, over: new Set() });
    this.bar = element("progress", { max: 1, value: 0, "aria-label": "How much of this stage is done" });
    this.stage = element("span", { class: "stage" });
    this.cancel = button("Cancel", () => this.stop());
    this.line = outcome();
    this.going = element("div", { class: "job", hidden: true }, this.stage, this.bar, this.cancel);
    this.element = element("div", {}, this.going, this.line);
    trainer.on(() => this.show(trainer.now?.job));
  }

  // Starts a job, such as `train`; says so where it is refused.
  async start(command, fields) {
    const job = await attempt(this.line, () => trainer.ask(command, fields));
    if (job) this.show(job);
    return job;
  }

  quiet() {
    say(this.line, "");
  }

  stop() {
    return attempt(this.line, () => trainer.ask("cancel", { job: this.running }));
  }

  show(job) {
    if (!job || !this.kinds.includes(job.kind)) return (this.going.hidden = true);
    const isRunning = job.state === "running";
    this.going.hidden = !isRunning;
    this.bar.value = job.done;
    this.stage.textContent = `${KINDS[job.kind]}: ${job.stage}, ${percent(job.done)}`;
    if (isRunning) this.running = job.id;
    else if (!this.over.has(job.id)) this.end(job);
  }

  // Also of a job that had ended before the page was opened: its result is still there.
  async end({ id, state, message }) {
    this.over.add(id);
    say(this.line, state === "done" ? message : `${state}: ${message}`, state === "failed");
    try {
      this.ended(await trainer.ask("job", { job: id }));
    } catch (error) {
      say(this.line, error.message, true);
      this.ended({ id, result: null });
    }
  }
}
