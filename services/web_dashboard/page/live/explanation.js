// The reasons for an answer: its neurons, how familiar it was, the objects' distances, and the early answers before its end.

import { counted } from "../asking.js";
import { card, element, percent, seconds } from "../elements.js";
import { segmentOf } from "./answers.js";
import { Correcting } from "./correcting.js";
import { Bars } from "./neurons.js";

let view;
let chosen = null;

export function explanation() {
  const newer = element("button", { type: "button", class: "small", hidden: true, on: { click: () => follow() } }, "Show the newest answer");
  const body = element("div", { class: "explained", "aria-live": "off" }, element("p", { class: "caption" }, "Shows the reasons for the newest answer, or for the one that you press in the timeline."));
  const correcting = new Correcting(() => hold());
  view = { newer, body, correcting };
  return card("explanation", "Reasons for an answer", { controls: [newer] }, body, correcting.element);
}

// Explains one segment's answer until another is chosen.
export function explain(id) {
  if (!segmentOf(id)) return;
  chosen = id;
  view.newer.hidden = false;
  show(segmentOf(id));
  view.body.closest("section").scrollIntoView({ block: "nearest", behavior: "smooth" });
}

export function newest(segment) {
  if (chosen === null || chosen === segment.id) show(segment);
}

function hold() {
  chosen ??= view.correcting.segment?.id ?? null;
  view.newer.hidden = chosen === null;
}

function follow() {
  chosen = null;
  view.newer.hidden = true;
}

function show(segment) {
  const { event, action, held } = segment;
  const answer = event ?? action;
  view.correcting.show(segment);
  if (held) return showHeld(segment);
  if (!answer) return view.body.replaceChildren(element("p", {}, "This segment has no answer yet."));
  const bars = element("ul", { class: "bars", "aria-label": "Activity of each action's neuron in this answer" });
  if (answer.valid && Object.keys(answer.activations).length) new Bars(bars).show(answer.activations, answer.action);
  view.body.replaceChildren(
    element("p", { class: "sentence" }, answer.valid ? (event?.sentence ?? answer.action) : `No answer: ${answer.reason}`),
    described(facts(segment)),
    bars,
  );
}

function showHeld({ held, start, end }) {
  view.body.replaceChildren(
    element("p", { class: "sentence" }, `Not told: ${held.sentence}`),
    described([
      ["Segment", `${seconds((end - start) / 1e9)}, found by the classifier`],
      ["Familiarity", held.familiarity === null ? null : percent(held.familiarity)],
    ]),
  );
}

function described(facts) {
  return element("dl", {}, ...facts.filter(([, text]) => text).flatMap(([term, text]) => [element("dt", {}, term), element("dd", {}, text)]));
}

// The reasons, each as [what, in words]; those that are not known are empty.
function facts(segment) {
  const { event, action, start, end, early, marked, origin } = segment;
  const answer = event ?? action;
  return [
    ["Segment", `${seconds((end - start) / 1e9)}, ${marked ? `marked (${origin ?? "a program"})` : "found by the classifier"}`],
    ["Confidence", `${percent(answer.confidence)}${margin(answer.activations)}`],
    ["Familiarity", (answer.familiarity ?? null) === null ? null : `${percent(answer.familiarity)}${answer.unknown ? ", too low, so the action is unknown" : ""}`],
    ["Early answers", earlier(early, answer.action, start, end)],
    ["Hand", event?.hand ?? action?.part?.replace("_", " ")],
    ["Object", ofObject(event)],
    ["Distances", event && Object.entries(event.distances_m).map(([id, m]) => `object ${id}: ${m.toFixed(2)} m`).join(", ")],
    ["Pointing", event?.pointing && `${event.pointing.angle_deg.toFixed(0)}° off the arm${event.pointing.margin_deg === null ? "" : `, the next object ${event.pointing.margin_deg.toFixed(0)}° further`}`],
    ["Moved", event?.motion && `${event.result}${event.agrees === null ? "" : event.agrees ? ", as expected of this action" : ", not as expected of this action"}`],
    ["Why no object", event?.why],
    ["Based on", `${counted(answer.frames, "frame")}${answer.missed ? `, ${answer.missed} lost` : ""}${answer.missing_joints.length ? `; without ${answer.missing_joints.join(", ").replaceAll("_", " ")}` : ""}`],
  ];
}

function margin(activations) {
  const [first, second] = Object.entries(activations).sort(([, one], [, other]) => other - one);
  return second ? `; ${second[0]} is next, ${(first[1] - second[1]).toFixed(2)} behind` : "";
}

function earlier(early, label, start, end) {
  const first = early.findIndex((_, i) => early.slice(i).every((answer) => answer.label === label));
  if (first < 0) return early.length ? `another action was likelier until the end` : null;
  const after = (early[first].stamp - start) / 1e9;
  return `${label} from ${seconds(Math.max(after, 0))} after the start, ${percent(Math.min(Math.max((after * 1e9) / (end - start), 0), 1))} of the segment`;
}

function ofObject(event) {
  if (!event?.object) return null;
  const { name, id, distance_m: distance, taken_along: along, carried } = event.object;
  const other = event.candidates.filter((candidate) => candidate.id !== id).map((candidate) => `${candidate.name} ${candidate.id}`);
  return [
    `${name} ${id}, ${distance.toFixed(2)} m from the hand`,
    along && "moved along with the hand",
    carried && "hidden by the hand for a while",
    other.length && `equally likely: ${other.join(", ")}`,
  ].filter(Boolean).join("; ");
}
