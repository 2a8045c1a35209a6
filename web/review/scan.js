// SPDX-License-Identifier: Apache-2.0
//
// The doubtful scan over the map: moved by mouse or finger at its points or its centre, turned at the small circle ahead
// of it (or anywhere on it with Alt held), or by keys. The scan that an answer refers to stands still beside it.
import { compose, normalized, transformed } from "shared/pose.js";
import { poseOf } from "shared/decisions.js";

const kGrab_px = 14;
const kTurnHandle_px = 70;

function dots(colour, radius) {
  return new ol.style.Style({
    image: new ol.style.Circle({ radius, fill: new ol.style.Fill({ color: colour }) }),
  });
}

function ring(colour, radius, width = 3) {
  return new ol.style.Style({
    image: new ol.style.Circle({
      radius,
      fill: new ol.style.Fill({ color: "#ffffffaa" }),
      stroke: new ol.style.Stroke({ color: colour, width }),
    }),
  });
}

const kStyles = {
  points: dots("#d0021b", 2.5),
  reference: dots("#0a6ebd", 2),
  centre: ring("#d0021b", 9),
  turn: ring("#d0021b", 7),
  mode: ring("#7b2ff7", 7),
  arm: new ol.style.Style({ stroke: new ol.style.Stroke({ color: "#d0021b", width: 2 }) }),
};

export class ScanOnMap {
  // `changed` is called with the pose whenever a person has moved the scan.
  constructor(siteMap, changed) {
    this.map = siteMap.map;
    this.changed = changed;
    this.request = null;
    this.held = false; // by a tool that takes clicks on the points
    this.features = Object.fromEntries(Object.keys(kStyles).map((name) => [name, this.#feature(name)]));
    const layer = new ol.layer.Vector({
      source: new ol.source.Vector({ features: Object.values(this.features) }),
      updateWhileInteracting: true,
      updateWhileAnimating: true,
      zIndex: 20,
      properties: { kind: "scan" },
    });
    siteMap.add(layer);
    this.map.addInteraction(this.#dragging());
    this.map.on("moveend", () => this.#place());
  }

  #feature(name) {
    const feature = new ol.Feature();
    feature.setStyle(kStyles[name]);
    return feature;
  }

  show(request) {
    this.request = request;
    this.pose = request ? poseOf(request.estimate) : null;
    this.#place();
  }

  // True while the pose is still the one that was asked about.
  get unmoved() {
    const estimate = poseOf(this.request.estimate);
    return this.pose.every((value, i) => value === estimate[i]);
  }

  get pointsOnSite() {
    return this.request.points.map((point) => transformed(this.pose, point));
  }

  get referenceOnSite() {
    const { reference, reference_points: points } = this.request;
    return reference ? (points ?? []).map((point) => transformed(poseOf(reference), point)) : [];
  }

  put(pose) {
    this.pose = pose;
    this.#place();
    this.changed(pose);
  }

  // Moved east and north (m), then turned about the lidar (rad).
  move(east, north, turn) {
    if (!this.request) return;
    this.put([this.pose[0] + east, this.pose[1] + north, normalized(this.pose[2] + turn)]);
  }

  reset() {
    if (this.request) this.put(poseOf(this.request.estimate));
  }

  #place() {
    if (!this.request) {
      for (const feature of Object.values(this.features)) feature.setGeometry(undefined);
      return;
    }
    const { reference, modes } = this.request;
    const handle = this.#turnHandle();
    this.features.points.setGeometry(new ol.geom.MultiPoint(this.pointsOnSite));
    this.features.reference.setGeometry(reference ? new ol.geom.MultiPoint(this.referenceOnSite) : undefined);
    this.features.centre.setGeometry(new ol.geom.Point(this.pose.slice(0, 2)));
    this.features.turn.setGeometry(new ol.geom.Point(handle));
    this.features.arm.setGeometry(new ol.geom.LineString([this.pose.slice(0, 2), handle]));
    this.features.mode.setGeometry(new ol.geom.MultiPoint(modes.map(({ x, y }) => [x, y])));
  }

  #turnHandle() {
    const arm = kTurnHandle_px * this.map.getView().getResolution();
    return compose(this.pose, [arm, 0, 0]).slice(0, 2);
  }

  #isNear(pixel, coordinate) {
    const [x, y] = this.map.getPixelFromCoordinate(coordinate);
    return Math.hypot(pixel[0] - x, pixel[1] - y) < kGrab_px;
  }

  // What a press at a pixel takes hold of: "turn", "move" or nothing.
  #gripAt(event) {
    if (!this.request || this.held || event.originalEvent.button > 0) return null;
    if (this.#isNear(event.pixel, this.#turnHandle())) return "turn";
    const points = [this.pose.slice(0, 2), ...this.features.points.getGeometry().getCoordinates()];
    if (!points.some((point) => this.#isNear(event.pixel, point))) return null;
    return event.originalEvent.altKey ? "turn" : "move";
  }

  #dragging() {
    let grip = null;
    let last = null;
    const bearing = ([x, y]) => Math.atan2(y - this.pose[1], x - this.pose[0]);
    return new ol.interaction.Pointer({
      handleDownEvent: (event) => {
        grip = this.#gripAt(event);
        last = event.coordinate;
        return grip !== null;
      },
      handleDragEvent: (event) => {
        if (grip === "move") this.move(event.coordinate[0] - last[0], event.coordinate[1] - last[1], 0);
        else this.move(0, 0, normalized(bearing(event.coordinate) - bearing(last)));
        last = event.coordinate;
      },
    });
  }
}
