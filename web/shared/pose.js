// SPDX-License-Identifier: Apache-2.0
//
// Rigid motions of the plane. A pose is [x, y, theta] (m, m, rad, counter-clockwise) and named target_from_source:
// siteFromScan = compose(siteFromRef, refFromScan).

export function normalized(angle) {
  return Math.atan2(Math.sin(angle), Math.cos(angle));
}

export function transformed(pose, [x, y]) {
  const c = Math.cos(pose[2]);
  const s = Math.sin(pose[2]);
  return [pose[0] + c * x - s * y, pose[1] + s * x + c * y];
}

export function compose(cFromB, bFromA) {
  return [...transformed(cFromB, bFromA), normalized(cFromB[2] + bFromA[2])];
}

export function inverse(pose) {
  const c = Math.cos(pose[2]);
  const s = Math.sin(pose[2]);
  return [-c * pose[0] - s * pose[1], s * pose[0] - c * pose[1], -pose[2]];
}

// aFromB of two poses in one frame.
export function between(frameFromA, frameFromB) {
  return compose(inverse(frameFromA), frameFromB);
}

function mean(points) {
  const sum = points.reduce(([x, y], p) => [x + p[0], y + p[1]], [0, 0]);
  return [sum[0] / points.length, sum[1] / points.length];
}

// The rigid motion that takes `from` to `to` with the least squares of what is left (two points at least), and the root
// of the mean square of that per point: {pose: toFromFrom, rms}.
export function rigidFit(from, to) {
  const a = mean(from);
  const b = mean(to);
  let sine = 0;
  let cosine = 0;
  for (let i = 0; i < from.length; ++i) {
    const [px, py] = [from[i][0] - a[0], from[i][1] - a[1]];
    const [qx, qy] = [to[i][0] - b[0], to[i][1] - b[1]];
    cosine += px * qx + py * qy;
    sine += px * qy - py * qx;
  }
  const theta = Math.atan2(sine, cosine);
  const turned = transformed([0, 0, theta], a);
  const pose = [b[0] - turned[0], b[1] - turned[1], theta];
  const squares = from.map((p, i) => {
    const q = transformed(pose, p);
    return (q[0] - to[i][0]) ** 2 + (q[1] - to[i][1]) ** 2;
  });
  return { pose, rms: Math.sqrt(squares.reduce((sum, square) => sum + square, 0) / from.length) };
}
