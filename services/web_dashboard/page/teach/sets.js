// The set of examples that is taught: chosen, created, renamed, deleted.

import { attempt, button, counted, field, outcome, say } from "../asking.js";
import { colourOf } from "../colours.js";
import { confirmed, typed } from "../dialogs.js";
import { card, element } from "../elements.js";
import { setChoice } from "../setchoice.js";
import { trainer } from "../trainer.js";

export function sets() {
  const choice = setChoice();
  const name = element("input", { type: "text", value: "my actions", autocomplete: "off", spellcheck: "false" });
  const line = outcome();
  const holds = element("div", { class: "holds" });
  const rename = button("Rename", () => trainer.set && renamed(trainer.set.name, line));
  const remove = button("Delete set", () => trainer.set && deleted(trainer.set, line));
  const make = element("form", { class: "row", on: { submit: (event) => made(event, name, line) } },
    field("Name of a new set", name), element("button", {}, "Create set"));
  trainer.on(() => show(holds, [rename, remove]));
  trainer.onChoice(() => say(line, ""));
  const chosen = element("div", { class: "row" }, field("Set", choice), element("div", { class: "buttons" }, rename, remove));
  return card("set", "1 · Set of examples", {}, chosen, holds, make, line);
}

function show(holds, buttons) {
  for (const each of buttons) each.disabled = !trainer.set;
  const shown = `${trainer.set?.name}/${trainer.all?.revision}`;
  if (holds.dataset.shown === shown) return;
  holds.dataset.shown = shown;
  holds.replaceChildren(...(trainer.set ? described(trainer.set) : []));
}

function described({ actions, people, background_s: background, unreadable }) {
  const chips = Object.entries(actions).map(([label, number]) =>
    element("li", { style: { "--action": colourOf(label) } }, element("i", { class: "swatch" }), `${label} × ${number}`));
  const who = people.length ? `by ${people.join(", ")}` : "";
  const rest = `${Math.round(background)} s of background`;
  const wrong = unreadable.map((text) => element("p", { class: "doubt" }, text));
  return [
    chips.length ? element("ul", { class: "chips", "aria-label": "Actions of the set" }, ...chips) : element("p", { class: "none" }, "No examples yet."),
    element("p", { class: "caption" }, [who, rest].filter(Boolean).join(" · ")), ...wrong,
  ];
}

async function made(event, name, line) {
  event.preventDefault();
  const set = name.value;
  const make = () => trainer.ask("create_set", { set }).then(() => trainer.chooseNew(set.normalize("NFC")));
  await attempt(line, make, `Set ${set} created.`);
}

async function renamed(set, line) {
  const name = await typed(`Rename ${set}`, "New name", set, [], "Rename");
  if (name === null) return;
  const rename = () => trainer.ask("rename_set", { set, name }).then(() => trainer.chooseNew(name.normalize("NFC")));
  await attempt(line, rename, `Set ${set} is now called ${name}.`);
}

async function deleted({ name, actions }, line) {
  const number = Object.values(actions).reduce((sum, each) => sum + each, 0);
  if (await confirmed(`Delete the set ${name} with ${counted(number, "example")}?`, "Delete set")) {
    const remove = () => trainer.ask("delete_set", { set: name }).then(() => trainer.listAnew());
    await attempt(line, remove, `Set ${name} deleted.`);
  }
}
