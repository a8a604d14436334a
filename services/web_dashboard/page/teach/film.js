// Films of examples: little skeletons that repeat what was done, each with its way over the map of postures.

import { drawFigure, fromInFront } from "../body.js";
import { theme } from "../colours.js";
import { drawn } from "../elements.js";
import { guarded } from "../guarded.js";

const REST_MS = 500;      // between the end and the next start
const playing = new Set();
let wanted = !matchMedia("(prefers-reduced-motion: reduce)").matches;

const stepOf = guarded((film, nowMs) => film.step(nowMs));

function step(nowMs) {
  for (const film of playing) stepOf(film, nowMs);
  if (playing.size) requestAnimationFrame(step);
}

export function arePlaying() {
  return wanted;
}

// Plays or halts all films; those that halt show the middle of what is done.
export function play(whether) {
  wanted = whether;
  for (const film of playing) film.redraw();
}

// A film on a canvas: {stamps_ns, joints}. `at(ns)` halts it at a moment; null plays on.
export class Film {
  constructor(canvas) {
    Object.assign(this, { canvas, film: null, shown: -1, halted: null, visible: false });
    this.redraw = drawn(canvas, (context, width, height) => this.draw(context, width, height));
    new IntersectionObserver(([{ isIntersecting }]) => (this.visible = isIntersecting)).observe(canvas);
    playing.add(this);
    if (playing.size === 1) requestAnimationFrame(step);
  }

  show(film) {
    Object.assign(this, { film, began: performance.now() });
    this.redraw();
  }

  at(stamp) {
    this.halted = stamp;
    this.redraw();
  }

  step(nowMs) {
    if (!this.canvas.isConnected) return playing.delete(this);
    if (this.film && this.visible && this.picture(nowMs) !== this.shown) this.redraw();
  }

  picture(nowMs) {
    const { stamps_ns: stamps } = this.film;
    const length = (stamps.at(-1) - stamps[0]) / 1e6;
    if (this.halted === null && !wanted) return Math.floor(stamps.length / 2);
    const sinceMs = this.halted === null ? (nowMs - this.began) % (length + REST_MS) : (this.halted - stamps[0]) / 1e6;
    const next = stamps.findIndex((stamp) => (stamp - stamps[0]) / 1e6 > sinceMs);
    return next < 0 ? stamps.length - 1 : Math.max(next - 1, 0);
  }

  draw(context, width, height) {
    if (!this.film) return;
    this.shown = this.picture(performance.now());
    const size = Math.min(1.3 * width, height);  // arms reach less far than a body is high
    drawFigure(context, fromInFront(this.film.joints[this.shown], width / 2, height / 2, size), { width: Math.max(size / 40, 2) });
  }
}

// Draws a way over the map of postures, from the ring to the dot: rows and columns.
export function drawTrace(context, width, height, trace, map, colour) {
  const size = Math.min(width / map.columns, height / map.rows);
  const [left, top] = [(width - map.columns * size) / 2, (height - map.rows * size) / 2];
  const points = trace.map(([row, column]) => [left + (column + 0.5) * size, top + (row + 0.5) * size]);
  context.fillStyle = theme("grid-strong");
  for (let unit = 0; unit < map.rows * map.columns; unit++) {
    const [x, y] = [left + ((unit % map.columns) + 0.5) * size, top + (Math.floor(unit / map.columns) + 0.5) * size];
    context.fillRect(x - 0.75, y - 0.75, 1.5, 1.5);
  }
  context.strokeStyle = context.fillStyle = colour;
  context.lineWidth = 2;
  context.lineJoin = "round";
  context.beginPath();
  points.forEach(([x, y], i) => (i ? context.lineTo(x, y) : context.moveTo(x, y)));
  context.stroke();
  ring(context, points[0], false);
  ring(context, points.at(-1), true);
}

function ring(context, [x, y], full) {
  context.beginPath();
  context.arc(x, y, 3.5, 0, 2 * Math.PI);
  if (full) context.fill();
  else context.stroke();
}
