// SPDX-License-Identifier: Apache-2.0
//
// The review server as a process, and a Chromium that looks at it.
import { spawn } from "node:child_process";
import { once } from "node:events";
import { chromium } from "playwright-core";

const kFlags = [
  "--no-sandbox",
  "--disable-gpu",
  "--disable-quic",
  "--no-first-run",
  "--disable-background-networking",
  "--disable-component-update",
  "--disable-sync",
];

export async function startServer(site) {
  const server = spawn("plumbline-review", [site], { stdio: ["ignore", "pipe", "pipe"] });
  process.on("exit", () => server.kill("SIGTERM")); // also when a test fails
  const invitations = [];
  server.stderr.on("data", (text) => invitations.push(...(String(text).match(/http:\S+/g) ?? [])));
  const [first] = await once(server.stdout, "data");
  return {
    link: String(first).trim(),
    nextLink: () => invitations.at(-1), // of the next person
    stop: async () => {
      server.kill("SIGTERM");
      await once(server, "exit");
    },
  };
}

export async function startBrowser() {
  return chromium.launch({ executablePath: "/usr/bin/chromium", args: kFlags });
}

// A page whose errors fail the test.
export async function openPage(browser, link, viewport) {
  const context = await browser.newContext({ viewport });
  const page = await context.newPage();
  page.on("pageerror", (error) => {
    throw error;
  });
  page.on("console", (message) => {
    if (message.type() === "error" && !message.text().includes("412")) throw new Error(message.text());
  });
  await page.goto(link);
  return page;
}

// Site coordinates under the mouse, as the page shows them.
export async function siteUnder(page, [x, y]) {
  await page.mouse.move(x, y);
  const text = await page.locator(".ol-mouse-position").innerText();
  return text.match(/-?\d+\.\d+/g).map(Number);
}

// Clicks on a place of the site that the map shows.
export async function clickSite(page, [x, y]) {
  const box = await page.locator("#map").boundingBox();
  const corners = [[0.25, 0.25], [0.75, 0.75]].map(([u, v]) => [
    Math.round(box.x + u * box.width),
    Math.round(box.y + v * box.height),
  ]);
  const [a, b] = [await siteUnder(page, corners[0]), await siteUnder(page, corners[1])];
  const pixel = (k, value) =>
    corners[0][k] + ((value - a[k]) / (b[k] - a[k])) * (corners[1][k] - corners[0][k]);
  await page.mouse.click(pixel(0, x), pixel(1, y));
}

// Takes hold of the scan at its centre, which the page shows in the middle of the map. Returns how far it was moved.
export async function dragScan(page, [east_px, south_px]) {
  const box = await page.locator("#map").boundingBox();
  const centre = [Math.round(box.x + box.width / 2), Math.round(box.y + box.height / 2)];
  const from = await siteUnder(page, centre);
  const to = await siteUnder(page, [centre[0] + east_px, centre[1] + south_px]);
  await page.mouse.move(...centre);
  await page.mouse.down();
  await page.mouse.move(centre[0] + east_px / 2, centre[1] + south_px / 2);
  await page.mouse.move(centre[0] + east_px, centre[1] + south_px);
  await page.mouse.up();
  return [to[0] - from[0], to[1] - from[1]];
}
