// The colour image, with the joints and objects of its own instant drawn where they are seen in it.

import { drawFigure } from "../body.js";
import { card, drawn, element } from "../elements.js";
import { link } from "../link.js";
import { Labels } from "./labels.js";
import { Moments } from "./moments.js";

const HELD_MS = 400;      // how long an image waits for what is seen in it: longer, and the picture would lag visibly
const MOST_HELD = 16;     // images, half a second at 30 Hz
const GONE_MS = 3000;

export function picture() {
  const canvas = element("canvas", { role: "img", "aria-label": "The camera's picture with joints and objects" });
  const none = element("p", { class: "none" });
  const overlay = element("input", { type: "checkbox", checked: true });
  const control = element("label", { class: "check" }, overlay, "Overlay");
  const box = element("div", { class: "picture" }, canvas, none);
  new Picture(box, canvas, none, overlay);
  return card("picture", "Picture", { controls: [control] }, box);
}

class Picture {
  constructor(box, canvas, none, overlay) {
    Object.assign(this, { canvas, none, overlay, labels: new Labels(box), held: [], busy: false, isDecoded: true });
    this.streams = [new Moments("skeleton"), new Moments("objects")];
    this.redraw = drawn(canvas, (context, width, height) => this.draw(context, width, height));
    link.on("each image/color", (image) => this.hold(image));
    link.on("frame", () => this.look());
    setInterval(() => this.look(), HELD_MS / 4);
    overlay.addEventListener("change", this.redraw);
    setInterval(() => this.tellAbsence(), 1000);
    this.tellAbsence();
  }

  hold(image) {
    this.held.push({ image, cameAt: performance.now() });
    if (this.held.length > MOST_HELD) this.held.shift();
  }

  // Shows the newest image of which all that is seen in it has come; one that has waited for too long without.
  look() {
    if (this.busy) return;
    const isDue = ({ image, cameAt }) => this.isComplete(image) || performance.now() - cameAt > HELD_MS;
    const due = this.held.findLastIndex(isDue);
    if (due >= 0) this.take(this.held.splice(0, due + 1).at(-1).image);
  }

  isComplete({ stamp_ns: stamp }) {
    return this.streams.every((stream) => stream.isComplete(stamp));
  }

  async take(image) {
    this.busy = true;
    const bitmap = await bitmapOf(image).catch(() => null);
    Object.assign(this, { busy: false, isDecoded: bitmap !== null });
    this.tellAbsence();
    if (!bitmap) return;
    this.bitmap?.close();
    Object.assign(this, { bitmap, image });
    this.canvas.style.aspectRatio = `${image.width} / ${image.height}`;
    this.redraw();
  }

  tellAbsence() {
    const gone = link.silentMs("image/color") > GONE_MS;
    this.none.textContent = gone ? "No colour images are published." : "The picture cannot be decoded.";
    this.none.hidden = !gone && this.isDecoded;
    this.canvas.hidden = !this.none.hidden;
    if (this.canvas.hidden) this.labels.show([]);
  }

  draw(context, width, height) {
    if (!this.bitmap) return;
    const { image } = this;
    const scale = Math.min(width / image.width, height / image.height);
    const corner = [(width - image.width * scale) / 2, (height - image.height * scale) / 2];
    context.drawImage(this.bitmap, ...corner, image.width * scale, image.height * scale);
    this.drawOver(context, projection(image, scale, corner));
  }

  drawOver(context, project) {
    const [skeleton, objects] = this.overlay.checked ? this.seenAt(this.image) : [];
    for (const { joints } of skeleton?.agents ?? []) {
      drawFigure(context, joints.map((joint) => joint && project(joint)), { width: 3.5, hollow: true });
    }
    const places = (objects?.objects ?? []).map((object) => ({ ...object, place: project(object.position_m) }));
    const { offsetLeft: left, offsetTop: top } = this.canvas;
    this.labels.show(places.filter(({ place }) => place).map(({ id, name, seen, place: [x, y] }) => (
      { text: `${id} ${name}`, x: left + x, y: top + y, faint: !seen })));
  }

  // The skeletons and the objects of an image's instant.
  seenAt({ stamp_ns: stamp }) {
    return this.streams.map((stream) => stream.at(stamp));
  }
}

async function bitmapOf({ format, width, height, data }) {
  if (format === "jpeg") return createImageBitmap(new Blob([data], { type: "image/jpeg" }));
  const pixels = new ImageData(width, height);
  for (let from = 0, to = 0; to < pixels.data.length; from += 3, to += 4) {
    pixels.data[to] = data[from + 2];
    pixels.data[to + 1] = data[from + 1];
    pixels.data[to + 2] = data[from];
    pixels.data[to + 3] = 255;
  }
  return createImageBitmap(pixels);
}

// Returns the function from a point of the skeletons' camera frame (m) to the canvas (px), null behind the camera.
function projection({ K, distortion, skeleton_from_image: transform }, scale, [left, top]) {
  const [k1 = 0, k2 = 0, p1 = 0, p2 = 0, k3 = 0] = distortion;
  const [r, t] = [(row, column) => transform[4 * row + column], [transform[3], transform[7], transform[11]]];
  return (point) => {
    const moved = point.map((value, axis) => value - t[axis]);
    const [x, y, z] = [0, 1, 2].map((axis) => moved.reduce((sum, value, row) => sum + r(row, axis) * value, 0));
    if (z <= 0.01) return null;
    const [u, v] = [x / z, y / z];
    const r2 = u * u + v * v;
    const radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    const seen = [u * radial + 2 * p1 * u * v + p2 * (r2 + 2 * u * u), v * radial + p1 * (r2 + 2 * v * v) + 2 * p2 * u * v];
    return [left + (K[0] * seen[0] + K[1] * seen[1] + K[2]) * scale, top + (K[4] * seen[1] + K[5]) * scale];
  };
}
