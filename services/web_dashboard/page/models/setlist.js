// All sets with dates and people, to choose from.

import { button, counted, dated } from "../asking.js";
import { card, element } from "../elements.js";
import { trainer } from "../trainer.js";

const HEADS = ["Set", "Created", "Actions", "People", "Takes", "Background", "Do"];

export function setList() {
  const body = element("tbody");
  const head = element("thead", {}, element("tr", {}, ...HEADS.map((text) => element("th", { scope: "col" }, text))));
  const table = element("table", {}, element("caption", { class: "unseen" }, "Sets of examples"), head, body);
  const scrolled = element("div", { class: "scrolled", tabindex: "0", role: "region", "aria-label": "Table of sets" }, table);
  const none = element("p", { class: "none" }, "No set yet: create one on the panel Teach.");
  let shown = null;
  trainer.on(() => {
    const wanted = `${trainer.all?.revision}/${trainer.set?.name}`;
    if (!trainer.all || shown === wanted) return;
    shown = wanted;
    scrolled.hidden = !trainer.all.sets.length;
    none.hidden = !scrolled.hidden;
    body.replaceChildren(...trainer.all.sets.map(row));
  });
  return card("set-list", "Sets", { wide: true }, none, scrolled);
}

function row({ name, created, actions, people, takes, background_s: background }) {
  const held = Object.entries(actions).map(([label, number]) => `${label} × ${number}`).join(", ");
  const texts = [dated(created), held || "–", people.join(", ") || "–", counted(takes.length, "take"), `${Math.round(background)} s`];
  const cells = texts.map((text, i) => element("td", { "data-head": HEADS[i + 1] }, text));
  const isChosen = trainer.set?.name === name;
  const choose = button(isChosen ? "Chosen" : "Choose", () => trainer.choose(name), { label: `Choose set ${name}`, kind: "small" });
  choose.disabled = isChosen;
  return element("tr", { class: isChosen ? "active" : "" }, element("th", { scope: "row" }, name), ...cells, element("td", {}, choose));
}
