// The colour image, with joints and objects drawn where they are seen in it.

import { drawFigure } from "../body.js";
import { theme } from "../colours.js";
import { card, drawn, element } from "../elements.js";
import { link } from "../link.js";
import { newestSkeleton } from "./people.js";

const KEPT = 30;          // skeletons, a second: images come later than they
const GONE_MS = 3000;

export function picture() {
  const canvas = element("canvas", { role: "img", "aria-label": "The camera's picture with joints and objects" });
  const none = element("p", { class: "none" });
  const overlay = element("input", { type: "checkbox", checked: true });
  const control = element("label", { class: "check" }, overlay, "Overlay");
  new Picture(canvas, none, overlay);
  return card("picture", "Picture", { controls: [control] }, element("div", { class: "picture" }, canvas, none));
}

class Picture {
  constructor(canvas, none, overlay) {
    Object.assign(this, { canvas, none, overlay, skeletons: [], objects: [], busy: false, isDecoded: true });
    this.redraw = drawn(canvas, (context, width) => this.draw(context, width));
    link.on("skeleton", (skeleton) => {
      this.skeletons.unshift(skeleton);
      this.skeletons.length = Math.min(this.skeletons.length, KEPT);
    });
    link.on("objects", ({ objects }) => (this.objects = objects));
    link.on("image/color", (image) => this.take(image));
    overlay.addEventListener("change", this.redraw);
    setInterval(() => this.tellAbsence(), 1000);
    this.tellAbsence();
  }

  async take(image) {
    if (this.busy) return;
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
    this.none.textContent = gone ? "No colour images are put." : "The picture cannot be decoded.";
    this.none.hidden = !gone && this.isDecoded;
    this.canvas.hidden = !this.none.hidden;
  }

  draw(context, width) {
    if (!this.bitmap) return;
    const scale = width / this.image.width;
    context.drawImage(this.bitmap, 0, 0, width, this.image.height * scale);
    if (!this.overlay.checked) return;
    const project = projection(this.image, scale);
    const { agents } = this.skeletons.find(({ stamp_ns: stamp }) => stamp === this.image.stamp_ns) ?? newestSkeleton();
    for (const { joints } of agents) drawFigure(context, joints.map((joint) => joint && project(joint)), { width: 3.5, hollow: true });
    for (const object of this.objects) drawObject(context, object, project(object.position_m));
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
function projection({ K, distortion, skeleton_from_image: transform }, scale) {
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
    return [(K[0] * seen[0] + K[1] * seen[1] + K[2]) * scale, (K[4] * seen[1] + K[5]) * scale];
  };
}

function drawObject(context, { id, name, seen }, place) {
  if (!place) return;
  const text = `${id} ${name}`;
  context.font = "600 13px system-ui, sans-serif";
  const width = context.measureText(text).width + 12;
  context.globalAlpha = seen ? 0.92 : 0.55;
  context.fillStyle = theme("card");
  context.beginPath();
  context.roundRect(place[0] - width / 2, place[1] - 11, width, 22, 6);
  context.fill();
  context.fillStyle = theme("ink");
  context.textAlign = "center";
  context.textBaseline = "middle";
  context.fillText(text, ...place);
  context.globalAlpha = 1;
}
