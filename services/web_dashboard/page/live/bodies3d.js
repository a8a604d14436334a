// People in 3-D: a stick figure each, and a trail behind each hand of the one who is shown.

import * as THREE from "three";
import { theme } from "../colours.js";
import { JOINT, sideOf } from "../body.js";
import { Figures } from "./figures3d.js";

const TRAIL = 24;               // points of a hand's trail, the last 0.8 s at 30 Hz
const LABEL_M = 0.24;           // of its label, above the head

export class Bodies {
  constructor(world) {
    this.figures = new Figures(world, new THREE.MeshStandardMaterial({ roughness: 0.55 }));
    this.trails = [JOINT.leftHand, JOINT.rightHand].map((joint) => new Trail(world, joint));
    this.bodies = [];
  }

  paint() {
    this.figures.paint();
    for (const trail of this.trails) trail.paint();
  }

  // bodies: [{agent, points}], fifteen points each (m, world), null where one is missing.
  show(bodies, shown) {
    this.figures.show(bodies.map(({ points }) => points));
    const main = bodies.find(({ agent }) => agent === shown)?.points;
    for (const trail of this.trails) trail.add(main?.[trail.joint]);
    this.bodies = bodies;
  }

  // Which person each is, [{text, at}], where there are several.
  get labels() {
    const seen = this.bodies.filter(({ points }) => points[JOINT.head]);
    if (seen.length < 2) return [];
    return seen.map(({ agent, points }) => ({ text: `person ${agent}`, at: points[JOINT.head].clone().setY(points[JOINT.head].y + LABEL_M) }));
  }
}

class Trail {
  constructor(world, joint) {
    this.joint = joint;
    this.points = [];
    this.positions = new THREE.BufferAttribute(new Float32Array(TRAIL * 3), 3);
    const colours = new Float32Array(TRAIL * 4);
    this.colours = new THREE.BufferAttribute(colours, 4);
    const geometry = new THREE.BufferGeometry().setAttribute("position", this.positions).setAttribute("color", this.colours);
    this.line = new THREE.Line(geometry, new THREE.LineBasicMaterial({ vertexColors: true, transparent: true }));
    this.line.frustumCulled = false;
    world.add(this.line);
  }

  paint() {
    const { r, g, b } = new THREE.Color(theme(sideOf(this.joint)));
    for (let i = 0; i < TRAIL; i++) this.colours.setXYZW(i, r, g, b, 1 - i / TRAIL);
    this.colours.needsUpdate = true;
  }

  add(point) {
    if (point) this.points.unshift(point);
    else this.points = [];
    this.points.length = Math.min(this.points.length, TRAIL);
    this.points.forEach(({ x, y, z }, i) => this.positions.setXYZ(i, x, y, z));
    this.positions.needsUpdate = true;
    this.line.geometry.setDrawRange(0, this.points.length);
  }
}
