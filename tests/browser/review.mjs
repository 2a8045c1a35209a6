// SPDX-License-Identifier: Apache-2.0
//
// Ten answers and twenty edits through the page in one go, by mouse and keys: all of them are on disk to the
// millimetre, and the next run does exactly what depends on them.
//   node review.mjs SITE
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { readdirSync, readFileSync } from "node:fs";
import { join } from "node:path";
import { checkContrast, checkLayers, checkTurnByMouse } from "./page_checks.mjs";
import { writeRequests } from "./requests.mjs";
import { clickSite, dragScan, openPage, siteUnder, startBrowser, startServer } from "./server.mjs";

const kStep_m = 0.05;
const kTurn_rad = (0.5 * Math.PI) / 180;
const kMillimetre = 0.0011; // the position that the page shows is rounded, too

const site = process.argv[2];
const requests = writeRequests(site, 10);
const server = await startServer(site);
const browser = await startBrowser();
const page = await openPage(browser, server.link, { width: 1920, height: 1080 });
await page.waitForFunction(() => document.documentElement.dataset.firstPicture);
console.log(`first picture: ${await page.evaluate(() => document.documentElement.dataset.firstPicture)} ms`);
await page.fill("#operator", "Test Person");
await page.screenshot({ path: join(site, "request.png") });

const settled = (text) => page.waitForFunction((t) => document.querySelector("#status").textContent.includes(t), text);
const press = async (...keys) => {
  for (const key of keys) await page.keyboard.press(key);
};
const times = (count, key) => Array(count).fill(key);

const siteAt = (pixel) => siteUnder(page, pixel);

async function numAnswered() {
  return page.locator('#requests button:not([data-state="open"])').count();
}

await checkContrast(page);
await checkTurnByMouse(page, requests[0]);

// ---------------------------------------------------------------------------------------------------------- answers

// A wall of the shown scan and the like one of its reference, in their own frames: ends of the points' long side.
const kWall = [[2, -1], [2, 0.9]];

async function relateWalls({ estimate, reference }) {
  await page.locator('#walls button[data-relation="parallel"]').click();
  for (const [pose, end] of [estimate, reference].flatMap((pose) => kWall.map((end) => [pose, end]))) {
    const [c, s] = [Math.cos(pose.theta), Math.sin(pose.theta)];
    await clickSite(page, [pose.x + c * end[0] - s * end[1], pose.y + s * end[0] + c * end[1]]);
  }
}

// One of the first, where the platform went straight on from its reference.
const straight = ({ estimate, reference }) => Math.abs(Math.sin(estimate.theta - reference.theta)) < 0.3;
const related = requests.slice(0, 4).findIndex(straight);
assert.ok(related >= 0);

const firstShown = Date.now();
const offsets = new Map(); // by stamp: how far the person moved the scan (east, north, turn)
await page.locator("#map").click({ position: { x: 5, y: 5 } }); // keys go to the page, not to the name
for (const [i, request] of requests.entries()) {
  if (i === related) {
    await relateWalls(request);
  } else if (i < 4) {
    offsets.set(request.stamp_ns, [0, 0, 0]);
    await press("Enter");
  } else if (i < 7) {
    offsets.set(request.stamp_ns, [2 * kStep_m, -kStep_m, (i - 5) * kTurn_rad]);
    await press(...times(2, "ArrowRight"), "ArrowDown", ...(i === 4 ? ["e"] : i === 6 ? ["q"] : []), "Enter");
  } else if (i === 7) {
    offsets.set(request.stamp_ns, [...(await dragScan(page, [120, -60])), 0]);
    await press("Enter");
  } else if (i === 8) {
    await page.locator("#modes button").click();
    await press("Enter");
  } else {
    await press("r");
  }
  await page.waitForFunction((n) => document.querySelectorAll('#requests button:not([data-state="open"])').length === n, i + 1);
}
assert.equal(await numAnswered(), 10);
console.log(`seconds per answer: ${((Date.now() - firstShown) / 10000).toFixed(1)}`);

// The same geometry, written down a second time.
function poseInReference({ estimate, reference }, [east, north, turn]) {
  const [dx, dy] = [estimate.x + east - reference.x, estimate.y + north - reference.y];
  const [c, s] = [Math.cos(reference.theta), Math.sin(reference.theta)];
  return [c * dx + s * dy, c * dy - s * dx, estimate.theta + turn - reference.theta];
}

