// People and objects in 3-D, in the camera's frame or that of the shown person's body.

import * as THREE from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { counted } from "../asking.js";
import { dark, theme } from "../colours.js";
import { card, element } from "../elements.js";
import { guarded } from "../guarded.js";
import { link } from "../link.js";
import { isSensorStill } from "../waiting.js";
import { Bodies } from "./bodies3d.js";
import { expected, NOTHING } from "./expected.js";
import { Ghosts } from "./ghosts3d.js";
import { Labels } from "./labels.js";
import { Things } from "./things3d.js";
import { newestPosture, newestSkeleton, shownAgent } from "./people.js";
import { personChoice } from "./personchoice.js";

const FRAMES = { camera: "Camera", person: "Person" };
const TURN = Math.PI / 16;    // of one key press
const ZOOM = 1.15;
const GRID_M = 4;
const SQUARE_M = 0.25;
const STRAYS_M = 0.3;         // how far a person may walk from the middle before the view follows
const FOLLOWS = 0.04;         // share of the way that the view follows in one frame
const FLOOR_FOLLOWS = 0.05;   // share of a step of the lowest foot that the floor takes up in one frame
const LOOK_MS = 500;          // whether the sensor still sends frames
const SLOW_MS = 100;          // between two pictures where the processor draws them: it has other things to do
const UP = new THREE.Vector3(0, 1, 0);

export function scene() {
  const counts = element("p", { class: "counts" });
  const box = element("div", {
    class: "scene", tabindex: "0", role: "group",
    "aria-label": "3-D view of people and objects. Arrow keys turn it, plus and minus zoom, 0 resets it.",
  });
  const frames = element("select", { "aria-label": "Frame of the 3-D view" },
    ...Object.entries(FRAMES).map(([value, name]) => element("option", { value }, `${name} frame`)));
  const ahead = element("input", { type: "checkbox", checked: true });
  const controls = [element("label", { class: "check" }, ahead, "Half a second ahead"), personChoice(), frames];
  const view = card("scene", "In 3-D", { controls }, box, counts);
  try {
    new Stage(box, frames, ahead, counts);
  } catch (error) {
    box.append(element("p", { class: "none" }, `This browser cannot draw in 3-D (${error.message}). The card Picture shows the same people and objects.`));
  }
  return view;
}

class Stage {
  constructor(box, frames, ahead, counts) {
    Object.assign(this, { box, frames, ahead, counts, objects: [], floor: null, changed: true, placed: false, drawnAt: 0 });
    this.slow = !drawsFast();
    this.renderer = new THREE.WebGLRenderer({ antialias: devicePixelRatio < 2 && !this.slow, alpha: true });
    this.renderer.setPixelRatio(this.slow ? 1 : Math.min(devicePixelRatio, 2));
    box.append(this.renderer.domElement);
    this.renderer.domElement.setAttribute("aria-hidden", "true");
    this.labels = new Labels(box);
    this.camera = new THREE.PerspectiveCamera(40, 1, 0.05, 60);
    this.controls = new OrbitControls(this.camera, this.renderer.domElement);
    this.controls.addEventListener("change", () => (this.changed = true));
    this.furnish();
    this.listen();
    this.reset();
    this.renderer.setAnimationLoop(guarded((nowMs) => this.draw(nowMs)));
  }

  furnish() {
    this.scene = new THREE.Scene();
    this.scene.add(new THREE.HemisphereLight(0xffffff, 0x667788, 2.4));
    const sun = new THREE.DirectionalLight(0xffffff, 1.6);
    sun.position.set(1, 3, 2);
    this.grid = new THREE.Group();
    this.world = new THREE.Group();  // level: y up, in metres
    this.sensor = new THREE.CameraHelper(new THREE.PerspectiveCamera(50, 4 / 3, 0.02, 0.14));
    this.scene.add(sun, this.grid, this.world, this.sensor);
    this.bodies = new Bodies(this.world);
    this.things = new Things(this.world);
    this.ghosts = new Ghosts(this.world);
    this.paint();
  }

  paint() {
    this.grid.clear();
    const lines = new THREE.GridHelper(GRID_M, GRID_M / SQUARE_M, theme("grid-strong"), theme("grid-strong"));
    const shade = new THREE.Mesh(new THREE.CircleGeometry(0.45, 40), new THREE.MeshBasicMaterial({ color: theme("grid"), transparent: true, opacity: 0.6 }));
    shade.rotation.x = -Math.PI / 2;
    shade.position.y = 0.002;
    this.shade = shade;
    lines.material.transparent = true;
    lines.material.opacity = 0.55;
    this.grid.add(lines, shade);
    const colour = new THREE.Color(theme("muted"));
    this.sensor.setColors(colour, colour, colour, colour, colour);
    for (const drawn of [this.bodies, this.things, this.ghosts]) drawn.paint();
    this.changed = true;
  }

  listen() {
    link.on("objects", ({ objects, stamp_ns: stamp }) => {
      this.objects = objects;
      this.things.remember(objects, stamp);
    });
    link.on("event", (event) => this.things.acted(event));
    link.on("frame", () => this.place());
    setInterval(() => isSensorStill() && this.place(), LOOK_MS);
    this.frames.addEventListener("change", () => this.reset());
    this.ahead.addEventListener("change", () => this.place());
    dark.addEventListener("change", () => this.paint());
    new ResizeObserver(() => this.fit()).observe(this.box);
    this.box.addEventListener("keydown", (event) => this.key(event));
  }

