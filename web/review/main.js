// SPDX-License-Identifier: Apache-2.0
//
// The review page: requests on the left, the map in the middle, tools, layers and edits on the right.
import { answerTo, answerWithPose, rejectionOf, relationOf, takesPose } from "shared/decisions.js";
import { Review } from "shared/review.js";
import { kDocuments, sourceOfPage } from "shared/source.js";
import { Stopwatch } from "shared/stopwatch.js";
import { backdropOf } from "review/backdrop.js";
import { EditList } from "review/edit_list.js";
import { EditQuestion } from "review/edit_question.js";
import { EditsOnMap, kTools, titleOf } from "review/edits_on_map.js";
import { listenToKeys } from "review/keys.js";
import { SiteMap } from "review/map.js";
import { Question } from "review/question.js";
import { answerFor, RequestList } from "review/request_list.js";
import { ScanOnMap } from "review/scan.js";
import { WallPair } from "review/walls.js";

const kRequestWidth_m = 24; // of the map that is shown with a request

const element = (id) => document.getElementById(id);

class Page {
  constructor(source, documents) {
    this.source = source;
    this.documents = documents;
    this.request = null;
    this.watch = new Stopwatch();
    this.siteMap = new SiteMap("map", source, documents);
    this.scan = new ScanOnMap(this.siteMap, () => this.question.tellPose());
    this.question = new Question(this.scan);
    this.walls = new WallPair(this.siteMap, this.scan, {
      tell: (text, isError) => this.tell(text, isError),
      done: (relation, ends) => this.#relate(relation, ends),
    });
    this.editQuestion = new EditQuestion(this.siteMap, {
      settle: (edit, geometry) => this.#settle(() => this.review.revise(edit, geometry, this.#aboutEdit()), "settled"),
      redraw: (edit) => this.#redraw(edit),
      retire: (edit) => this.#settle(() => this.review.retire(edit, this.operator), "retired"),
    });
    this.editsOnMap = new EditsOnMap(this.siteMap, (tool, geometry) => this.#drawn(tool, geometry));
    this.review = new Review(source, documents, () => this.#refresh());
    this.requestList = new RequestList(element("requests"), element("request-summary"), (request) => this.ask(request));
    this.editList = new EditList(element("edits"), element("edit-summary"), {
      choose: (edit) => this.#lookAt(edit),
      retire: (edit) => this.#attempt(() => this.review.retire(edit, this.operator), "undone"),
    });
    this.#wire();
    this.requestList.show(documents.requests.requests, this.review);
    this.#refresh();
    this.ask(this.requestList.nextOpen(null, this.review));
    this.watch.start();
  }

  get operator() {
    return element("operator").value.trim();
  }

  // Shows a request; null: none is open.
  ask(request) {
    this.request = request;
    this.useTool(null);
    this.requestList.select(request);
    this.watch.start();
    this.question.hide();
    this.editQuestion.hide();
    if (!request) return this.tell(this.requestList.requests.length ? "every request has an answer" : "no requests");
    this.siteMap.show(this.documents.requests.frames[request.block]);
    if (request.kind === "edit") return this.editQuestion.show(request);
    this.siteMap.centreOn([request.estimate.x, request.estimate.y], kRequestWidth_m);
    const answer = answerFor(request, this.review.answers)?.answer;
    return this.question.show(request, answer, takesPose(request, this.documents.requests.blocks));
  }

  // The request when it asks about a scan.
  get poseRequest() {
    return this.request?.kind === "edit" ? null : this.request;
  }

  // What is shown is right: the estimate, one of the places offered, where the person has moved the scan, or an edit where
  // it lies.
  accept() {
    if (this.editsOnMap.tool) return this.editsOnMap.finish();
    if (this.request?.kind === "edit") return this.editQuestion.keep();
    return this.#answerWithPose(this.question.decision, true);
  }

  #answerWithPose(decision, thenNext) {
    if (!this.poseRequest) return undefined;
    if (!takesPose(this.request, this.documents.requests.blocks)) {
      return this.tell("no earlier scan to refer to, and the block is not tied to the site: skip or reject it");
    }
    const about = this.watch.about(this.operator);
    return this.#answer(answerWithPose(this.request, decision, this.scan.pose, about), thenNext);
  }

  rejectStretch() {
    if (this.poseRequest) this.#answer(rejectionOf(this.request, this.watch.about(this.operator)), true);
  }

  async #relate(relation, ends) {
    const { request } = this;
    this.walls.start(null);
    await this.#answer(relationOf(request, relation, this.scan.pose, ends, this.watch.about(this.operator)), true);
  }

