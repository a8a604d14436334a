// Stick figures in 3-D: a cylinder for each bone, a ball for each joint.

import * as THREE from "three";
import { theme } from "../colours.js";
import { BONES, JOINT, sideOf, sideOfBone } from "../body.js";

const MOST = 8;                 // people drawn; a sensor sees six
const BONE_M = 0.026;           // radii
const JOINT_M = 0.036;
const HEAD_M = 0.1;
const UP = new THREE.Vector3(0, 1, 0);
const NOWHERE = new THREE.Matrix4().makeScale(0, 0, 0);

export class Figures {
  constructor(world, material) {
    this.bones = instanced(new THREE.CylinderGeometry(1, 1, 1, 14), material, MOST * BONES.length);
    this.joints = instanced(new THREE.SphereGeometry(1, 20, 14), material, MOST * 15);
    world.add(this.bones, this.joints);
  }

  paint() {
    for (let i = 0; i < MOST * BONES.length; i++) this.bones.setColorAt(i, new THREE.Color(theme(sideOfBone(BONES[i % BONES.length]))));
    for (let i = 0; i < MOST * 15; i++) this.joints.setColorAt(i, new THREE.Color(theme(sideOf(i % 15))));
    this.bones.instanceColor.needsUpdate = this.joints.instanceColor.needsUpdate = true;
  }

  // figures: fifteen points each (m, world), null where one is missing.
  show(figures) {
    for (let number = 0; number < MOST; number++) {
      const points = figures[number] ?? [];
      BONES.forEach(([from, to], bone) => this.bones.setMatrixAt(number * BONES.length + bone, between(points[from], points[to])));
      for (let joint = 0; joint < 15; joint++) this.joints.setMatrixAt(number * 15 + joint, ball(points[joint], joint));
    }
    this.bones.instanceMatrix.needsUpdate = this.joints.instanceMatrix.needsUpdate = true;
  }
}

function instanced(geometry, material, count) {
  const mesh = new THREE.InstancedMesh(geometry, material, count);
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