function answersOnDisk() {
  const answers = new Map();
  for (const block of ["A", "B"]) {
    const folder = join(site, "blocks", block, "answers");
    for (const name of readdirSync(folder)) {
      const text = readFileSync(join(folder, name), "utf8");
      answers.set(text.match(/^ "stamp_ns": (\d+)/m)[1], JSON.parse(text));
    }
  }
  return answers;
}

function checkAnswers() {
  const answers = answersOnDisk();
  assert.equal(answers.size, 10);
  for (const [stamp, offset] of offsets) {
    const answer = answers.get(stamp);
    const request = requests.find((candidate) => candidate.stamp_ns === stamp);
    const expected = poseInReference(request, offset);
    assert.equal(answer.decision, offset.every((value) => value === 0) ? "confirm" : "correct");
    for (const k of [0, 1]) {
      assert.ok(Math.abs(answer.pose[k] - expected[k]) < kMillimetre, `${stamp}: ${answer.pose}, expected ${expected}`);
    }
    assert.ok(Math.abs(Math.sin(answer.pose[2] - expected[2])) < 1e-5);
    assert.match(answer.tool, /^review: \d+\.\d s, \d+ clicks?, \d+ keys?$/);
    assert.ok(answer.shown_at <= answer.answered_at);
  }
  const [, , , , , , , , picked, rejected] = requests;
  assert.equal(answers.get(picked.stamp_ns).decision, "pick");
  const walls = answers.get(requests[related].stamp_ns);
  assert.equal(walls.decision, "relate");
  assert.equal(walls.relation, "parallel");
  for (const wall of [walls.wall, walls.ref.wall]) {
    for (const k of [0, 1]) assert.ok(Math.hypot(wall[k][0] - kWall[k][0], wall[k][1] - kWall[k][1]) < kMillimetre, wall);
  }
  assert.equal(answers.get(rejected.from_ns).decision, "reject_stretch");
}
checkAnswers();

// ------------------------------------------------------------------------------------------------------------ edits

// Tool, and corners in pixels from the middle of the map.
const kShapes = { line: [[0, 0], [160, 30]], box: [[0, 0], [90, 70]], area: [[0, 0], [110, 10], [60, 90]] };
const kDrawn = [
  ["1", "line_occupied", "line"],
  ["2", "line_free", "line"],
  ["3", "area_free", "box"],
  ["4", "area_unknown", "area"],
  ["5", "area_occupied", "area"],
  ["6", "forbidden", "area"],
  ["7", "adjust", "line"],
];

async function draw(key, corners, kind) {
  await press(key);
  const points = [];
  for (const corner of corners) {
    points.push(await siteAt(corner));
    await page.mouse.down();
    await page.mouse.up();
    await page.waitForTimeout(300); // two clicks close together would be a double click
  }
  if (kind !== "area_free" && kind !== "adjust") await press("Enter"); // these end with their second point
  return points;
}

async function drawTwenty() {
  const box = await page.locator("#map").boundingBox();
  const expected = [];
  for (let i = 0; i < 20; ++i) {
    const [key, kind, shape] = kDrawn[i % kDrawn.length];
    const place = [box.x + 80 + 230 * (i % 4), box.y + 60 + 130 * Math.floor(i / 4)]; // on the map
    const corners = kShapes[shape].map(([x, y]) => [Math.round(place[0] + x), Math.round(place[1] + y)]);
    expected.push({ kind, points: await draw(key, corners, kind) });
    await page.waitForFunction((n) => document.querySelectorAll("#edits li").length === n, i + 1);
    await press("Escape");
  }
  return expected;
}

const began = Date.now();
await page.screenshot({ path: join(site, "answered.png") });
const expectedEdits = await drawTwenty();
console.log(`seconds per edit: ${((Date.now() - began) / 20000).toFixed(1)}`);
await page.screenshot({ path: join(site, "edits.png") });

function ledger() {
  const text = readFileSync(join(site, "edits", "ledger.jsonl"), "utf8");
  return text.trim().split("\n").map((line) => JSON.parse(line));
}

// The page shows an edit at once and stores it then.
async function stored(numLines) {
  while (ledger().length < numLines) await page.waitForTimeout(100);
}

function checkEdits(expected) {
  const lines = ledger();
  assert.equal(lines.length, expected.length);
  for (const [i, { kind, points }] of expected.entries()) {
    assert.equal(lines[i].kind, kind);
    assert.equal(lines[i].who, "Test Person");
    const drawn = lines[i].geometry.coordinates.flat(Infinity);
    for (const [x, y] of points) {
      const near = drawn.some((value, k) => k % 2 === 0 && Math.hypot(value - x, drawn[k + 1] - y) < 2 * kMillimetre);
      assert.ok(near, `${kind}: ${x} ${y} is not among ${drawn}`);
    }
  }
}
await stored(20);
checkEdits(expectedEdits);

