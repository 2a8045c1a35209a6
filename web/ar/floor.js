// SPDX-License-Identifier: Apache-2.0
//
// The floor of the headset's `local-floor` space, seen from above: x right, y ahead of where the session began (three.js
// has y up and z back). The site lies on it as soon as two control points were aimed at.
import { inverse, rigidFit, transformed } from "shared/pose.js";

export function toFloor({ x, z }) {
  return [x, -z];
}

// Where a ray meets the floor; null when it points elsewhere.
export function pointOnFloor(origin, direction) {
  const length = -origin.y / direction.y;
  if (!(length > 0) || length > 50) return null;
  return toFloor({ x: origin.x + length * direction.x, z: origin.z + length * direction.z });
}

const kLeastSpread_m = 1; // of the control points: closer ones tell no direction

// Control points as they were aimed at.
export class Alignment {
  constructor() {
    this.pairs = new Map(); // name: {floor, site}
  }

  aim(point, floor) {
    this.pairs.set(point.name, { floor, site: [point.x, point.y] });
  }

  clear() {
    this.pairs.clear();
  }

  get count() {
    return this.pairs.size;
  }

  // {siteFromFloor, rms}; null until two points were aimed at that lie apart. Coordinates are fitted about the first
  // point: a projected system has seven digits before the point.
  get fit() {
    const pairs = [...this.pairs.values()];
    if (pairs.length < 2) return null;
    const [x0, y0] = pairs[0].site;
    const site = pairs.map(({ site: [x, y] }) => [x - x0, y - y0]);
    if (Math.max(...site.map(([x, y]) => Math.hypot(x, y))) < kLeastSpread_m) return null;
    const { pose, rms } = rigidFit(pairs.map(({ floor }) => floor), site);
    return { siteFromFloor: [pose[0] + x0, pose[1] + y0, pose[2]], rms };
  }

  toSite(floor) {
    return transformed(this.fit.siteFromFloor, floor);
  }

  get floorFromSite() {
    return inverse(this.fit.siteFromFloor);
  }
}
