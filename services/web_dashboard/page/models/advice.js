// What the trainer advises to record next, sentence by sentence.

import { element } from "../elements.js";

export function advice() {
  const list = element("ul", { class: "advice" });
  const heading = element("h3", {}, "What to record next");
  const whole = element("section", { "aria-label": "What to record next", hidden: true }, heading, list);
  const tell = (sentences = []) => {
    whole.hidden = !sentences.length;
    list.replaceChildren(...sentences.map((sentence) => element("li", {}, sentence)));
  };
  return { element: whole, tell };
}
