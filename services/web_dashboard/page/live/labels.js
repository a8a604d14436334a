// Labels over a picture or a 3-D view, each moved up or down until it covers no other.

import { element } from "../elements.js";

const GAP_PX = 2;         // between two labels
const STEADY_PX = 6;      // how much freer another place has to be before a label leaves its own, or it would flicker
const ROWS = [0, -1, 1, -2, 2, -3, 3, -4, 4];

export class Labels {
  constructor(box) {
    Object.assign(this, { box, made: new Map() });
  }

  // Shows labels {text, x, y, faint}: where the middle of each would best stand, in pixels of the box.
  show(labels) {
    const wanted = new Set(labels.map(({ text }) => text));
    for (const [text, { shown }] of this.made) {
      if (wanted.has(text)) continue;
      shown.remove();
      this.made.delete(text);
    }
    const { clientWidth: width, clientHeight: height } = this.box;
    const taken = [];
    for (const label of labels) taken.push(this.place(label, taken, { right: width, bottom: height }));
  }

  place({ text, x, y, faint }, taken, bounds) {
    if (!this.made.has(text)) this.made.set(text, this.make(text));
    const label = this.made.get(text);
    const left = Math.max(0, Math.min(x - label.width / 2, bounds.right - label.width));
    const at = (row) => rectangle(left, y + row * (label.height + GAP_PX) - label.height / 2, label);
    const isFree = (row) => {
      const place = grown(at(row), row === label.row ? 0 : STEADY_PX);
      return at(row).top >= 0 && at(row).bottom <= bounds.bottom && !taken.some((other) => overlap(place, other));
    };
    label.row = [label.row, ...ROWS].find(isFree) ?? 0;
    if (label.row && isFree(0)) label.row = 0;
    const placed = at(label.row);
    label.shown.style.transform = `translate(${placed.left}px, ${placed.top}px)`;
    label.shown.classList.toggle("faint", faint);
    return placed;
  }

  make(text) {
    const shown = element("span", { class: "label", "aria-hidden": "true" }, text);
    this.box.append(shown);
    return { shown, row: 0, width: shown.offsetWidth, height: shown.offsetHeight };
  }
}

function rectangle(left, top, { width, height }) {
  return { left, top, right: left + width, bottom: top + height };
}

function grown({ left, top, right, bottom }, by) {
  return { left: left - by, top: top - by, right: right + by, bottom: bottom + by };
}

function overlap(one, other) {
  return one.left < other.right && other.left < one.right && one.top < other.bottom && other.top < one.bottom;
}
