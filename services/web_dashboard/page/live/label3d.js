// A text that always faces the viewer.

import * as THREE from "three";
import { theme } from "../colours.js";

const HEIGHT_M = 0.075;
const FONT_PX = 44;
const PAD_PX = 18;

export function label(text) {
  const canvas = document.createElement("canvas");
  const context = canvas.getContext("2d");
  const font = `600 ${FONT_PX}px system-ui, sans-serif`;
  context.font = font;
  canvas.width = Math.ceil(context.measureText(text).width) + 2 * PAD_PX;
  canvas.height = FONT_PX + PAD_PX;
  context.font = font;
  context.fillStyle = theme("card");
  context.globalAlpha = 0.86;
  context.beginPath();
  context.roundRect(0, 0, canvas.width, canvas.height, 14);
  context.fill();
  context.globalAlpha = 1;
  context.fillStyle = theme("ink");
  context.textBaseline = "middle";
  context.fillText(text, PAD_PX, canvas.height / 2 + 2);
  const texture = new THREE.CanvasTexture(canvas);
  texture.colorSpace = THREE.SRGBColorSpace;
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({ map: texture, depthTest: false, transparent: true }));
  sprite.scale.set((HEIGHT_M * canvas.width) / canvas.height, HEIGHT_M, 1);
  sprite.renderOrder = 2;
  return sprite;
}
