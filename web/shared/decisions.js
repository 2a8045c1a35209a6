// SPDX-License-Identifier: Apache-2.0
//
// Answers and edits as they go to disk; formats/README.md has their members. Coordinates to 0.1 mm.
import { between, inverse, transformed } from "shared/pose.js";

const round = (value, digits) => Number(value.toFixed(digits));

export function roundedPose(pose) {
  return [round(pose[0], 4), round(pose[1], 4), round(pose[2], 6)];
}

export function utc(date) {
  return date.toISOString().replace(/\.\d+Z$/, "Z");
}

export function poseOf({ x, y, theta }) {
  return [x, y, theta];
}

// Whether an answer to a request can give a pose. `blocks`: as the list of requests has them.
export function takesPose({ reference, block }, blocks) {
  return reference !== null || blocks.some(({ name, tied }) => name === block && tied);
}

// A scan's pose is given in the frame of the request's reference: true wherever an adjustment moves both. Where there is
// no earlier scan to refer to, it is given in the site.
export function answerWithPose(request, decision, siteFromScan, about) {
  if (request.reference === null) return answerInSite(request, decision, siteFromScan, about);
  return {
    ...answerTo(request, decision, about),
    ref: { stamp_ns: request.reference.stamp_ns },
    pose: roundedPose(between(poseOf(request.reference), siteFromScan)),
  };
}

// A pose in the site, as it is measured on control points. `sigma`: [m, m, rad]; that of the decision when missing.
export function answerInSite(request, decision, siteFromScan, about, sigma) {
  const answer = { ...answerTo(request, decision, about), frame: "site", pose: roundedPose(siteFromScan) };
  return sigma ? { ...answer, sigma: sigma.map((value) => round(value, 4)) } : answer;
}

export function answerTo(request, decision, about) {
  return { schema: 1, stamp_ns: request.stamp_ns, decision, id: request.id, ...about };
}

export function rejectionOf(request, about) {
  return { ...answerTo(request, "reject_stretch", about), stamp_ns: request.from_ns, end_ns: request.until_ns };
}

// How a wall of the scan lies to one of the request's reference: "collinear", "parallel" or "perpendicular".
// `ends`: two of the scan's wall where it is shown, two of the reference's, all in the site.
export function relationOf(request, relation, siteFromScan, ends, about) {
  const wall = (pose, points) => points.map((p) => transformed(inverse(pose), p).map((value) => round(value, 4)));
  return {
    ...answerTo(request, "relate", about),
    relation,
    wall: wall(siteFromScan, ends.slice(0, 2)),
    ref: { stamp_ns: request.reference.stamp_ns, wall: wall(poseOf(request.reference), ends.slice(2)) },
  };
}

export function newUid() {
  const bytes = crypto.getRandomValues(new Uint8Array(6));
  return Array.from(bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

const roundedCoordinates = (value) => (Array.isArray(value) ? value.map(roundedCoordinates) : round(value, 4));

const rounded = ({ type, coordinates }) => ({ type, coordinates: roundedCoordinates(coordinates) });

// `attributes`: kind, class, width_m, frame, sigma_m, why, who, tool. Empty ones are left out.
export function additionOf(geometry, attributes) {
  const given = Object.entries(attributes).filter(([, value]) => value !== "" && value !== undefined);
  return {
    op: "add",
    uid: newUid(),
    geometry: rounded(geometry),
    when: utc(new Date()),
    ...Object.fromEntries(given),
  };
}

// The next revision of an edit with another geometry. `about`: who, tool, and the basis of the map that it is drawn on.
export function revisionOf({ shown, basis: drawnOn, ...members }, geometry, { basis, ...about }) {
  const revision = { ...members, ...about, op: "modify", rev: members.rev + 1, geometry: rounded(geometry), when: utc(new Date()) };
  return members.frame === "site" ? revision : { ...revision, basis };
}

export function retirementOf(edit, who, tool) {
  return { op: "retire", uid: edit.uid, rev: edit.rev + 1, who, when: utc(new Date()), why: "undone", tool };
}