  skip() {
    if (this.poseRequest) this.#answer(answerTo(this.request, "skip", this.watch.about(this.operator)), true);
  }

  #takeWalls(relation) {
    this.useTool(null);
    this.walls.start(relation);
  }

  async #answer(answer, thenNext) {
    const { request } = this;
    const done = await this.#attempt(() => this.review.answer(request.block, answer), `${answer.decision}: saved`);
    if (done && thenNext && this.request === request) this.next();
  }

  // A decision about an edit, then the next request.
  async #settle(step, success) {
    const { request } = this;
    if ((await this.#attempt(step, success)) && this.request === request) this.next();
  }

  #redraw(edit) {
    this.useTool(kTools.find(({ kind }) => kind === edit.kind));
    this.redrawn = edit;
    this.tell(`draw it anew: ${titleOf(edit.kind)}`);
  }

  #maskOverRequest() {
    element("mask-from").value = this.poseRequest.from_ns;
    element("mask-until").value = this.poseRequest.until_ns;
  }

  #aboutEdit() {
    return { who: this.operator, tool: this.watch.tool, basis: this.documents.site.basis };
  }

  next() {
    this.ask(this.requestList.nextOpen(this.request, this.review));
  }

  useTool(tool) {
    const taken = tool && tool !== this.editsOnMap.tool ? tool : null;
    this.redrawn = null; // an edit that gets what is drawn
    this.walls.start(null);
    if (taken) this.siteMap.show("site");
    this.editsOnMap.use(taken);
    for (const button of element("tools").children) {
      button.setAttribute("aria-pressed", String(button.dataset.kind === taken?.kind));
    }
    element("drawing").hidden = !taken;
    element("mask-times").hidden = taken?.kind !== "mask_returns";
    element("mask-of-request").disabled = !this.poseRequest;
    this.watch.start();
  }

  async #drawn(tool, geometry) {
    if (this.redrawn) {
      const edit = this.redrawn;
      return this.#settle(() => this.review.revise(edit, geometry, this.#aboutEdit()), `${tool.title}: drawn anew`);
    }
    const number = (id) => Number(element(id).value);
    const measured = element("measured").checked;
    const timeOf = (id) => (tool.kind === "mask_returns" ? element(id).value.trim() : undefined);
    const attributes = {
      kind: tool.kind,
      width_m: tool.wide ? number("width") : undefined,
      class: element("class").value,
      from_ns: timeOf("mask-from"),
      until_ns: timeOf("mask-until"),
      frame: measured ? "site" : undefined,
      basis: measured ? undefined : this.documents.site.basis,
      why: element("why").value.trim(),
      who: this.operator,
      tool: this.watch.tool,
    };
    await this.#attempt(() => this.review.add(geometry, attributes), `${tool.title}: saved`);
    return this.watch.start();
  }

  undo() {
    return this.#attempt(async () => {
      if (!(await this.review.undo())) throw new Error("nothing to undo");
    }, "undone");
  }

  // Runs a step that writes; says how it ended.
  async #attempt(step, success) {
    if (!this.operator) {
      element("operator").focus();
      this.tell("enter your name first: it is kept with every decision", true);
      return false;
    }
    try {
      await step();
      this.tell(success);
      return true;
    } catch (error) {
      this.tell(error.message, true);
      return false;
    }
  }

  tell(text, isError = false) {
    element("status").textContent = text;
    element("status").classList.toggle("error", isError);
  }

  // Back from another window: somebody may have decided something, or run the site.
  async #lookAgain() {
    const { layers } = await this.source.load("site");
    const versions = (all) => JSON.stringify(all.map(({ id, version }) => [id, version]));
    if (versions(layers) !== versions(this.documents.site.layers)) location.reload();
    else await this.review.refresh();
  }

  #lookAt(edit) {
    this.siteMap.show("site");
    this.editsOnMap.select(edit.uid);
    const extent = this.editsOnMap.extentOf(edit.uid);
    if (extent) this.siteMap.map.getView().fit(extent, { padding: [120, 120, 120, 120], maxZoom: 30, minResolution: 0.01 });
  }

  #refresh() {
    this.requestList.refresh(this.review);
    this.editsOnMap.show(this.review.edits);
    this.editList.show(this.review.edits, this.review.findings);
  }

  async #showBackdrop(files) {
    if (files.length === 0) return;
    try {
      const { layer, extent } = await backdropOf(files, this.siteMap.projection);
      this.siteMap.setBackdrop(layer);
      const meets = ol.extent.intersects(extent, this.siteMap.extents[this.siteMap.frame]);
      if (meets) this.tell(`${files[0].name}: shown`);
      else this.tell(`${files[0].name}: lies outside the map: is it in site coordinates?`, true);
    } catch (error) {
      this.tell(error.message, true);
    }
  }

  save() {
    const link = document.createElement("a");
    link.href = URL.createObjectURL(new Blob([this.source.saved()], { type: "application/json" }));
    link.download = `review-${this.documents.site.name}.json`;
    link.click();
    this.tell("saved; take it over with: plumbline review SITE --import FILE");
  }

  #wire() {
    const click = (id, action) => element(id).addEventListener("click", action);
    click("accept", () => this.accept());
    click("save-correction", () => this.#answerWithPose("correct", false));
    click("reject-stretch", () => this.rejectStretch());
    click("skip", () => this.skip());
    click("undo", () => this.undo());
    click("finish", () => this.editsOnMap.finish());
    click("point-away", () => this.editsOnMap.undoPoint());
    for (const button of document.querySelectorAll("#walls button")) {
      button.addEventListener("click", () => this.#takeWalls(button.dataset.relation));
    }
    click("mask-of-request", () => this.#maskOverRequest());
    click("tool-down", () => this.useTool(null));
    click("help-button", () => element("help").showModal());
    click("save", () => this.save());
    element("save").hidden = !this.source.keepsFile;
    element("room").hidden = this.source.keepsFile;
    element("backdrop").addEventListener("change", ({ target }) => this.#showBackdrop([...target.files]));
    element("operator").value = localStorage.getItem("plumbline-operator") ?? "";
    element("operator").addEventListener("change", () => localStorage.setItem("plumbline-operator", this.operator));
    element("tools").append(...kTools.map((tool) => this.#toolButton(tool)));
    this.#offerFrames(document.querySelector("#frames select"));
    for (const box of document.querySelectorAll("#layers input")) {
      box.addEventListener("change", () => this.siteMap.setVisible(box.value, box.checked));
    }
    document.addEventListener("visibilitychange", () => document.hidden || this.#lookAgain());
    window.addEventListener("beforeunload", (event) => this.review.isSaving && event.preventDefault());
    listenToKeys(this.scan, {
      accept: () => this.accept(),
      saveCorrection: () => this.#answerWithPose("correct", false),
      rejectStretch: () => this.rejectStretch(),
      skip: () => this.skip(),
      next: () => this.next(),
      resetPose: () => this.scan.reset(),
      undo: () => this.undo(),
      putToolDown: () => this.useTool(null),
      undoPoint: () => (this.walls.relation ? this.walls.undoPoint() : this.editsOnMap.undoPoint()),
      useTool: (tool) => this.useTool(tool),
      help: () => element("help").showModal(),
    });
  }

  // The site, and blocks that are tied to nothing, each in its own frame.
  #offerFrames(select) {
    const { frames } = this.siteMap;
    element("frames").hidden = frames.length < 2;
    select.append(...frames.map((frame) => new Option(frame === "site" ? "the site" : `block ${frame}`, frame)));
    select.addEventListener("change", () => this.siteMap.show(select.value));
  }

  #toolButton(tool) {
    const button = document.createElement("button");
    button.dataset.kind = tool.kind;
    button.textContent = titleOf(tool.kind);
    button.title = `key ${tool.key}`;
    button.setAttribute("aria-pressed", "false");
    button.addEventListener("click", () => this.useTool(tool));
    return button;
  }
}

async function start() {
  const source = sourceOfPage();
  const loaded = await Promise.all(kDocuments.map((name) => source.load(name)));
  const documents = Object.fromEntries(kDocuments.map((name, i) => [name, loaded[i]]));
  document.title = `${documents.site.name}: review`;
  element("site-name").textContent = documents.site.name;
  if (documents.site.layers.length === 0) throw new Error("no map yet: plumbline run first");
  const page = new Page(source, documents);
  page.siteMap.map.once("rendercomplete", () => {
    document.documentElement.dataset.firstPicture = Math.round(performance.now()); // ms after the page was asked for
  });
}

start().catch((error) => {
  element("status").textContent = error.message;
  element("status").classList.add("error");
});
