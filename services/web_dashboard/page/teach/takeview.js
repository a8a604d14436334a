// A take while it is recorded: the person as they are seen, how many repetitions there are, whether they move or rest.

import { drawFigure, fromInFront } from "../body.js";
import { counted as numbered } from "../asking.js";
import { drawn, element, seconds } from "../elements.js";
import { link } from "../link.js";
import { newestPosture, people, shownAgent } from "../live/people.js";
import { isSensorStill } from "../waiting.js";


export class TakeView {
  constructor() {
    const canvas = element("canvas", { role: "img", "aria-label": "The person as they are seen now" });
    this.count = element("p", { class: "count", "aria-hidden": "true" });
    this.what = element("p", { class: "caption" });
    this.phase = element("p", { class: "phase" });
    this.told = element("p", { class: "unseen", role: "status" });
    this.dots = element("p", { class: "dots", "aria-hidden": "true" });
    this.element = element("div", { class: "stage-box", role: "group", "aria-label": "Take" }, canvas, element("div", { class: "counts-along" }, this.what, this.count, this.dots, this.phase, this.told));
    const redraw = drawn(canvas, (context, width, height) => this.draw(context, width, height));
    link.on("frame", () => this.element.offsetParent && redraw());
    this.show(null);
  }

  draw(context, width, height) {
    const posture = newestPosture(shownAgent());
    const size = Math.min(1.3 * width, height);
    if (posture?.upright && people.present.length) drawFigure(context, fromInFront(posture.upright, width / 2, height / 2, size), { width: size / 40 });
  }

  show(take) {
    const isGoing = Boolean(take) && take.phase !== "done";
    this.element.dataset.phase = isGoing ? take.phase : "idle";
    const count = !isGoing ? "" : take.kind === "background" ? seconds(take.seconds) : `${take.counted} of ${take.asked}`;
    this.count.textContent = count;
    this.what.textContent = isGoing ? [take.kind === "background" ? "background" : take.label, take.person].filter(Boolean).join(", by ") : "";
    this.phase.textContent = isGoing ? wording(take) : "";
    const told = isGoing && take.kind === "action" ? `${count}, ${wording(take)}` : "";
    if (this.told.textContent !== told) this.told.textContent = told;
    this.drawDots(isGoing && take.kind === "action" ? take : { asked: 0, counted: 0 });
  }

  drawDots({ asked, counted }) {
    const key = `${counted}/${asked}`;
    if (this.dots.dataset.key === key) return;
    this.dots.dataset.key = key;
    this.dots.replaceChildren(...Array.from({ length: asked }, (_, i) => element("i", { class: i < counted ? "full" : "" })));
  }
}

function wording({ kind, phase, label, asked, counted, people: seen }) {
  if (isSensorStill()) return "The sensor publishes nothing: the take waits for it";
  if (!seen && phase === "waiting") return "Nobody is in view: step in front of the camera";
  if (kind === "background") return "Do anything but the actions, then press Stop";
  if (phase === "waiting") return `Do it: ${label}, ${numbered(asked, "time")}`;
  if (phase === "moving") return "Moving …";
  return counted >= asked ? "Done: stand still for a moment" : "Resting: now again";
}
