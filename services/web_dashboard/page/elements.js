// Building the page's elements. Text is set as text, so that what services say is never read as markup.

import { dark } from "./colours.js";

export function element(tag, properties = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name === "on") for (const [type, listener] of Object.entries(value)) made.addEventListener(type, listener);
    else if (name === "style") for (const [key, text] of Object.entries(value)) made.style.setProperty(key, text);
    else if (name in made && typeof value !== "string") made[name] = value;
    else made.setAttribute(name, value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

// A part of a panel: a heading, controls beside it, and what stands below.
export function card(id, title, { controls = [], wide = false } = {}, ...children) {
  const heading = element("h2", { id: `${id}-title` }, title);
  return element("section", { id, class: wide ? "card wide" : "card", "aria-labelledby": `${id}-title` },
    element("div", { class: "card-head" }, heading, ...controls), ...children);
}

const redraws = new WeakMap();  // by canvas: a listener of each would keep those that have left the page

dark.addEventListener("change", () => document.querySelectorAll("canvas").forEach((canvas) => redraws.get(canvas)?.()));

// A canvas that fills its box; `draw(context, width, height)` is called with its size in CSS pixels. Returns redraw().
export function drawn(canvas, draw) {
  const context = canvas.getContext("2d");
  const redraw = () => {
    const { clientWidth: width, clientHeight: height } = canvas;
    const ratio = Math.min(devicePixelRatio, 2);
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
    }
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    if (width && height) draw(context, width, height);
  };
  new ResizeObserver(redraw).observe(canvas);
  redraws.set(canvas, redraw);
  return redraw;
}

export function percent(share) {
  return `${Math.round(100 * share)} %`;
}

export function seconds(value) {
  return value < 10 ? `${value.toFixed(1)} s` : `${Math.round(value)} s`;
}
