// The model's maps: postures as little bodies with the way of what goes on over them, and actions by their colours.

import { drawFigure, fromInFront } from "../body.js";
import { colourOf, learn, theme } from "../colours.js";
import { card, drawn, element } from "../elements.js";
import { link } from "../link.js";
import { isShown, newestPosture, shownAgent } from "./people.js";

const ASK_MS = 4000;       // interval of asking for the maps until there are some
const WAY = 45;            // units of the running trace: the last seconds
const NEWEST = 0.4;        // share of the newest posture in the smoothed one, as the classifier smooths, too
const BODY_PX = 44;        // smaller bodies cannot be told apart: where units are closer, only every second is drawn
const KEPT_MS = 5000;      // for how long the trace of an answer stays

export function maps() {
  const canvases = {
    postures: element("canvas", { role: "img", "aria-label": "Map of postures with the trace of what is done" }),
    actions: element("canvas", { role: "img", "aria-label": "Map of actions, coloured by action" }),
  };
  const captions = { postures: element("p", { class: "caption" }), actions: element("p", { class: "caption legend" }) };
  const traces = element("button", { type: "button", class: "small", hidden: true }, "Show the traces of answers");
  new Maps(canvases, captions, traces);
  return [
    card("postures", "Map of postures", { controls: [traces] }, element("div", { class: "map" }, canvases.postures), captions.postures),
    card("actions", "Map of actions", {}, element("div", { class: "map" }, canvases.actions), captions.actions),
  ];
}

class Maps {
  constructor(canvases, captions, traces) {
    Object.assign(this, { captions, traces, running: null, model: null, without: undefined, postures: null, actions: null, way: [], told: null, smooth: null, answer: null });
    this.drawPostures = drawn(canvases.postures, (context, width, height) => this.draw(context, width, height, this.postures, "postures"));
    this.drawActions = drawn(canvases.actions, (context, width, height) => this.draw(context, width, height, this.actions, "actions"));
    link.on("frame", () => this.follow());
    link.on("action", (action) => action.final && isShown(action.agent) && this.take(action));
    link.on("info", ({ model }) => {
      if (!model) return;
      this.running = model;
      if (model !== this.model) this.ask();
    });
    link.on("state", () => !this.postures && this.ask());
    traces.addEventListener("click", () => this.askForTraces());
    setInterval(() => !this.postures && this.ask(), ASK_MS);
  }

  // Asks for the maps, of a model that the classifier refuses to describe only once.
  async ask() {
    if (this.asking || !link.state.router || this.running === this.without) return;
    this.asking = true;
    const { running } = this;
    const asked = link.ask("som_classifier", "maps").catch(({ message, refused }) => ({ message, refused }));
    const { model = null, posture_map: postures, action_map: actions, message = "the classifier has no model", refused } = await asked;
    this.asking = false;
    this.without = refused ? running : undefined;
    if (postures || refused) this.use(model, postures ?? null, actions ?? null);
    if (!postures) this.captions.postures.textContent = this.captions.actions.textContent = refused ? message : `The maps cannot be shown: ${message}`;
  }

  async askForTraces() {
    try {
      await link.ask("som_classifier", "set_parameters", { values: { publish_maps: true } });
      this.traces.hidden = true;
    } catch (error) {
      this.captions.postures.textContent = `The paths on the map cannot be shown: ${error.message}`;
    }
  }

  use(model, postures, actions) {
    Object.assign(this, { model, postures, actions, way: [], answer: null, backgrounds: {} });
    const labels = [...new Set(actions?.labels.filter(Boolean))].sort();
    learn(labels);
    this.captions.postures.textContent = "Each figure is the posture that a unit of the map stands for. The line is the path of the last seconds.";
    this.captions.actions.replaceChildren(...labels.map((label) =>
      element("span", { class: "key" }, element("i", { class: "swatch", style: { "--action": colourOf(label) } }), label)));
    this.drawPostures();
    this.drawActions();
  }

  // Adds the unit that is nearest to the shown person's newest posture.
  follow() {
    const posture = newestPosture(shownAgent());
    if (!this.postures?.bodies || !posture?.upright || posture.stamp_ns === this.told) return;
    this.told = posture.stamp_ns;
    this.smooth = smoothed(this.smooth, posture.upright);
    const unit = nearest(this.postures.bodies, this.smooth);
    if (unit !== null && unit !== this.way.at(-1)) this.way.push(unit);
    if (this.way.length > WAY) this.way.shift();
    this.drawPostures();
  }

  // Takes the trace and the activity of an answer, where the classifier puts them.
  take({ valid, action, trace, maps: active }) {
    this.traces.hidden = Boolean(trace) || !valid;
    this.answer = { action, trace: trace && numbers(trace), active: active?.actions && numbers(active.actions), at: performance.now() };
    this.drawPostures();
    this.drawActions();
  }

  draw(context, width, height, map, name) {
    if (!map) return;
    const size = Math.min(width / map.columns, height / map.rows);
    const place = (row, column) => [(column + 0.5) * size + (width - map.columns * size) / 2, (row + 0.5) * size];
    context.drawImage(this.background(name, map, size, width, height, place), 0, 0, width, height);
    const told = this.answer && performance.now() - this.answer.at < KEPT_MS;
    if (name === "actions") return this.answer?.active && drawActivity(context, this.answer, map, size, place);
    const way = this.way.map((unit) => place(Math.floor(unit / map.columns), unit % map.columns));
    if (told && this.answer.trace) drawWay(context, pairs(this.answer.trace).map(([row, column]) => place(row, column)), colourOf(this.answer.action), 3);
    else drawWay(context, way, theme("accent"), 2.5);
    if (way.length) drawUnit(context, way.at(-1), map.bodies[this.way.at(-1)], size);
  }

