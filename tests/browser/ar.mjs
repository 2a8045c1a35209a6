// SPDX-License-Identifier: Apache-2.0
//
// The page for headsets, with an emulated one (iwer): the room is turned and shifted against the site, every point is
// aimed at with 2 cm of noise, and what arrives on disk lies within 5 cm of what was meant.
//   node ar.mjs SITE
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { join } from "node:path";
import { writeRequests } from "./requests.mjs";
import { openPage, startBrowser, startServer } from "./server.mjs";

const kNoise_m = 0.02 / Math.SQRT2; // per axis: 2 cm is the rms of the distance
const kBound_m = 0.05;
const kSiteFromRoom = [500108.3, 5600204.6, (37 * Math.PI) / 180];
const kControl = { 1: [500102, 5600202], 2: [500106, 5600202], 3: [500106, 5600208], 4: [500110, 5600202] };

const site = process.argv[2];
const [request, confirmed] = writeRequests(site, 2); // of block A and of block B
const server = await startServer(site);
const browser = await startBrowser();
const page = await openPage(browser, server.link, { width: 1280, height: 800 });
const iwer = createRequire(import.meta.url).resolve("iwer/build/iwer.js");
await page.addInitScript({
  content: `${readFileSync(iwer, "utf8")}
    window.headset = new IWER.XRDevice(IWER.metaQuest3);
    headset.installRuntime({ forceInstall: true });
    headset.position.set(0, 1.6, 0);`,
});
await page.goto(new URL("/ar/", server.link).href);
await page.waitForFunction(() => document.querySelector("#status").textContent === "ready");
await page.fill("#operator", "Test Person");
await page.locator("#enter").click();
const status = () => page.evaluate(() => document.querySelector("#status").textContent);
const told = (text) => page.waitForFunction((t) => document.querySelector("#status").textContent.includes(t), text);
await told("aim at point");

// Repeatable normal noise by Box and Muller.
let state = 20261128;
function uniform() {
  state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
  return (state + 0.5) / 2 ** 32;
}
const normal = () => Math.sqrt(-2 * Math.log(uniform())) * Math.cos(2 * Math.PI * uniform());

function toRoom([x, y]) {
  const [dx, dy] = [x - kSiteFromRoom[0], y - kSiteFromRoom[1]];
  const [c, s] = [Math.cos(kSiteFromRoom[2]), Math.sin(kSiteFromRoom[2])];
  return { x: c * dx + s * dy, y: 0, z: s * dx - c * dy };
}

// Presses the trigger with the ray from `from` through `to`, both in the headset's space.
async function pressRay(from, to) {
  await page.evaluate(
    ([a, b]) => {
      const { right } = headset.controllers;
      const d = [b.x - a.x, b.y - a.y, b.z - a.z];
      const yaw = Math.atan2(-d[0], -d[2]);
      const pitch = Math.atan2(d[1], Math.hypot(d[0], d[2]));
      const [cy, sy, cp, sp] = [Math.cos(yaw / 2), Math.sin(yaw / 2), Math.cos(pitch / 2), Math.sin(pitch / 2)];
      right.position.set(a.x, a.y, a.z);
      right.quaternion.set(cy * sp, sy * cp, -sy * sp, cy * cp);
    },
    [from, to],
  );
  for (const value of [1, 0]) {
    await page.waitForTimeout(120); // some frames
    await page.evaluate((v) => headset.controllers.right.updateButtonValue("trigger", v), value);
  }
  await page.waitForTimeout(120);
}

async function aimAt(point) {
  const floor = toRoom([point[0] + kNoise_m * normal(), point[1] + kNoise_m * normal()]);
  await pressRay({ x: floor.x + 0.2, y: 1.2, z: floor.z + 0.5 }, floor);
}

const choose = (tool) => page.evaluate((t) => document.querySelector(`[data-tool=${t}]`).click(), tool);

// Align on four points: the page names the one to aim at.
for (let i = 0; i < 4; ++i) {
  const name = (await status()).match(/aim at point (\w+)/)[1];
  await aimAt(kControl[name]);
}
const aligned = await status();
assert.match(aligned, /4 points, rms \d+ mm/);
console.log(`aligned: ${aligned}`);
await choose("import");