// Undo is a line more, never one less.
await press("z");
await settled("undone");
assert.equal(ledger().at(-1).op, "retire");
assert.equal(await page.locator("#edits li").count(), 19);

// The times of a request for a mask over the people in its scan.
await page.locator("#requests button").first().click();
await press("8");
await page.locator("#mask-of-request").click();
assert.equal(await page.inputValue("#mask-from"), requests[0].from_ns);
assert.equal(await page.inputValue("#mask-until"), requests[0].until_ns);
await page.screenshot({ path: join(site, "mask.png") });
await press("Escape");
await checkLayers(page, ["uncertainty", "control", "edits", "keepout"]);
assert.equal(await page.locator("#mask-times").isVisible(), false);

// ---------------------------------------------------------------------------------------- somebody else, meanwhile

const inDoubt = ledger().slice(0, 4); // a wall, an erased line, a region, an area set to unknown
const about = writeRequests(site, 10, inDoubt).slice(10);
const other = await openPage(browser, server.nextLink(), { width: 1024, height: 768 });
await other.waitForFunction(() => document.documentElement.dataset.firstPicture);
await other.fill("#operator", "Other Person");
await other.locator("#map").click({ position: { x: 5, y: 5 } });
await other.screenshot({ path: join(site, "tablet.png") });

// Edits that could not follow the map: kept, put back, drawn anew, retired.
const numSettled = (count) =>
  other.waitForFunction((n) => document.querySelectorAll('#requests button:not([data-state="open"])').length === n, count);
await other.keyboard.press("Enter");
await numSettled(11);
await other.locator("#edit-back").click();
await numSettled(12);
await other.locator("#edit-redraw").click();
const corners = [];
for (const pixel of [[400, 300], [460, 340]]) {
  corners.push(await siteUnder(other, pixel));
  await other.mouse.down();
  await other.mouse.up();
  await other.waitForTimeout(300);
}
await numSettled(13);
await other.locator("#edit-retire").click();
await numSettled(14);
assert.equal(await other.locator("#edit-question").isVisible(), false, "nothing more is asked");

function checkSettled() {
  const lines = ledger().slice(-4);
  assert.deepEqual(lines.map(({ op }) => op), ["modify", "modify", "modify", "retire"]);
  assert.deepEqual(lines.map(({ uid }) => uid), inDoubt.map(({ uid }) => uid));
  assert.deepEqual(lines.map(({ rev }) => rev), [2, 2, 2, 2]);
  for (const { who } of lines) assert.equal(who, "Other Person");
  assert.deepEqual(lines[0].geometry, inDoubt[0].geometry);
  assert.equal(lines[0].width_m, inDoubt[0].width_m);
  const [first] = lines[1].geometry.coordinates;
  const [meant] = about[1].drawn.coordinates;
  for (const k of [0, 1]) assert.ok(Math.abs(first[k] - meant[k]) < kMillimetre, `${first}, meant ${meant}`);
  for (const corner of corners) {
    const near = lines[2].geometry.coordinates[0].some(([x, y]) => Math.hypot(x - corner[0], y - corner[1]) < 2 * kMillimetre);
    assert.ok(near, `${corner} is not among ${lines[2].geometry.coordinates}`);
  }
}
checkSettled();

await other.locator("#edits li button.small").first().click(); // undoes an edit that the first page still shows
await other.waitForFunction(() => document.querySelectorAll("#edits li").length === 17);
await page.locator("#requests button").first().click();
await draw("1", [[700, 300], [900, 320]], "line_occupied"); // on a state that is stale by now
await settled("Draw wall: saved");
assert.equal(ledger().length, 27);
assert.equal(await page.locator("#edits li").count(), 18); // what the other person undid and retired is gone, too

// -------------------------------------------------------------------------------------------------- architect's plan

// Groups of a DXF text: code, value, code, value ...
const dxf = (...groups) => groups.join("\n") + "\n";
const kDxf = dxf(
  ...[0, "SECTION", 2, "HEADER", 9, "$INSUNITS", 70, 4, 0, "ENDSEC", 0, "SECTION", 2, "ENTITIES"], // 4: millimetres
  ...[0, "LINE", 8, "walls", 10, 500102000, 20, 5600203000, 11, 500105500, 21, 5600203250],
  ...[0, "LWPOLYLINE", 90, 3, 70, 1, 10, 500101000, 20, 5600201000, 10, 500103000, 20, 5600201000],
  ...[10, 500103000, 20, 5600202000, 0, "ENDSEC", 0, "EOF"],
);

