// Objects in 3-D: a box each, and for a while an arrow along the way that an event says one was moved.

import * as THREE from "three";
import { theme } from "../colours.js";

const SIZE_M = 0.09;            // no message says how large an object is
const LABEL_M = 0.13;           // of its label, above its middle
const TOLD_MS = 4000;           // for how long an event's object stands out
const SHORTEST_M = 0.03;        // less is no movement to point at
const REMEMBERED_NS = 60e9;     // the longest segment

export class Things {
  constructor(world) {
    this.world = world;
    this.things = new Map();
    this.past = new Map();
    this.arrow = new THREE.ArrowHelper(new THREE.Vector3(0, 1, 0), new THREE.Vector3(), 0.1, 0xffffff);
    this.arrow.visible = false;
    this.toldAt = -Infinity;
    world.add(this.arrow);
  }

  get moving() {
    return performance.now() - this.toldAt < TOLD_MS + 100;
  }

  paint() {
    for (const thing of this.things.values()) this.world.remove(thing);
    this.things.clear();
    this.arrow.setColor(theme("accent"));
  }

  show(objects, worldFromCamera) {
    for (const thing of this.things.values()) thing.visible = false;
    for (const object of objects) {
      const thing = this.thingOf(object);
      const turned = new THREE.Quaternion(...object.quaternion_xyzw);
      const inCamera = new THREE.Matrix4().compose(new THREE.Vector3(...object.position_m), turned, new THREE.Vector3(1, 1, 1));
      Object.assign(thing, { visible: true, seen: object.seen });
      thing.box.matrix.multiplyMatrices(worldFromCamera, inCamera);
      thing.box.children[0].material.opacity = object.seen ? 1 : 0.35;
    }
    this.worldFromCamera = worldFromCamera;
  }

  // What each is, [{text, at, faint}].
  get labels() {
    const shown = [...this.things].filter(([, { visible }]) => visible);
    return shown.map(([text, { box, seen }]) => {
      const at = new THREE.Vector3().setFromMatrixPosition(box.matrix);
      return { text, at: at.setY(at.y + LABEL_M), faint: !seen };
    });
  }

  thingOf({ id, name }) {
    const key = `${id} ${name}`;
    if (!this.things.has(key)) {
      const thing = new THREE.Group();
      const shape = new THREE.BoxGeometry(SIZE_M, SIZE_M, SIZE_M);
      const solid = new THREE.Mesh(shape, new THREE.MeshStandardMaterial({ color: theme("thing"), roughness: 0.7, transparent: true }));
      solid.add(new THREE.LineSegments(new THREE.EdgesGeometry(shape), new THREE.LineBasicMaterial({ color: theme("ink") })));
      thing.box = new THREE.Group().add(solid);
      thing.box.matrixAutoUpdate = false;
      thing.number = id;
      thing.add(thing.box);
      this.world.add(thing);
      this.things.set(key, thing);
    }
    return this.things.get(key);
  }

  remember(objects, stamp) {
    for (const { id, position_m: position } of objects) {
      if (!this.past.has(id)) this.past.set(id, []);
      const places = this.past.get(id);
      places.push({ stamp, position });
      while (places[0].stamp < stamp - REMEMBERED_NS || places[0].stamp > stamp) places.shift();
    }
  }

  placeAt(id, stamp) {
    return (this.past.get(id) ?? []).findLast((place) => place.stamp <= stamp)?.position;
  }

  // Lets an event's object stand out, with an arrow from where it was to where it came to lie.
  acted({ object, start_ns: start, end_ns: end }) {
    this.told = object?.id;
    this.toldAt = performance.now();
    const [from, to] = object ? [this.placeAt(object.id, start), this.placeAt(object.id, end)] : [];
    this.way = from && to && [new THREE.Vector3(...from), new THREE.Vector3(...to)];
    this.point();
  }

  point() {
    const [from, to] = this.way?.map((place) => place.clone().applyMatrix4(this.worldFromCamera)) ?? [];
    const length = from?.distanceTo(to) ?? 0;
    this.arrow.visible = length > SHORTEST_M;
    if (!this.arrow.visible) return;
    this.arrow.position.copy(from);
    this.arrow.setDirection(to.clone().sub(from).normalize());
    this.arrow.setLength(length, Math.min(0.08, length / 2), 0.05);
  }

  fade() {
    const told = performance.now() - this.toldAt < TOLD_MS;
    if (!told) this.arrow.visible = false;
    else this.point();
    for (const thing of this.things.values()) {
      const stands = told && thing.number === this.told;
      thing.box.children[0].material.color.set(stands ? theme("accent") : theme("thing"));
      thing.box.children[0].scale.setScalar(stands ? 1.25 : 1);
    }
  }
}