// The menu in the room stands 0.8 m before the viewer; its third button draws a line.
await pressRay({ x: 0, y: 1.4, z: 0 }, { x: 0, y: 1.65 - 2 * 0.07, z: -0.8 });
await told("aim at two points");
const kMeant = {
  line_occupied: [[500103, 5600203], [500107, 5600203.5]],
  area_free: [[500104, 5600205], [500105, 5600206.5]],
  forbidden: [[500109, 5600204], [500112, 5600204], [500111, 5600207]],
  adjust: [[500104, 5600207], [500104.4, 5600207.2]],
};
for (const point of kMeant.line_occupied) await aimAt(point);
await told("line_occupied");
await choose("region");
for (const point of kMeant.area_free) await aimAt(point);
await choose("forbidden");
for (const point of kMeant.forbidden) await aimAt(point);
await choose("forbidden");
await told("forbidden: 3 to send");
await choose("adjust");
for (const point of kMeant.adjust) await aimAt(point);
await choose("line");
for (const point of kMeant.line_occupied) await aimAt(point);
await choose("undo");
await told("4 to send");

// The scan of the request stood half a metre east of where it was estimated, looking north.
const stood = [request.estimate.x + 0.5, request.estimate.y];
await choose("pose");
await aimAt(stood);
await aimAt([stood[0], stood[1] + 3]);
await told("1 answers to send");
await choose("confirm"); // the next scan lies where it was estimated
await told("2 answers to send");
await page.screenshot({ path: join(site, "ar.png") });
await choose("send");
await told("sent 4 edits, 2 answers");
await browser.close();
await server.stop();

const lines = readFileSync(join(site, "edits", "ledger.jsonl"), "utf8").trim().split("\n").map((line) => JSON.parse(line));
assert.deepEqual(lines.map(({ kind }) => kind), Object.keys(kMeant));
let worst = 0;
for (const { kind, geometry, frame, sigma_m: sigma } of lines) {
  assert.equal(frame, "site");
  const least = kind === "adjust" ? 0.05 : 0.01;
  assert.ok(sigma >= least && sigma < least + 0.04, `sigma of the alignment: ${sigma}`);
  const drawn = geometry.coordinates.flat(Infinity);
  for (const [x, y] of kMeant[kind]) {
    const distances = drawn.filter((_, k) => k % 2 === 0).map((value, k) => Math.hypot(value - x, drawn[2 * k + 1] - y));
    worst = Math.max(worst, Math.min(...distances));
  }
}
console.log(`worst vertex: ${(1000 * worst).toFixed(0)} mm`);
assert.ok(worst < kBound_m);

function answerOf(block) {
  const [file] = readdirSync(join(site, "blocks", block, "answers"));
  return JSON.parse(readFileSync(join(site, "blocks", block, "answers", file), "utf8"));
}
const answer = answerOf("A");
// Measured on control: in the site, as sure as the alignment.
assert.equal(answer.decision, "correct");
assert.equal(answer.frame, "site");
assert.equal(answer.ref, undefined);
assert.ok(Math.hypot(answer.pose[0] - stood[0], answer.pose[1] - stood[1]) < kBound_m, `${answer.pose}, meant ${stood}`);
assert.ok(Math.abs(Math.sin(answer.pose[2] - Math.PI / 2)) < 0.03);
const rms = Math.max(0.01, Number(aligned.match(/rms (\d+) mm/)[1]) / 1000);
const expected = [rms, rms, (Math.SQRT2 * rms) / 3];
for (const k of [0, 1, 2]) assert.ok(Math.abs(answer.sigma[k] - expected[k]) < 0.001, `${answer.sigma}, expected ${expected}`);
const eye = answerOf("B");
assert.equal(eye.decision, "confirm");
assert.equal(eye.frame, "site");
assert.ok(Math.hypot(eye.pose[0] - confirmed.estimate.x, eye.pose[1] - confirmed.estimate.y) < 0.001);
assert.ok(Math.abs(eye.sigma[0] - Math.hypot(0.2, rms)) < 0.001, `${eye.sigma}`);
