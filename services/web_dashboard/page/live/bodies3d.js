// Skeletons in 3-D: a cylinder for each bone, a ball for each joint, a trail behind each hand.

import * as THREE from "three";
import { theme } from "../colours.js";
import { BONES, JOINT, sideOf, sideOfBone } from "../body.js";

const MOST = 8;                 // people drawn; a sensor sees six
const TRAIL = 24;               // points of a hand's trail, the last 0.8 s at 30 Hz
const BONE_M = 0.026;           // radii
const JOINT_M = 0.036;
const HEAD_M = 0.1;
const LABEL_M = 0.24;           // of its label, above the head
const UP = new THREE.Vector3(0, 1, 0);
const NOWHERE = new THREE.Matrix4().makeScale(0, 0, 0);

export class Bodies {
  constructor(world) {
    this.bones = instanced(new THREE.CylinderGeometry(1, 1, 1, 14), MOST * BONES.length);
    this.joints = instanced(new THREE.SphereGeometry(1, 20, 14), MOST * 15);
    this.trails = [JOINT.leftHand, JOINT.rightHand].map((joint) => new Trail(world, joint));
    this.bodies = [];
    world.add(this.bones, this.joints);
  }

  paint() {
    for (let i = 0; i < MOST * BONES.length; i++) this.bones.setColorAt(i, new THREE.Color(theme(sideOfBone(BONES[i % BONES.length]))));
    for (let i = 0; i < MOST * 15; i++) this.joints.setColorAt(i, new THREE.Color(theme(sideOf(i % 15))));
    this.bones.instanceColor.needsUpdate = this.joints.instanceColor.needsUpdate = true;
    for (const trail of this.trails) trail.paint();
  }

  // bodies: [{agent, points}], fifteen points each (m, world), null where one is missing.
  show(bodies, shown) {
    for (let body = 0; body < MOST; body++) {
      const points = bodies[body]?.points ?? [];
      BONES.forEach(([from, to], bone) => this.bones.setMatrixAt(body * BONES.length + bone, between(points[from], points[to])));
      for (let joint = 0; joint < 15; joint++) this.joints.setMatrixAt(body * 15 + joint, ball(points[joint], joint));
    }
    this.bones.instanceMatrix.needsUpdate = this.joints.instanceMatrix.needsUpdate = true;
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

function instanced(geometry, count) {
  const mesh = new THREE.InstancedMesh(geometry, new THREE.MeshStandardMaterial({ roughness: 0.55 }), count);
  mesh.frustumCulled = false;
  return mesh;
}

function between(from, to) {
  if (!from || !to) return NOWHERE;
  const along = to.clone().sub(from);
  const length = along.length();
  if (length < 1e-6) return NOWHERE;
  const turned = new THREE.Quaternion().setFromUnitVectors(UP, along.divideScalar(length));
  return new THREE.Matrix4().compose(from.clone().lerp(to, 0.5), turned, new THREE.Vector3(BONE_M, length, BONE_M));
}

function ball(point, joint) {
  if (!point) return NOWHERE;
  const radius = joint === JOINT.head ? HEAD_M : JOINT_M;
  return new THREE.Matrix4().makeScale(radius, radius * (joint === JOINT.head ? 1.2 : 1), radius).setPosition(point);
}
