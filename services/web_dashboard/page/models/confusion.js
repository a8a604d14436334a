// The confusion matrix: what was done in rows, what was answered in columns.

import { element, percent } from "../elements.js";

export function confusionTable(labels, confusion) {
  const head = element("tr", {}, element("th", { scope: "col" }, "done ↓  recognised →"), ...labels.map((label) => element("th", { scope: "col" }, label)));
  const rows = labels.map((label, row) => {
    const sum = confusion[row].reduce((total, number) => total + number, 0);
    return element("tr", {}, element("th", { scope: "row" }, label), ...confusion[row].map((number, column) => cell(number, sum, row === column)));
  });
  const table = element("table", { class: "confusion" },
    element("caption", {}, "How often each action (row) was recognised as which (column)"), element("thead", {}, head), element("tbody", {}, ...rows));
  return element("div", { class: "scrolled", tabindex: "0", role: "region", "aria-label": "Confusion matrix" }, table);
}

function cell(number, sum, isRight) {
  const share = sum ? number / sum : 0;
  const made = element("td", { class: isRight ? "right" : "wrong", style: { "--share": share } }, String(number));
  if (number && share < 1) made.append(element("small", {}, percent(share)));
  return made;
}
