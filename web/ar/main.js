// SPDX-License-Identifier: Apache-2.0
//
// Review in the room ([AS] section IV-B, without marker): the map on the floor through a headset or a phone, aligned by
// aiming at control points. WebXR `immersive-ar`; a ray is pressed on the floor or on the menu.
import * as THREE from "vendor/three/three.module.js";
import { Review } from "shared/review.js";
import { kDocuments, sourceOfPage } from "shared/source.js";
import { Stopwatch } from "shared/stopwatch.js";
import { Alignment, pointOnFloor } from "ar/floor.js";
import { RoomMenu } from "ar/menu.js";
import { FloorScene } from "ar/scene.js";
import { ArTools } from "ar/tools.js";

const element = (id) => document.getElementById(id);

class ArPage {
  constructor(source, documents) {
    this.documents = documents;
    this.watch = new Stopwatch();
    this.review = new Review(source, documents, () => this.scene.showEdits([...this.review.edits, ...this.tools.edits]));
    const control = documents.control.filter(({ role }) => role === "control");
    const onSite = ({ kind, block, answer }) =>
      kind === "pose" && answer === null && documents.requests.frames[block] === "site";
    this.alignment = new Alignment();
    this.tools = new ArTools(this.alignment, control, documents.requests.requests.filter(onSite));
    this.scene = new FloorScene(source);
    this.buttons = [...document.querySelectorAll("#menu button")];
    this.menu = new RoomMenu(this.buttons, element("status"));
    this.scene.scene.add(this.menu.group);
    this.#fillScene(control[0]);
    for (const button of this.buttons) button.addEventListener("click", () => this.#press(button.dataset.tool));
    element("enter").addEventListener("click", () => this.enter().catch((error) => this.tell(error.message)));
    element("operator").value = localStorage.getItem("plumbline-operator") ?? "";
  }

  #fillScene(first) {
    const layer = this.documents.site.layers.find(({ id }) => id === "map");
    this.scene.setOrigin(first ? [first.x, first.y] : layer.origin);
    this.scene.showControl(this.documents.control);
    this.scene.showEdits(this.review.edits);
  }

  get about() {
    return this.watch.about(element("operator").value.trim());
  }

  async enter() {
    const session = await navigator.xr.requestSession("immersive-ar", {
      requiredFeatures: ["local-floor"],
      optionalFeatures: ["dom-overlay"],
      domOverlay: { root: element("overlay") },
    });
    const renderer = new THREE.WebGLRenderer({ alpha: true, antialias: true });
    renderer.xr.enabled = true;
    renderer.xr.setReferenceSpaceType("local-floor");
    await renderer.xr.setSession(session);
    const camera = new THREE.PerspectiveCamera();
    let placed = false;
    renderer.setAnimationLoop(() => {
      if (!placed && renderer.xr.getCamera().position.lengthSq() > 0) {
        this.menu.placeBefore(renderer.xr.getCamera());
        placed = true;
      }
      renderer.render(this.scene.scene, camera);
    });
    for (const index of [0, 1]) this.#listen(renderer.xr.getController(index));
    session.addEventListener("end", () => renderer.setAnimationLoop(null));
    this.tell(this.tools.use("align", this.about));
  }

  #listen(controller) {
    const beam = [new THREE.Vector3(), new THREE.Vector3(0, 0, -5)];
    controller.add(new THREE.Line(new THREE.BufferGeometry().setFromPoints(beam), new THREE.LineBasicMaterial()));
    this.scene.scene.add(controller);
    controller.addEventListener("select", () => this.#select(controller));
  }

  #select(controller) {
    const origin = new THREE.Vector3().setFromMatrixPosition(controller.matrixWorld);
    const direction = new THREE.Vector3(0, 0, -1).transformDirection(controller.matrixWorld);
    if (this.menu.press(new THREE.Raycaster(origin, direction, 0, 5))) return;
    const floor = pointOnFloor(origin, direction);
    if (floor) this.#done(this.tools.aim(floor, this.about));
    else this.tell("aim at the floor");
  }

  #press(tool) {
    if (tool === "import") return this.#importMap();
    if (tool === "send") return this.#send();
    this.#done(this.tools.use(tool, this.about));
  }

  #importMap() {
    this.scene.showMap(this.documents.site.layers.find(({ id }) => id === "map"));
    this.tell("the map lies on the floor as soon as it is aligned");
  }

  // After each step: what is aligned, drawn and asked about is shown.
  #done(message) {
    const { alignment, tools } = this;
    if (alignment.fit) this.scene.place(alignment.floorFromSite);
    this.scene.showSketch(tools.points);
    this.scene.showEdits([...this.review.edits, ...tools.edits]);
    this.scene.showScan(tools.request?.points, tools.siteFromScan);
    for (const button of this.buttons) button.setAttribute("aria-pressed", String(button.dataset.tool === tools.tool));
    if (!tools.tool || tools.points.length === 0) this.watch.start();
    this.tell(message);
  }

  async #send() {
    const { tools } = this;
    if (!element("operator").value.trim()) return this.tell("enter your name before the session");
    localStorage.setItem("plumbline-operator", element("operator").value.trim());
    try {
      const sent = [tools.edits.length, tools.answers.length];
      if (tools.edits.length > 0) await this.review.append(tools.edits);
      tools.edits = [];
      while (tools.answers.length > 0) {
        await this.review.answer(tools.answers[0].block, tools.answers[0].answer);
        tools.answers.shift();
      }
      this.tell(`sent ${sent[0]} edits, ${sent[1]} answers`);
    } catch (error) {
      this.tell(error.message);
    }
  }

  tell(text) {
    element("status").textContent = text;
    this.menu.refresh();
  }
}

async function start() {
  const source = sourceOfPage();
  const loaded = await Promise.all(kDocuments.map((name) => source.load(name)));
  const documents = Object.fromEntries(kDocuments.map((name, i) => [name, loaded[i]]));
  element("site-name").textContent = documents.site.name;
  const page = new ArPage(source, documents);
  const supported = await navigator.xr?.isSessionSupported("immersive-ar");
  element("enter").disabled = !supported;
  page.tell(supported ? "ready" : "this browser has no WebXR with passthrough: use a headset's or a phone's");
}

start().catch((error) => (element("status").textContent = error.message));
