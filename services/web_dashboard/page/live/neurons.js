// The output neurons, as the paper shows them: one bar for each trained action, the largest one wins.

import { colourOf, learn } from "../colours.js";
import { card, element } from "../elements.js";
import { link } from "../link.js";
import { segmentOf } from "./answers.js";
import { isShown } from "./people.js";

export function neurons() {
  const caption = element("p", { class: "caption" }, "No answer yet.");
  const list = element("ul", { class: "bars", "aria-label": "Activity of each action's neuron" });
  const bars = new Bars(list);
  link.on("action", ({ agent, segment_id: id, activations, action, final }) => {
    const isLate = !final && segmentOf(id)?.action;
    if (!isShown(agent) || isLate || !Object.keys(activations).length) return;
    caption.textContent = final ? `The last answer: ${action ?? "none"}.` : "The movement that is going on now.";
    bars.show(activations, action);
  });
  return card("neurons", "Output neurons", {}, list, caption);
}

// Bars from −1 to 1, one for each name, in the names' order.
export class Bars {
  constructor(list) {
    this.list = list;
    this.rows = new Map();
  }

  show(activations, winner) {
    const names = Object.keys(activations).sort();
    learn(names);
    if (names.length !== this.rows.size || names.some((name) => !this.rows.has(name))) this.build(names);
    for (const [name, row] of this.rows) {
      const value = activations[name];
      row.item.classList.toggle("winner", name === winner);
      row.bar.style.left = `${50 + 50 * Math.min(value, 0)}%`;
      row.bar.style.width = `${50 * Math.min(Math.abs(value), 1)}%`;
      row.number.textContent = value.toFixed(2).replace("-", "−");
    }
  }

  build(names) {
    this.rows.clear();
    for (const name of names) {
      const bar = element("span", { class: "bar", style: { "--action": colourOf(name) } });
      const number = element("span", { class: "number" });
      const item = element("li", {}, element("span", { class: "name" }, name), element("span", { class: "track" }, bar), number);
      this.rows.set(name, { item, bar, number });
    }
    this.list.replaceChildren(...[...this.rows.values()].map(({ item }) => item));
  }
}
