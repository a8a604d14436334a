// The trainer's job: how far it is, a button that cancels it, and who wants to know when it has ended.

import { attempt, button, outcome, say } from "./asking.js";
import { element, percent } from "./elements.js";
import { guarded } from "./guarded.js";
import { trainer } from "./trainer.js";

const KINDS = { train: "Training", evaluate: "Testing", import: "Reading the video" };
const CANCELLED = "cancelled";    // the message of one that somebody cancelled

// Shows jobs of some kinds while they run; calls `ended(job)`, with its result, once for each that has ended.
export class JobView {
  constructor(kinds, ended) {
    Object.assign(this, { kinds, ended: guarded(ended), running: null, over: new Set() });
    this.bar = element("progress", { max: 1, value: 0, "aria-label": "Share of this stage that is done" });
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
    this.over.delete(job?.id);  // its end may have been told before this reply: it is told again
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
    if (this.running && this.running !== job?.id) this.end(this.running);  // another came after it between two messages
    const isOurs = this.kinds.includes(job?.kind);
    this.going.hidden = !isOurs || job.state !== "running";
    if (!isOurs) return;
    this.bar.value = job.done;
    this.stage.textContent = `${KINDS[job.kind]}: ${job.stage}, ${percent(job.done)}`;
    if (job.state === "running") this.running = job.id;
    else this.end(job.id);
  }

  // Also of a job that had ended before the page was opened: its result is still there.
  async end(id) {
    if (this.over.has(id)) return;
    this.over.add(id);
    let job = { id, state: "failed", result: null };
    try {
      job = await trainer.ask("job", { job: id });
    } catch (error) {
      if (!error.refused) return this.over.delete(id);  // the next message has it asked again
      job.message = error.message;
    }
    if (job.state === "running") return this.over.delete(id);  // the message was older than the job
    if (this.running === id) this.running = null;
    say(this.line, ...told(job));
    this.ended(job);
  }
}

// What became of a job, and whether that was not wanted: a trainer that is started anew cancels what ran before.
function told({ state, message }) {
  if (state === "done") return [message];
  if (message === CANCELLED) return ["Cancelled."];
  return [`${state === "failed" ? "Failed" : "Cancelled"}: ${message}`, true];
}
