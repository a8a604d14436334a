// Testing what a set teaches: every part of it is answered by a model that was trained on the rest.

import { card, element, percent } from "../elements.js";
import { counted, field } from "../asking.js";
import { JobView } from "../jobs.js";
import { setChoice } from "../setchoice.js";
import { trainer } from "../trainer.js";
import { advice } from "./advice.js";
import { confusionTable } from "./confusion.js";

export function testing() {
  const results = element("div", { class: "results" });
  const sentences = advice();
  const job = new JobView(["evaluate"], ({ result, set }) => result && show(results, sentences, result, set));
  const forget = () => {
    results.replaceChildren();
    sentences.tell();
    job.quiet();
  };
  trainer.onChoice(forget);
  const submitted = (event) => {
    event.preventDefault();
    forget();
    job.start("evaluate", { set: trainer.set?.name ?? "" });
  };
  const form = element("form", { class: "row", on: { submit: submitted } }, field("Set to test", setChoice()), element("button", { class: "primary" }, "Test"));
  const about = element("p", { class: "caption" }, "Trains on all people but one and tests on that person, for each person in turn. If one person alone shows an action, a third of the examples is left out instead.");
  return card("testing", "Test", {}, form, about, job.element, results, sentences.element);
}

function show(results, sentences, result, set) {
  const { by, accuracy, n, labels, confusion, false_alarms_per_min: falseAlarms, found } = result;
  const facts = [
    [percent(accuracy), `of ${counted(n, "example")} recognised, each ${by === "people" ? "person" : "third"} left out of the training in turn`],
    falseAlarms === null ? ["–", "false alarms a minute (unknown: the set has no background)"] : [falseAlarms.toFixed(1), "false alarms a minute"],
    ...(found ? [[percent(found.recall), "of the actions found without marks"]] : []),
  ];
  const numbers = facts.map(([value, text]) => element("li", {}, element("strong", {}, value), element("span", {}, text)));
  results.replaceChildren(element("ul", { class: "facts", "aria-label": `Results of ${set}` }, ...numbers), confusionTable(labels, confusion));
  sentences.tell(result.advice);
}
