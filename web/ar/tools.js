// SPDX-License-Identifier: Apache-2.0
//
// What a person does in the room, point by point on the floor; kept until it is sent. Needs no headset: points come from
// outside.
import { additionOf, answerInSite, poseOf } from "shared/decisions.js";

const kLeastSigma_m = 0.01;
const kLeastArrowSigma_m = 0.05; // a person does not outweigh control
const kByEye = [0.2, 0.2, 0.07]; // of a pose that is confirmed (m, m, rad)
const kLineWidth_m = 0.1;
const kPointsNeeded = { line: 2, region: 2, adjust: 2, pose: 2 };

function closed(ring) {
  return [...ring, ring[0]];
}

// A rectangle with its sides along the axes of the floor, so that it is square to the room that was aligned to.
function rectangle([[x0, y0], [x1, y1]]) {
  return [[x0, y0], [x1, y0], [x1, y1], [x0, y1]];
}

export class ArTools {
  constructor(alignment, controlPoints, requests) {
    this.alignment = alignment;
    this.controlPoints = controlPoints;
    this.requests = requests;
    this.edits = []; // not sent yet
    this.answers = []; // {block, answer}
    this.points = []; // of the tool in use, on the floor
    this.tool = null;
    this.request = requests[0] ?? null;
    this.siteFromScan = this.request && poseOf(this.request.estimate);
    this.target = controlPoints[0] ?? null; // to be aimed at next
  }

  // A sentence on what happened, or what is missing.
  use(tool, about) {
    if (tool === "forbidden" && this.tool === "forbidden") return this.#finishArea(about);
    this.points = [];
    this.tool = tool;
    if (tool === "align") return this.#nextTarget();
    if (!this.alignment.fit) {
      this.tool = null;
      return "align first: aim at two control points that lie apart";
    }
    if (tool === "confirm") return this.#confirm(about);
    if (tool === "undo") return this.#undo();
    if (tool === "pose") return "aim at where the lidar stood, then ahead of it";
    return tool === "forbidden" ? "aim at the corners, then press the button again" : "aim at two points";
  }

  // A point on the floor was aimed at.
  aim(floor, about) {
    if (this.tool === "align") return this.#aimAtControl(floor);
    if (!this.tool) return "choose what to do first";
    this.points.push(floor);
    if (this.points.length !== kPointsNeeded[this.tool]) return `${this.points.length}. point`;
    const message = this.#finish(about);
    this.points = [];
    return message;
  }

  #nextTarget() {
    const at = this.controlPoints.indexOf(this.target);
    if (this.alignment.pairs.has(this.target?.name)) this.target = this.controlPoints[(at + 1) % this.controlPoints.length];
    return this.target ? `aim at point ${this.target.name}` : "the site has no control points";
  }

  #aimAtControl(floor) {
    this.alignment.aim(this.target, floor);
    const { fit, count } = this.alignment;
    const quality = fit ? `${count} points, rms ${(1000 * fit.rms).toFixed(0)} mm` : `${count} point`;
    return `${quality}; ${this.#nextTarget()}`;
  }

  #finish(about) {
    const points = this.points.map((point) => this.alignment.toSite(point));
    switch (this.tool) {
      case "line":
        return this.#add({ type: "LineString", coordinates: points }, { kind: "line_occupied", width_m: kLineWidth_m }, about);
      case "region": {
        const ring = rectangle(this.points).map((point) => this.alignment.toSite(point));
        return this.#add({ type: "Polygon", coordinates: [closed(ring)] }, { kind: "area_free" }, about);
      }
      case "adjust":
        return this.#add({ type: "MultiLineString", coordinates: [points] }, { kind: "adjust" }, about);
      default: {
        const [east, north] = [points[1][0] - points[0][0], points[1][1] - points[0][1]];
        this.siteFromScan = [...points[0], Math.atan2(north, east)];
        const sigma = this.#sigmaOf("pose");
        return this.#answer("correct", [sigma, sigma, (Math.SQRT2 * sigma) / Math.hypot(east, north)], about);
      }
    }
  }

  #finishArea(about) {
    const ring = this.points.map((point) => this.alignment.toSite(point));
    this.points = [];
    this.tool = null;
    if (ring.length < 3) return "an area has three corners or more";
    return this.#add({ type: "Polygon", coordinates: [closed(ring)] }, { kind: "forbidden" }, about);
  }

  #sigmaOf(kind) {
    const least = kind === "adjust" ? kLeastArrowSigma_m : kLeastSigma_m;
    return Math.max(least, Number(this.alignment.fit.rms.toFixed(4)));
  }

  #add(geometry, attributes, { operator, tool }) {
    const sigma_m = this.#sigmaOf(attributes.kind);
    this.edits.push(additionOf(geometry, { ...attributes, frame: "site", sigma_m, who: operator, tool }));
    return `${attributes.kind}: ${this.edits.length} to send`;
  }

  // The scan lies on the walls of the room as the alignment shows it.
  #confirm(about) {
    const sigma = this.#sigmaOf("pose");
    return this.#answer("confirm", [Math.hypot(kByEye[0], sigma), Math.hypot(kByEye[1], sigma), kByEye[2]], about);
  }

  // Measured on control points, so in the site: no earlier scan takes part.
  #answer(decision, sigma, about) {
    this.tool = null;
    if (!this.request) return "there is no open request";
    const answer = answerInSite(this.request, decision, this.siteFromScan, about, sigma);
    const { stamp_ns: stamp, block } = this.request;
    this.answers = [...this.answers.filter((kept) => kept.answer.stamp_ns !== stamp), { block, answer }];
    this.request = this.requests[this.requests.indexOf(this.request) + 1] ?? null;
    this.siteFromScan = this.request && poseOf(this.request.estimate);
    return `pose: ${decision}; ${this.answers.length} answers to send`;
  }

  #undo() {
    this.tool = null;
    return this.edits.pop() ? `last edit taken back; ${this.edits.length} to send` : "nothing to take back";
  }
}