  // Puts everything where the newest messages say.
  place() {
    const { agents: seen, up_in_camera: up } = newestSkeleton();
    const [agents, shown] = [isSensorStill() ? [] : seen, shownAgent()];
    const worldFromCamera = this.worldFromCamera(up, newestPosture(shown));
    const joints = agents.map(({ agent, joints: points }) => ({ agent, points: points.map((point) => point && at(point, worldFromCamera)) }));
    this.bodies.show(joints, shown);
    this.things.show(this.objects, worldFromCamera);
    const isAhead = this.ahead.checked && !isSensorStill();
    this.ghosts.show(isAhead ? expected(newestSkeleton(), this.objects) : NOTHING, (point) => at(point, worldFromCamera));
    this.sensor.matrix.copy(worldFromCamera).multiply(new THREE.Matrix4().makeScale(1, -1, -1));
    this.sensor.matrixAutoUpdate = false;
    this.stand(joints.find(({ agent }) => agent === shown)?.points);
    this.tellCounts(agents.length);
    this.changed = true;
  }

  worldFromCamera(up, posture) {
    const level = new THREE.Matrix4().makeScale(1, -1, -1);
    if (this.frames.value === "person" && posture?.ego_from_camera) return new THREE.Matrix4().set(...posture.ego_from_camera);
    if (!up) return level;
    const leaning = new THREE.Vector3(up[0], -up[1], -up[2]).normalize();
    return new THREE.Matrix4().makeRotationFromQuaternion(new THREE.Quaternion().setFromUnitVectors(leaning, UP)).multiply(level);
  }

  // Lays the floor under the lowest foot, and at first looks at the person.
  stand(points) {
    const there = (points ?? []).filter(Boolean);
    this.shade.visible = there.length > 0;
    if (!there.length) return;
    const lowest = Math.min(...there.map(({ y }) => y)) - 0.06;
    this.floor = this.floor === null ? lowest : this.floor + FLOOR_FOLLOWS * (lowest - this.floor);
    this.grid.position.y = this.floor;
    const middle = points[2] ?? there[0];
    this.shade.position.set(middle.x, 0.002, middle.z);
    if (!this.placed) this.lookAt(middle);
    else this.follow(middle);
  }

  // Keeps a person who walks in view, without turning or zooming.
  follow(middle) {
    const way = middle.clone().sub(this.controls.target).setY(0);
    if (way.length() < STRAYS_M) return;
    way.multiplyScalar(FOLLOWS);
    this.controls.target.add(way);
    this.camera.position.add(way);
    this.controls.update();
  }

  lookAt(middle) {
    this.placed = true;
    this.grid.children[0].position.set(Math.round(middle.x), 0, Math.round(middle.z));
    this.controls.target.set(middle.x, this.floor + 0.82, middle.z);
    const away = this.box.clientWidth < this.box.clientHeight ? 1.35 : 1;
    const turned = this.frames.value === "person" ? [-1.0, 0.6, 2.9] : [1.0, 0.6, 2.9];
    this.camera.position.set(...turned.map((value) => value * away)).add(this.controls.target);
    this.controls.update();
  }

  tellCounts(present) {
    const seen = this.objects.filter(({ seen: now }) => now).length;
    const who = present ? counted(present, "person", "people") : "Nobody is seen";
    const text = `${who} · ${seen} of ${counted(this.objects.length, "object")} in sight`;
    if (this.counts.textContent !== text) this.counts.textContent = text;
  }

  reset() {
    this.placed = false;
    this.floor = null;
    this.place();
  }

  key(event) {
    const turns = { ArrowLeft: [-TURN, 0], ArrowRight: [TURN, 0], ArrowUp: [0, -TURN], ArrowDown: [0, TURN] };
    const zooms = { "+": 1 / ZOOM, "=": 1 / ZOOM, "-": ZOOM };
    if (event.key in turns) this.turn(...turns[event.key]);
    else if (event.key in zooms) this.zoom(zooms[event.key]);
    else if (event.key === "0") this.reset();
    else return;
    event.preventDefault();
  }

  turn(around, over) {
    const offset = new THREE.Spherical().setFromVector3(this.camera.position.clone().sub(this.controls.target));
    offset.theta += around;
    offset.phi += over;
    offset.makeSafe();
    this.camera.position.setFromSpherical(offset).add(this.controls.target);
    this.controls.update();
  }

  zoom(factor) {
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
  }

  fit() {
    const { clientWidth: width, clientHeight: height } = this.box;
    if (!width || !height) return;
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    this.changed = true;
  }

  draw(nowMs) {
    const hidden = this.box.clientWidth === 0;
    const early = this.slow && nowMs - this.drawnAt < SLOW_MS;
    if (hidden || early || (!this.changed && !this.things.moving)) return;
    Object.assign(this, { changed: false, drawnAt: nowMs });
    this.things.fade();
    this.renderer.render(this.scene, this.camera);
    this.label();
  }

  // Names what is in view.
  label() {
    const { clientWidth: width, clientHeight: height } = this.box;
    const labels = [...this.bodies.labels, ...this.things.labels].map(({ at: place, ...label }) => {
      const { x, y, z } = place.project(this.camera);
      return { ...label, x: ((x + 1) / 2) * width, y: ((1 - y) / 2) * height, isInView: Math.max(Math.abs(x), Math.abs(y), Math.abs(z)) < 1 };
    });
    this.labels.show(labels.filter(({ isInView }) => isInView));
  }
}

// Tells whether a graphics card draws.
function drawsFast() {
  const context = document.createElement("canvas").getContext("webgl2", { failIfMajorPerformanceCaveat: true });
  context?.getExtension("WEBGL_lose_context")?.loseContext();
  return context !== null;
}

function at(point, worldFromCamera) {
  return new THREE.Vector3(...point).applyMatrix4(worldFromCamera);
}
