// Testing what a set teaches: every part of it is answered by a model that was trained on the rest.

import { card, element, percent } from "../elements.js";
import { field } from "../asking.js";
import { JobView } from "../jobs.js";
import { setChoice } from "../setchoice.js";
import { trainer } from "../trainer.js";
import { advice } from "./advice.js";
import { confusionTable } from "./confusion.js";

export function testing() {
  const results = element("div", { class: "results" });
  const sentences = advice();
  const job = new JobView(["evaluate"], ({ result, set }) => result && show(results, sentences, result, set));
  const submitted = (event) => {
    event.preventDefault();
    results.replaceChildren();
    sentences.tell();
    job.start("evaluate", { set: trainer.set?.name ?? "" });
  };
  const form = element("form", { class: "row", on: { submit: submitted } }, field("Set to test", setChoice()), element("button", { class: "primary" }, "Test"));
  const about = element("p", { class: "caption" }, "Each person is left out in turn, or a third of the examples where there is one person: how well are they recognised by what the others taught?");
  return card("testing", "Test", {}, form, about, job.element, results, sentences.element);
}

function show(results, sentences, result, set) {
  const { by, accuracy, n, labels, confusion, false_alarms_per_min: falseAlarms, found } = result;
  const facts = [
    [percent(accuracy), `of ${n} examples right, ${by === "people" ? "of people who were left out" : "of examples that were left out"}`],
    falseAlarms === null ? ["–", "false alarms: no background to count them in"] : [falseAlarms.toFixed(1), "false alarms a minute"],
    ...(found ? [[percent(found.recall), "of all performances found without marks"]] : []),
  ];
  const numbers = facts.map(([value, text]) => element("li", {}, element("strong", {}, value), element("span", {}, text)));
  results.replaceChildren(element("ul", { class: "facts", "aria-label": `Results of ${set}` }, ...numbers), confusionTable(labels, confusion));
  sentences.tell(result.advice);
}
