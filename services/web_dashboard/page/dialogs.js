// Dialogs: a question before something is lost, and one that asks for a text.

import { button, field, suggesting } from "./asking.js";
import { element } from "./elements.js";

// Opens a dialog over the page; `actions` stand at its end. Resolves to what `close(value)` was given, null on Escape.
export function dialog(title, build) {
  const heading = element("h2", { id: "dialog-title" }, title);
  const box = element("dialog", { "aria-labelledby": "dialog-title" }, heading);
  return new Promise((resolve) => {
    const close = (value) => {
      box.returned = value;
      box.close();
    };
    box.addEventListener("close", () => {
      box.remove();
      resolve(box.returned ?? null);
    });
    box.append(...build(close));
    document.body.append(box);
    box.showModal();
  });
}

// Resolves to whether it is really wanted.
export function confirmed(question, verb) {
  return dialog(question, (close) => [
    element("div", { class: "buttons" }, button(verb, () => close(true), { kind: "danger" }), button("Keep", () => close(null))),
  ]);
}

// Resolves to a text, null where it was called off.
export function typed(title, name, value, suggestions, verb) {
  return dialog(title, (close) => {
    const { input, list, suggest } = suggesting("typed", { value });
    suggest(suggestions);
    const taken = (event) => {
      event.preventDefault();
      close(input.value);
    };
    const buttons = element("div", { class: "buttons" }, element("button", { class: "primary" }, verb), button("Cancel", () => close(null)));
    return [element("form", { on: { submit: taken } }, field(name, input), list, buttons)];
  });
}
