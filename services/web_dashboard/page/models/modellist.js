// All models: put into use, compared, deleted, and the way back to the previous one.

import { attempt, button, dated, outcome, say } from "../asking.js";
import { confirmed } from "../dialogs.js";
import { card, element, percent } from "../elements.js";
import { trainer } from "../trainer.js";

const HEADS = ["Model", "Created", "Set", "Actions", "People", "Examples", "Accuracy, held out", "Do"];
const SHIPPED = /actum_command[\\/]simulated_model\.npz$/;
const SHORT = 8;          // characters of a model's id: enough to tell a hundred apart

export function modelList() {
  const body = element("tbody");
  const line = outcome();
  const compared = element("section", { class: "compared", "aria-label": "Comparison", hidden: true });
  const undo = button("Back to the previous model", () => attempt(line, () => trainer.ask("undo"), "The previous model is in use again."));
  const none = element("p", { class: "none" }, "No model yet.");
  const head = element("thead", {}, element("tr", {}, ...HEADS.map((text) => element("th", { scope: "col" }, text))));
  const table = element("table", {}, element("caption", { class: "unseen" }, "Models"), head, body);
  const scrolled = element("div", { class: "scrolled", tabindex: "0", role: "region", "aria-label": "Table of models" }, table);
  const wrong = element("div");
  const live = element("p", { class: "caption live-model" });
  let shown = null;
  trainer.on(() => {
    undo.disabled = !trainer.now?.can_undo;
    live.textContent = trainer.now ? liveModel(trainer.now) : "";
    if (!trainer.all || shown === trainer.all) return;
    shown = trainer.all;
    scrolled.hidden = !shown.models.length;
    none.hidden = !scrolled.hidden;
    wrong.replaceChildren(...(shown.unreadable ?? []).map((text) => element("p", { class: "doubt" }, text)));
    body.replaceChildren(...shown.models.toReversed().map((model) => row(model, line, compared)));
  });
  return card("model-list", "Models", { wide: true, controls: [undo] }, live, none, scrolled, wrong, line, compared);
}

function liveModel({ model, model_set: set, model_file: file }) {
  if (!model) return "No model is in use.";
  if (file && SHIPPED.test(file)) return "In use: the model for the simulated scene that ships with actum.";
  if (file) return `In use: ${file}. This file is only read: what is put into use here replaces a copy of it.`;
  return `In use: model ${model.slice(0, SHORT)}${set ? `, trained on the set ${set}` : ""}.`;
}

function row(model, line, compared) {
  const { id, created, set, labels, people, samples, active, scores } = model;
  const name = id.slice(0, SHORT);
  const held = scores.accuracy_held_out;
  const texts = [dated(created), set || "–", labels.join(", "), people.join(", ") || "–", samples, held === undefined ? "–" : percent(held)];
  const cells = texts.map((text, i) => element("td", { "data-head": HEADS[i + 1] }, String(text)));
  const mark = active ? element("small", { class: "in-use" }, "in use") : null;
  const named = (verb) => ({ label: `${verb} model ${name}`, kind: "small" });
  const actions = active ? [] : [
    button("Use", () => attempt(line, () => trainer.ask("activate", { model: id }), `Model ${name} is in use.`), named("Use")),
    button("Compare", () => compare(id, line, compared), { label: `Compare model ${name} with the one in use`, kind: "small" }),
    button("Delete", () => removed(id, name, line), named("Delete")),
  ];
  return element("tr", { class: active ? "active" : "" }, element("th", { scope: "row" }, name, mark), ...cells,
    element("td", {}, element("div", { class: "buttons" }, ...actions)));
}

async function removed(id, name, line) {
  if (await confirmed(`Delete model ${name}?`, "Delete model")) await attempt(line, () => trainer.ask("delete_model", { model: id }), `Model ${name} deleted.`);
}

async function compare(id, line, compared) {
  const reply = await attempt(line, () => trainer.ask("compare", { model: id }));
  compared.hidden = !reply?.other;
  if (reply && !reply.other) say(line, "No model is in use, so there is nothing to compare this one with.", true);
  if (compared.hidden) return;
  const { model, other, added, missing } = reply;
  const facts = [
    ["Examples", model.samples, other.samples],
    ["People", model.people.join(", ") || "–", other.people.join(", ") || "–"],
    ["Accuracy, held out", ...[model, other].map(({ scores }) => (scores.accuracy_held_out === undefined ? "–" : percent(scores.accuracy_held_out)))],
    ["Actions of this one only", added.join(", ") || "–", missing.join(", ") || "–"],
  ];
  const head = ["", model.id.slice(0, SHORT), `${other.id.slice(0, SHORT)}, in use`].map((text) => element("th", { scope: "col" }, text));
  const rows = facts.map(([name, ...values]) => element("tr", {}, element("th", { scope: "row" }, name), ...values.map((value) => element("td", {}, String(value)))));
  compared.replaceChildren(element("h3", {}, "Comparison"), element("p", { class: "caption" }, reply.sentence),
    element("table", { class: "plain" }, element("caption", { class: "unseen" }, "Two models side by side"), element("thead", {}, element("tr", {}, ...head)), element("tbody", {}, ...rows)));
}
