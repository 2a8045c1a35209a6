// SPDX-License-Identifier: Apache-2.0
//
// A list of review requests about scans of a computed site, in the form of work/requests.jsonl: what `requests` writes
// on a site that has doubts.
import { execFileSync } from "node:child_process";
import { writeFileSync } from "node:fs";
import { join } from "node:path";

const kCorner = Array.from({ length: 40 }, (_, i) => (i < 20 ? [2, -1 + 0.1 * i] : [0.1 * (i - 20), 1]));

// Poses of scans as a TUM file has them: [{ns, x, y, theta}].
export function posesOfTum(text) {
  const rows = String(text).split("\n").filter((line) => line && !line.startsWith("#"));
  return rows.map((line) => {
    const [t, x, y, , , , qz, qw] = line.split(" ");
    const [seconds, fraction = ""] = t.split(".");
    return { ns: String(BigInt(seconds + fraction.padEnd(9, "0"))), x: +x, y: +y, theta: 2 * Math.atan2(+qz, +qw) };
  });
}

// Of a block's scans in the site frame.
export function posesOf(site, block) {
  return posesOfTum(
    execFileSync("plumbline-show", [join(site, "work", block, "solution.sqlite"), "--trajectory", "tum"]),
  );
}

function requestAbout(block, poses, i, rank) {
  const { ns, x, y, theta } = poses[i];
  const reference = poses[i - 30];
  return {
    id: `${block}-${ns}-contradiction`,
    kind: "pose",
    block,
    rank,
    stamp_ns: ns,
    from_ns: poses[i - 2].ns,
    until_ns: poses[i + 2].ns,
    causes: [{ cause: "contradiction", score: 0.4, message: "another pass saw through 40 % of 120 wall cells" }],
    score: 0.4,
    estimate: { x, y, theta },
    spread: null,
    modes: [{ cause: "several_modes", x: x + 0.5, y: y - 0.25, theta: theta + 0.1, weight: 0.35 }],
    reference: { stamp_ns: reference.ns, x: reference.x, y: reference.y, theta: reference.theta, kind: "before" },
    points: kCorner,
    reference_points: kCorner,
    picture: null,
    answer: null,
  };
}

// About an edit of the ledger that lies where it was drawn, as if that had been 0.3 m farther south.
function requestAboutEdit({ uid, rev, kind, geometry, frame, who, when }, rank) {
  const moved = (value) => (typeof value[0] === "number" ? [value[0], value[1] - 0.3] : value.map(moved));
  return {
    id: `A-${uid}-edit_review`,
    kind: "edit",
    block: "A",
    rank,
    causes: [{ cause: "edit_review", score: 0.3, message: `${kind} ${uid} (${who}, ${when}): the map under it was bent by 0.30 m` }],
    score: 0.3,
    edit: { uid, rev, kind, geometry, frame, who, when },
    drawn: { type: geometry.type, coordinates: moved(geometry.coordinates) },
    picture: null,
  };
}

// Writes `count` requests, spread over blocks A and B, and those about edits of the ledger; returns them.
export function writeRequests(site, count, edits = []) {
  const requests = [];
  for (const block of ["A", "B"]) {
    const poses = posesOf(site, block);
    for (let k = 0; k < count / 2; ++k) requests.push(requestAbout(block, poses, 40 + 15 * k, requests.length + 1));
  }
  for (const edit of edits) requests.push(requestAboutEdit(edit, requests.length + 1));
  const head = { format: "plumbline-requests", format_version: 2, num_requests: requests.length, blocks: [], provenance: [] };
  const lines = [head, ...requests].map((line) => JSON.stringify(line) + "\n");
  writeFileSync(join(site, "work", "requests.jsonl"), lines.join(""));
  return requests;
}