async function checkBackdrops() {
  const lines = await page.evaluate(async (text) => (await import("review/dxf.js")).linesOfDxf(text), kDxf);
  assert.deepEqual(lines[0], [[500102, 5600203], [500105.5, 5600203.25]]);
  assert.deepEqual(lines[1].at(-1), [500101, 5600201]); // closed
  const picture = { name: "plan.png", mimeType: "image/png", buffer: readFileSync(join(site, "out", "site.png")) };
  const worldFile = (text) => ({ name: "plan.pgw", mimeType: "text/plain", buffer: Buffer.from(text) });
  await page.setInputFiles("#backdrop", [picture]);
  await settled("together with its world file");
  await page.setInputFiles("#backdrop", [worldFile("0.05 0.01 0.01 -0.05 0 0"), picture]);
  await settled("turns the picture");
  await page.setInputFiles("#backdrop", [picture, worldFile("1 0 0 -1 7 9")]);
  await settled("outside the map");
  await page.setInputFiles("#backdrop", [picture, worldFile(readFileSync(join(site, "out", "site.pgw"), "utf8"))]);
  await settled("plan.png: shown");
  await page.setInputFiles("#backdrop", [{ name: "plan.dxf", mimeType: "text/plain", buffer: Buffer.from(kDxf) }]);
  await settled("plan.dxf: shown");
  await page.screenshot({ path: join(site, "plan.png") });
}
await checkBackdrops();

// -------------------------------------------------------------------------------------------------- frames, the run

async function framesWhilePanning() {
  await page.evaluate(() => {
    window.frameTimes = [];
    const tick = (now) => window.frameTimes.push(now) < 1000 && requestAnimationFrame(tick);
    requestAnimationFrame(tick);
  });
  await press("Escape");
  await page.mouse.move(1500, 200);
  await page.mouse.down();
  for (let i = 0; i < 60; ++i) await page.mouse.move(1500 - 12 * i, 200 + 3 * i);
  await page.mouse.up();
  const gaps = await page.evaluate(() => window.frameTimes.slice(1).map((time, i) => time - window.frameTimes[i]));
  gaps.sort((a, b) => a - b);
  console.log(`panning: ${gaps.length} frames, median ${gaps[gaps.length >> 1].toFixed(0)} ms, longest ${gaps.at(-1).toFixed(0)} ms`);
}
await framesWhilePanning();
await browser.close();
await server.stop();

const stages = String(execFileSync("plumbline", ["run", site])).trim().split("\n").sort();
console.log(`stages that ran: ${stages.join(", ")}`);
for (const stage of ["ingest", "network"]) assert.ok(!stages.some((run) => run.endsWith(stage)), `${stage} ran again`);
for (const stage of ["A track", "A adjust", "B adjust", "A edit", "B edit", "stitch"]) assert.ok(stages.includes(stage), stage);
assert.equal(String(execFileSync("plumbline", ["run", site])), "");

// -------------------------------------------------------------------------------------------------- without a server

execFileSync("plumbline-review", [site, "--static", join(site, "page")]);
const offline = await startBrowser();
const folder = await openPage(offline, `file://${join(site, "page", "index.html")}`, { width: 1280, height: 800 });
await folder.waitForFunction(() => document.documentElement.dataset.firstPicture);
await folder.fill("#operator", "Third Person");
await folder.locator("#tools button").first().click();
for (const [x, y] of [[500, 300], [600, 330]]) {
  await folder.mouse.click(x, y);
  await folder.waitForTimeout(300);
}
await folder.keyboard.press("Enter");
await folder.waitForFunction(() => document.querySelector("#status").textContent.includes("saved"));
await folder.reload(); // what was decided is still there
await folder.waitForFunction(() => document.querySelectorAll("#edits li").length === 19);
const [download] = await Promise.all([folder.waitForEvent("download"), folder.locator("#save").click()]);
await download.saveAs(join(site, "saved.json"));
await offline.close();
execFileSync("plumbline-review", [site, "--import", join(site, "saved.json")]);
assert.equal(ledger().length, 28);
assert.equal(ledger().at(-1).who, "Third Person");
