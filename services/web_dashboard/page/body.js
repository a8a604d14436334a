// The fifteen joints as a body: bones, sides, and stick figures in two dimensions.

import { theme } from "./colours.js";

export const JOINT = Object.freeze({
  head: 0, neck: 1, torso: 2, leftShoulder: 3, leftElbow: 4, leftHand: 5, rightShoulder: 6, rightElbow: 7, rightHand: 8,
  leftHip: 9, leftKnee: 10, leftFoot: 11, rightHip: 12, rightKnee: 13, rightFoot: 14,
});
export const BONES = [
  [0, 1], [1, 2], [1, 3], [3, 4], [4, 5], [1, 6], [6, 7], [7, 8], [2, 9], [9, 10], [10, 11], [2, 12], [12, 13], [13, 14], [9, 12],
];

// left, right or middle: the person's own side of a joint.
export function sideOf(joint) {
  if ([3, 4, 5, 9, 10, 11].includes(joint)) return "left";
  return [6, 7, 8, 12, 13, 14].includes(joint) ? "right" : "middle";
}

export function sideOfBone([from, to]) {
  return sideOf(from) === sideOf(to) || sideOf(from) === "middle" ? sideOf(to) : "middle";
}

// Draws a body whose joints are points [x, y] in pixels, null where one is missing.
export function drawFigure(context, points, { width = 2, colour = null, hollow = false } = {}) {
  context.lineCap = "round";
  context.lineWidth = width;
  for (const bone of BONES) {
    const [from, to] = bone.map((joint) => points[joint]);
    if (!from || !to) continue;
    context.strokeStyle = colour ?? theme(sideOfBone(bone));
    context.beginPath();
    context.moveTo(...from);
    context.lineTo(...to);
    context.stroke();
  }
  const [top, neck] = points;
  if (!top) return;
  const radius = neck ? Math.max(Math.hypot(top[0] - neck[0], top[1] - neck[1]) * 0.45, width) : 3 * width;
  context.fillStyle = colour ?? theme("middle");
  context.beginPath();
  context.arc(...top, radius, 0, 2 * Math.PI);
  if (!hollow) return context.fill();
  context.strokeStyle = context.fillStyle;
  context.stroke();
}

// Projects upright joints (m; x left, y up) from in front onto a square of a size in pixels around a middle.
export function fromInFront(joints, x, y, size) {
  const scale = size / 2;  // a standard body is 1.7 m high, and its middle 0.2 m below the torso
  return joints.map((joint) => joint && [x + joint[0] * scale, y - (joint[1] + 0.2) * scale]);
}
