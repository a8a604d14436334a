// The switch: hold it, or press it for the start and again for the end; the space bar does the same.

import { attempt, button as pressable, outcome } from "../asking.js";
import { card, element, seconds } from "../elements.js";
import { link } from "../link.js";
import { newName } from "../names.js";
import { trainer } from "../trainer.js";
import { marks } from "./marks.js";
import { people } from "./people.js";

const TAP_MS = 350;   // a shorter press switches on, and the next one off
const ANSWER_S = 6;   // 2 s for the classifier's late frames, 2 s for the fusion's late objects, and a margin
const HINT = "Hold the switch or the space bar while somebody acts. Or press it briefly at the start, and again at the end.";
const NO_ANSWER = `No answer within ${ANSWER_S} s. The table Services, on Live, shows which service is missing or has no model; 'actum doctor' says why.`;
const OFF = "Marks are off: the classifier answers only the actions that it finds by itself, because its setting 'segments' is 'auto'.";

export function markSwitch(id = "switch", title = "Switch") {
  const button = element("button", { type: "button", class: "switch", "aria-pressed": "false" }, "Hold to mark");
  const who = element("select", { "aria-label": "Whose action is marked" });
  const told = element("p", { class: "caption", role: "status" }, HINT);
  const line = outcome();
  const turnOn = pressable("Turn marks on", () => attempt(line, () => marks.turnOn(), "The classifier now uses marks too."));
  new Switch(button, who, told, turnOn);
  return card(id, title, { controls: [who] }, button, told, turnOn, line);
}

class Switch {
  constructor(button, who, told, turnOn) {
    Object.assign(this, { button, who, told, turnOn, segment: null, pressedAt: 0, offered: null });
    button.addEventListener("pointerdown", (event) => this.press(event));
    addEventListener("pointerup", () => this.release());
    addEventListener("pointercancel", () => this.release());
    addEventListener("keydown", (event) => this.key(event));
    addEventListener("keyup", (event) => event.key === " " && this.release());
    addEventListener("blur", () => this.segment && this.end());
    link.on("event", (event) => this.answered(event));
    link.on("skeleton", () => this.offer());
    link.on("state", ({ connected }) => connected || !this.segment || this.cut());
    setInterval(() => this.segment && (this.button.offsetParent ? this.tell() : this.end()), 100); // unseen, nobody ends it
    marks.on(() => this.allow());
    trainer.on(() => this.allow());
    this.allow();
    this.offer();
  }

  // Marks that nobody takes cannot be made: neither the classifier nor a take that is being recorded.
  allow() {
    const isOff = marks.areOff && !isTaking() && !this.segment;
    if (isOff === this.isOff) return;
    this.isOff = this.button.disabled = isOff;
    this.turnOn.hidden = !isOff;
    this.told.textContent = isOff ? OFF : HINT;
  }

  offer() {
    if (String(people.present) === this.offered) return;
    this.offered = String(people.present);
    const before = this.who.value;
    const each = people.present.map((agent) => element("option", { value: String(agent) }, `Person ${agent}`));
    this.who.replaceChildren(element("option", { value: "" }, "Whoever acts"), ...each);
    this.who.value = people.present.includes(Number(before)) ? before : "";
  }

  key(event) {
    const elsewhere = event.target.closest?.("input, select, textarea, button, a, summary, [role=application]");
    if (event.key !== " " || event.repeat || (elsewhere && elsewhere !== this.button) || !this.button.offsetParent) return;
    this.press(event);
  }

  press(event) {
    if (this.button.disabled) return;
    event.preventDefault();
    this.button.focus({ preventScroll: true });
    if (this.held) return;
    this.held = true;
    if (this.segment) return this.end();
    this.pressedAt = performance.now();
    this.begin();
  }

  release() {
    const held = this.held;
    this.held = false;
    if (held && this.segment && performance.now() - this.pressedAt > TAP_MS) this.end();
  }

  begin() {
    this.segment = { segment_id: `page-${newName()}`, agent: Number(this.who.value) || null };
    this.button.setAttribute("aria-pressed", "true");
    this.button.textContent = "Marking …";
    this.put("start");
  }

  end() {
    this.waiting = this.segment.segment_id;
    this.told.textContent = "Ending …";
    this.put("end", "Marked; waiting for the answer …");
    this.off();
  }

  // The page's service ends the marks of a connection that ends.
  cut() {
    this.waiting = this.segment.segment_id;
    this.told.textContent = "The connection was lost, so the mark has ended.";
    this.off();
  }

  off() {
    this.segment = null;
    this.button.setAttribute("aria-pressed", "false");
    this.button.textContent = "Hold to mark";
  }

  async put(kind, told) {
    const { segment_id: id } = this.segment;
    try {
      await link.mark({ ...this.segment, kind });
      if (!told || this.waiting !== id) return;
      this.told.textContent = told;
      setTimeout(() => this.waiting === id && (this.told.textContent = NO_ANSWER), 1000 * ANSWER_S);
    } catch (error) {
      if (this.waiting === id) this.waiting = null;
      if (this.segment?.segment_id === id) this.off();
      this.told.textContent = `Not marked: ${error.message}`;
    }
  }

  tell() {
    const who = this.segment.agent ? `person ${this.segment.agent}` : "whoever acts";
    this.told.textContent = `Marking ${who} for ${seconds((performance.now() - this.pressedAt) / 1000)}`;
  }

  answered({ segment_id: id, valid, sentence, reason }) {
    if (id !== this.waiting) return;
    this.waiting = null;
    if (marks.areOff && isTaking()) this.told.textContent = "Marked: the example belongs to the take.";
    else this.told.textContent = valid ? `Answer: ${sentence}` : `No answer: ${reason}`;
  }
}

// Whether a take is being recorded, whose examples may be marked by hand.
function isTaking() {
  const take = trainer.now?.recording;
  return take?.kind === "action" && take.phase !== "done";
}
