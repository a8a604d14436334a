// Examples from video files: dropped anywhere on the page or chosen, sent in pieces, read by the trainer as a job.

import { attempt, outcome, say } from "../asking.js";
import { card, element, percent } from "../elements.js";
import { JobView } from "../jobs.js";
import { PAGE } from "../names.js";
import { trainer } from "../trainer.js";

const PIECE = 500_000;    // bytes: as base64 it fits a message to the page's service
const LONGEST = 45;       // characters of its name: the page's own stands before it, and the trainer takes 64
const UNUSUAL = /[^\p{L}\p{N} _.-]/gu;
const NUMBERED = /[\s_.-]*\d*\.[^.]*$/u;   // how the name of one of several clips ends: ` 2.mp4`

export function video(form) {
  return new Videos(form).card;
}

class Videos {
  constructor(form) {
    Object.assign(this, { form, waiting: [], busy: false, jobId: null });
    this.line = outcome();
    this.before = element("ul", { class: "doubts", "aria-label": "Videos before this one" });
    this.job = new JobView(["import"], (job) => this.ended(job));
    this.choice = element("input", { type: "file", accept: "video/*", multiple: true, id: "video-file" });
    this.choice.addEventListener("change", () => this.take(this.choice.files));
    const zone = element("label", { class: "zone", for: "video-file" }, element("span", {}, "Drop a video anywhere on the page, or choose one"), this.choice);
    this.card = card("video", "Or from a video", {}, zone,
      element("p", { class: "caption" }, "Action, person and number are taken from the form Record. Without an action there, the file's name is the action. Film the whole person from the front."),
      this.before, this.line, this.job.element);
    trainer.onChoice(() => this.forget());
    this.watchDrops();
  }

  forget() {
    this.before.replaceChildren();
    say(this.line, "");
    this.job.quiet();
  }

  watchDrops() {
    const over = (event, whether) => {
      if (!event.dataTransfer?.types.includes("Files")) return;
      event.preventDefault();
      document.body.classList.toggle("dropping", whether);
    };
    addEventListener("dragover", (event) => over(event, true));
    addEventListener("dragleave", (event) => event.relatedTarget === null && over(event, false));
    addEventListener("drop", (event) => {
      over(event, false);
      if (!event.dataTransfer?.files.length) return;
      location.hash = "teach";
      this.take(event.dataTransfer.files);
    });
  }

  take(files) {
    if (!this.busy) this.before.replaceChildren();
    this.waiting.push(...files);
    this.next();
  }

  // Sends the next file, and has it read; others wait until that is done.
  async next() {
    if (this.busy || !this.waiting.length) return;
    this.busy = true;
    const file = this.waiting.shift();
    this.name = file.name;
    this.choice.value = "";
    this.job.quiet();
    const job = await this.send(file);
    this.jobId = job?.id;
    if (!job) this.go();
  }

  async send(file) {
    const { set, label, person, count } = this.form.fields;
    if (!set) return say(this.line, "Create a set first.", true);
    const upload = `${PAGE}-${nameOf(file)}`;  // another tab may send a file of that name
    if (!(await attempt(this.line, () => this.upload(file, upload), `${file.name} sent.`))) return null;
    return this.job.start("import_video", { set, upload, label: label || file.name.replace(NUMBERED, ""), person, count });
  }

  async upload(file, name) {
    let reply = null;
    for (let offset = 0; offset === 0 || offset < file.size; offset += PIECE) {
      const piece = file.slice(offset, offset + PIECE);
      say(this.line, `Sending ${file.name}: ${percent(offset / Math.max(file.size, 1))}`);
      reply = await trainer.ask("upload", { name, offset, data: await base64(piece), last: offset + PIECE >= file.size });
    }
    return reply;
  }

  ended({ id, result }) {
    if (id !== this.jobId) return;
    if (result?.doubts?.length) say(this.line, result.doubts.join(" "), true);
    this.go();
  }

  // The next file's outcome takes the place of this one's: what went wrong is kept above it.
  go() {
    this.busy = false;
    const wrong = [this.line, this.job.line].filter((line) => this.waiting.length && line.classList.contains("refused"));
    this.before.append(...wrong.map((line) => element("li", { class: "doubt" }, `${this.name}: ${line.textContent}`)));
    this.next();
  }
}

// What the file is called where it is sent to: letters, digits and few signs.
function nameOf(file) {
  return file.name.replaceAll(UNUSUAL, "_").replace(/^[^\p{L}\p{N}]+/u, "").slice(-LONGEST).replace(/^[^\p{L}\p{N}]+|[ .]+$/gu, "") || "video";
}

function base64(blob) {
  return new Promise((resolve, reject) => {
    const reader = new FileReader();
    reader.onload = () => resolve(reader.result.slice(reader.result.indexOf(",") + 1));
    reader.onerror = () => reject(new Error("The browser cannot read the file."));
    reader.readAsDataURL(blob);
  });
}
