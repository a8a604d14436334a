// What is expected, faint: people as they will be, and dashed lines along the ways of hands and objects.

import * as THREE from "three";
import { theme } from "../colours.js";
import { Figures } from "./figures3d.js";

const OPACITY = 0.25;
const MOST_WAYS = 32;
const DASH_M = 0.03;
const GAP_M = 0.02;
const END_M = 0.025;        // radius of the ball at the end of a way

export class Ghosts {
  constructor(world) {
    const faint = { transparent: true, opacity: OPACITY, depthWrite: false };
    this.figures = new Figures(world, new THREE.MeshStandardMaterial({ roughness: 0.55, ...faint }));
    this.positions = new THREE.BufferAttribute(new Float32Array(MOST_WAYS * 6), 3);
    const dashed = new THREE.LineDashedMaterial({ dashSize: DASH_M, gapSize: GAP_M });
    this.lines = new THREE.LineSegments(new THREE.BufferGeometry().setAttribute("position", this.positions), dashed);
    this.ends = new THREE.InstancedMesh(new THREE.SphereGeometry(END_M, 16, 12), new THREE.MeshBasicMaterial({ ...faint, opacity: 0.5 }), MOST_WAYS);
    this.lines.frustumCulled = this.ends.frustumCulled = false;
    world.add(this.lines, this.ends);
  }

  paint() {
    this.figures.paint();
    for (const { material } of [this.lines, this.ends]) material.color.set(theme("accent"));
  }

  // bodies: fifteen joints each, null where one is missing; ways: [from, to]; inWorld maps them to points of the world.
  show({ bodies, ways }, inWorld) {
    this.figures.show(bodies.map((joints) => joints.map((joint) => joint && inWorld(joint))));
    const drawn = ways.slice(0, MOST_WAYS).map((way) => way.map(inWorld));
    drawn.flat().forEach(({ x, y, z }, i) => this.positions.setXYZ(i, x, y, z));
    drawn.forEach(([, to], i) => this.ends.setMatrixAt(i, new THREE.Matrix4().setPosition(to)));
    this.positions.needsUpdate = this.ends.instanceMatrix.needsUpdate = true;
    this.lines.geometry.setDrawRange(0, 2 * drawn.length);
    this.ends.count = drawn.length;
    this.lines.computeLineDistances();
  }
}
