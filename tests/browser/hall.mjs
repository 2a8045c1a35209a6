// SPDX-License-Identifier: Apache-2.0
//
// The worst map of examples/human-in-the-loop, brought to success through the page alone: a person answers its requests
// by mouse and keys, relative to earlier passes, and runs the site again until nothing more is asked.
//   node hall.mjs SITE FIELD
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readFileSync } from "node:fs";
import { join } from "node:path";
import { posesOf, posesOfTum } from "./requests.mjs";
import { dragScan, openPage, siteUnder, startBrowser, startServer } from "./server.mjs";

const kSuccess_m = 1.0;
const kRounds = 5;
const kSeen_m = 0.3; // smaller errors a person does not see
const kSeen_rad = 0.1;
const kStep_m = 0.05;
const kRoom_px = 300; // for a scan that is moved from the middle of the map
const kTurn_rad = (0.5 * Math.PI) / 180;

const [site, field] = process.argv.slice(2);
const truth = new Map(posesOfTum(readFileSync(join(field, "truth", "B1.tum"), "utf8")).map((pose) => [pose.ns, pose]));
const browser = await startBrowser();

const sum = (values) => values.reduce((total, value) => total + value, 0);
const angle = (value) => Math.atan2(Math.sin(value), Math.cos(value));

// Pose b as seen from pose a, and where that is from another pose.
function between(a, b) {
  const [c, s] = [Math.cos(a.theta), Math.sin(a.theta)];
  const [dx, dy] = [b.x - a.x, b.y - a.y];
  return { x: c * dx + s * dy, y: c * dy - s * dx, theta: angle(b.theta - a.theta) };
}
function compose(a, b) {
  const [c, s] = [Math.cos(a.theta), Math.sin(a.theta)];
  return { x: a.x + c * b.x - s * b.y, y: a.y + s * b.x + c * b.y, theta: angle(a.theta + b.theta) };
}

// Largest distance of a pose from the truth after the rigid fit of all: the experiment's measure.
function largestError() {
  const pairs = posesOf(site, "B1").map((pose) => [pose, truth.get(pose.ns)]);
  const mean = (k, axis) => sum(pairs.map((pair) => pair[k][axis])) / pairs.length;
  const [ex, ey, tx, ty] = [mean(0, "x"), mean(0, "y"), mean(1, "x"), mean(1, "y")];
  const centred = pairs.map(([e, t]) => [e.x - ex, e.y - ey, t.x - tx, t.y - ty]);
  const turn = Math.atan2(
    sum(centred.map(([a, b, c, d]) => a * d - b * c)),
    sum(centred.map(([a, b, c, d]) => a * c + b * d)),
  );
  const [c, s] = [Math.cos(turn), Math.sin(turn)];
  return Math.max(...centred.map(([x, y, u, v]) => Math.hypot(c * x - s * y - u, s * x + c * y - v)));
}

// Requests of the page in its order; those that an earlier pass can answer have one in view.
function readRequests() {
  const lines = readFileSync(join(site, "work", "requests.jsonl"), "utf8").trim().split("\n").slice(1);
  return lines.map((line) => JSON.parse(line));
}

async function press(page, key, count) {
  for (let i = 0; i < count; ++i) await page.keyboard.press(key);
}

// Metres in a pixel of the map, whose middle the mouse is put on.
async function pixelSize(page) {
  const box = await page.locator("#map").boundingBox();
  const [x, y] = [box.x + box.width / 2, box.y + box.height / 2];
  const [west] = await siteUnder(page, [x - 100, y]);
  const [east] = await siteUnder(page, [x + 100, y]);
  await page.mouse.move(x, y);
  return (east - west) / 200;
}

// The wheel widens the view until there is room for the way.
async function pixelSizeFor(page, way_m) {
  let size = await pixelSize(page);
  for (let turns = 0; way_m / size > kRoom_px && turns < 10; ++turns) {
    await page.mouse.wheel(0, 240);
    await page.waitForTimeout(500);
    size = await pixelSize(page);
  }
  return size;
}

// By keys the turn, by mouse the way, by keys what is left of it.
async function moveScan(page, { x, y, theta }) {
  await press(page, theta > 0 ? "q" : "e", Math.round(Math.abs(theta) / kTurn_rad));
  const size = await pixelSizeFor(page, Math.hypot(x, y));
  const [east, north] = await dragScan(page, [Math.round(x / size), -Math.round(y / size)]);
  await press(page, x > east ? "ArrowRight" : "ArrowLeft", Math.round(Math.abs(x - east) / kStep_m));
  await press(page, y > north ? "ArrowUp" : "ArrowDown", Math.round(Math.abs(y - north) / kStep_m));
}

// Returns whether the answer changed the pose.
async function answer(page, request, index) {
  const { estimate, reference } = request;
  const seen = between(truth.get(reference.stamp_ns), truth.get(request.stamp_ns));
  const right = compose(reference, seen);
  const off = { x: right.x - estimate.x, y: right.y - estimate.y, theta: angle(right.theta - estimate.theta) };
  const button = page.locator("#requests button").nth(index);
  await button.click();
  await page.waitForTimeout(500); // the map goes there
  const change = Math.hypot(off.x, off.y) > kSeen_m || Math.abs(off.theta) > kSeen_rad;
  if (change) await moveScan(page, off);
  await page.keyboard.press("Enter");
  await page.waitForFunction((i) => document.querySelectorAll("#requests button")[i].dataset.state !== "open", index);
  return change;
}

async function answerAll(requests, round) {
  const server = await startServer(site);
  const page = await openPage(browser, server.link, { width: 1920, height: 1080 });
  await page.waitForFunction(() => document.documentElement.dataset.firstPicture);
  await page.fill("#operator", "Test Person");
  let changes = 0;
  for (const [i, request] of requests.entries()) {
    if (request.answer || request.reference?.kind !== "earlier pass") continue;
    changes += await answer(page, request, i);
  }
  await page.screenshot({ path: join(site, `hall-${round}.png`) });
  await server.stop();
  return changes;
}

const before = largestError();
let [answers, changes] = [0, 0];
for (let round = 1; round <= kRounds; ++round) {
  const requests = readRequests();
  const open = requests.filter((request) => !request.answer && request.reference?.kind === "earlier pass");
  if (open.length === 0) break;
  answers += open.length;
  changes += await answerAll(requests, round);
  execFileSync("plumbline", ["run", site], { stdio: "ignore" });
}
await browser.close();
const after = largestError();
console.log(`largest error ${before.toFixed(2)} m, after ${answers} answers, ${changes} changes: ${after.toFixed(2)} m`);
assert.ok(before > kSuccess_m, "the map is a success without a person");
assert.ok(after < kSuccess_m);
