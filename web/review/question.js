// SPDX-License-Identifier: Apache-2.0
//
// The panel below the map: what is asked about a scan, where the person has put it, the places that are offered.
import { poseOf } from "shared/decisions.js";
import { compose } from "shared/pose.js";
import { causeText } from "review/request_list.js";

const element = (id) => document.getElementById(id);

export class Question {
  constructor(scan) {
    this.scan = scan;
    this.picked = false; // the pose is one of those offered
    element("reset-pose").addEventListener("click", () => scan.reset());
    for (const button of document.querySelectorAll("#nudge button")) {
      const [east, north, turn_deg] = button.dataset.step.split(" ").map(Number);
      button.addEventListener("click", () => scan.move(east, north, (turn_deg * Math.PI) / 180));
    }
  }

  hide() {
    element("question").hidden = true;
    this.scan.show(null);
  }

  // `answer`: what somebody has said to it already; the scan is then shown where he has put it. `takesPose`: whether it
  // can be answered by a pose.
  show(request, answer, takesPose) {
    element("question").hidden = false;
    element("question-title").textContent = `Request ${request.rank}, block ${request.block}: ${causeText(request)}`;
    element("question-text").textContent = request.causes.map(({ message }) => message).join("; ");
    for (const id of ["accept", "save-correction"]) element(id).disabled = !takesPose;
    element("walls").hidden = !request.reference || !request.reference_points?.length;
    element("modes").replaceChildren(...request.modes.map((mode, i) => this.#modeButton(request, mode, i)));
    this.scan.show(request);
    const moved = ["correct", "pick"].includes(answer?.decision);
    if (moved && answer.frame === "site") {
      this.scan.put(answer.pose);
    } else if (moved && answer.ref?.stamp_ns === request.reference?.stamp_ns) {
      this.scan.put(compose(poseOf(request.reference), answer.pose));
    } else {
      this.tellPose();
    }
  }

  #modeButton(request, mode, i) {
    const button = document.createElement("button");
    const away = Math.hypot(mode.x - request.estimate.x, mode.y - request.estimate.y);
    button.textContent = `Place ${i + 1}: ${away.toFixed(2)} m away, ${Math.round(100 * mode.weight)} %`;
    button.addEventListener("click", () => {
      this.scan.put(poseOf(mode));
      this.picked = true;
    });
    return button;
  }

  // What the shown pose is, when it is taken.
  get decision() {
    if (this.scan.unmoved) return "confirm";
    return this.picked ? "pick" : "correct";
  }

  tellPose() {
    this.picked = false;
    const { estimate } = this.scan.request;
    const [x, y, theta] = this.scan.pose;
    const centimetres = (value) => `${(100 * value).toFixed(1)} cm`;
    const degrees = ((180 / Math.PI) * (theta - estimate.theta)).toFixed(2);
    element("moved").textContent = this.scan.unmoved
      ? "as estimated"
      : `moved ${centimetres(x - estimate.x)} east, ${centimetres(y - estimate.y)} north, turned ${degrees}°`;
    element("accept").textContent = this.scan.unmoved ? "Confirm and next" : "Save this pose and next";
  }
}
