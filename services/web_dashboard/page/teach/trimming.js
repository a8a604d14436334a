// Trimming an example: two handles over its time, each a range that keys move too; the film shows where they stand.

import { button } from "../asking.js";
import { dialog } from "../dialogs.js";
import { element } from "../elements.js";
import { Film } from "./film.js";

const BEYOND_NS = 500_000_000;   // how far before and after it the handles go: it may have been cut too narrowly
const STEP_S = 0.02;

// Resolves to {start_ns, end_ns}, null where it was called off.
export function trimmed(name, { start_ns: start, end_ns: end }, film) {
  return dialog(`Trim ${name}`, (close) => {
    const length = (end - start + 2 * BEYOND_NS) / 1e9;
    const canvas = element("canvas", { class: "large", role: "img", "aria-label": "The picture at the handle" });
    const shown = new Film(canvas);
    if (film) shown.show(film);
    const handles = [handle("Start", 0.5, length), handle("End", length - 0.5, length)];
    const stampOf = (each) => Math.round(start - BEYOND_NS + Number(each.value) * 1e9);
    const told = element("p", { class: "caption", role: "status" });
    const moved = (which) => {
      const [first, last] = handles.map((each) => Number(each.value));
      if (last - first < 0.1) handles[which].value = which ? first + 0.1 : last - 0.1;
      bar.style.setProperty("--from", Number(handles[0].value) / length);
      bar.style.setProperty("--to", Number(handles[1].value) / length);
      shown.at(which === null ? null : stampOf(handles[which]));
      const [from, to] = handles.map((each) => Number(each.value) - 0.5);
      told.textContent = `From ${from.toFixed(2)} s to ${to.toFixed(2)} s: ${(to - from).toFixed(2)} s long`;
    };
    const bar = element("div", { class: "trim" }, ...handles);
    handles.forEach((each, which) => each.addEventListener("input", () => moved(which)));
    moved(null);
    const save = button("Trim", () => close({ start_ns: stampOf(handles[0]), end_ns: stampOf(handles[1]) }), { kind: "primary" });
    return [canvas, bar, told, element("div", { class: "buttons" }, save, button("Play", () => shown.at(null)), button("Cancel", () => close(null)))];
  });
}

function handle(name, value, length) {
  return element("input", { type: "range", "aria-label": name, min: String(value % STEP_S), max: String(length), step: String(STEP_S), value: String(value) });
}