  // Draws what does not move only once for each size and theme.
  background(name, map, size, width, height, place) {
    const key = `${width} ${height} ${devicePixelRatio} ${theme("card")}`;
    if (this.backgrounds[name]?.key === key) return this.backgrounds[name].canvas;
    const ratio = Math.min(devicePixelRatio, 2);
    const canvas = new OffscreenCanvas(width * ratio, height * ratio);
    const context = canvas.getContext("2d");
    context.scale(ratio, ratio);
    const step = name === "postures" ? Math.max(Math.round(BODY_PX / size), 1) : 1;
    for (let row = 0; row + step <= map.rows; row += step) {
      for (let column = 0; column + step <= map.columns; column += step) {
        const [x, y] = place(row + (step - 1) / 2, column + (step - 1) / 2);
        const unit = (row + (step >> 1)) * map.columns + column + (step >> 1);
        if (name === "postures") drawBody(context, map.bodies?.[unit], x, y, size * step);
        else drawCell(context, map.labels[unit], x, y, size);
      }
    }
    this.backgrounds[name] = { key, canvas };
    return canvas;
  }
}

function drawBody(context, body, x, y, size) {
  context.globalAlpha = 0.8;
  if (body) drawFigure(context, fromInFront(body, x, y, size * 1.15), { width: Math.max(size / 18, 1.2) });
  else drawFigure(context, [[x, y]], { width: size / 20 });
  context.globalAlpha = 1;
}

function drawCell(context, label, x, y, size) {
  context.globalAlpha = label ? 0.32 : 0.06;
  context.fillStyle = colourOf(label);
  context.beginPath();
  context.roundRect(x - size * 0.46, y - size * 0.46, size * 0.92, size * 0.92, size * 0.18);
  context.fill();
  context.globalAlpha = 1;
}

function drawActivity(context, { active, action }, map, size, place) {
  const winner = active.indexOf(Math.max(...active));
  for (let unit = 0; unit < active.length; unit++) {
    if (active[unit] < 0.03) continue;
    const [x, y] = place(Math.floor(unit / map.columns), unit % map.columns);
    context.fillStyle = colourOf(map.labels[unit]);
    context.beginPath();
    context.arc(x, y, Math.max(size * 0.42 * Math.sqrt(active[unit]), 1), 0, 2 * Math.PI);
    context.fill();
  }
  const [x, y] = place(Math.floor(winner / map.columns), winner % map.columns);
  context.strokeStyle = theme("ink");
  context.lineWidth = 2;
  context.beginPath();
  context.arc(x, y, Math.max(size * 0.7, 7), 0, 2 * Math.PI);
  context.stroke();
  context.font = "600 14px system-ui, sans-serif";
  context.fillStyle = theme("ink");
  context.textAlign = x > context.canvas.clientWidth / 2 ? "right" : "left";
  context.textBaseline = "middle";
  if (action) context.fillText(action, x + (context.textAlign === "right" ? -1 : 1) * Math.max(size, 12), y);
}

function drawWay(context, points, colour, width) {
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.lineJoin = context.lineCap = "round";
  for (let i = 1; i < points.length; i++) {
    context.globalAlpha = 0.15 + (0.85 * i) / points.length;
    context.beginPath();
    context.moveTo(...points[i - 1]);
    context.lineTo(...points[i]);
    context.stroke();
  }
  context.globalAlpha = 1;
}

// Draws the unit that wins now, larger than the others, and whole also at the edge.
function drawUnit(context, place, body, size) {
  const radius = Math.max(size * 1.1, 34);
  const { clientWidth: width, clientHeight: height } = context.canvas;
  const [x, y] = [[place[0], width], [place[1], height]].map(([at, most]) => Math.min(Math.max(at, radius + 2), most - radius - 2));
  context.fillStyle = theme("card");
  context.strokeStyle = theme("accent");
  context.lineWidth = 2.5;
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
  context.stroke();
  if (body) drawFigure(context, fromInFront(body, x, y, radius * 1.75), { width: 2 });
}

function smoothed(before, joints) {
  return joints.map((joint, i) => {
    const old = before?.[i];
    return joint && old ? joint.map((value, axis) => old[axis] + NEWEST * (value - old[axis])) : joint;
  });
}

// Returns the index of the body that is nearest to upright joints, by the joints that both have; null without any.
function nearest(bodies, joints) {
  let [best, least] = [null, Infinity];
  bodies.forEach((body, unit) => {
    let [sum, known] = [0, 0];
    for (let joint = 0; body && joint < joints.length; joint++) {
      const [one, other] = [body[joint], joints[joint]];
      if (!one || !other) continue;
      known++;
      sum += (one[0] - other[0]) ** 2 + (one[1] - other[1]) ** 2 + (one[2] - other[2]) ** 2;
    }
    if (known && sum / known < least) [best, least] = [unit, sum / known];
  });
  return best;
}

// Reads a tensor of 32-bit numbers.
function numbers({ data }) {
  const bytes = Uint8Array.from(atob(data.replaceAll("-", "+").replaceAll("_", "/")), (c) => c.charCodeAt(0));
  return new Float32Array(bytes.buffer);
}

function pairs(values) {
  return Array.from({ length: values.length / 2 }, (_, i) => [values[2 * i], values[2 * i + 1]]);
}
