// SPDX-License-Identifier: Apache-2.0
//
// What must hold for the review page whatever a person does on it.
import assert from "node:assert/strict";

// Text against what is behind it (WCAG 2.1, 1.4.3): [contrast, text], the worst first. Disabled controls are exempt.
function contrasts() {
  const numbers = (colour) => colour.match(/[\d.]+/g).map(Number);
  const linear = (value) => (value <= 10.31475 ? value / 3294.6 : ((value / 255 + 0.055) / 1.055) ** 2.4);
  const luminance = ([r, g, b]) => 0.2126 * linear(r) + 0.7152 * linear(g) + 0.0722 * linear(b);
  const behind = (node) => {
    const colour = numbers(getComputedStyle(node).backgroundColor);
    return colour.length === 3 || colour[3] > 0.5 || !node.parentElement ? colour : behind(node.parentElement);
  };
  const hasText = (node) => [...node.childNodes].some(({ nodeType, data }) => nodeType === Node.TEXT_NODE && data.trim());
  const shown = [...document.body.querySelectorAll("*")].filter(
    (node) => node.checkVisibility() && !node.closest(":disabled, option") && hasText(node),
  );
  return shown
    .map((node) => {
      const [a, b] = [numbers(getComputedStyle(node).color), behind(node)].map(luminance).sort((x, y) => y - x);
      return [(a + 0.05) / (b + 0.05), node.textContent.trim()];
    })
    .sort(([a], [b]) => a - b);
}

export async function checkContrast(page) {
  const [[least, text], ...others] = await page.evaluate(contrasts);
  assert.ok(others.length > 40);
  assert.ok(least >= 4.5, `${text}: contrast ${least.toFixed(1)}`);
}

// The small circle ahead of the scan, a quarter turn to the left.
export async function checkTurnByMouse(page, { estimate: { theta } }) {
  const box = await page.locator("#map").boundingBox();
  const at = (angle) => [box.x + box.width / 2 + 70 * Math.cos(angle), box.y + box.height / 2 - 70 * Math.sin(angle)];
  await page.mouse.move(...at(theta));
  await page.mouse.down();
  for (const part of [0.5, 1]) await page.mouse.move(...at(theta + (part * Math.PI) / 2));
  await page.mouse.up();
  const turned = (await page.locator("#moved").innerText()).match(/turned (-?[\d.]+)°/)[1];
  assert.ok(Math.abs(Number(turned) - 90) < 2, turned);
  await page.keyboard.press("0");
  assert.equal(await page.locator("#moved").innerText(), "as estimated");
}

// Each layer can be taken away and brought back.
export async function checkLayers(page, kinds) {
  for (const kind of kinds) {
    const pictures = [];
    for (let i = 0; i < 3; ++i) {
      await page.waitForTimeout(400);
      pictures.push((await page.locator("#map canvas").first().screenshot()).toString("base64"));
      await page.locator(`#layers input[value="${kind}"]`).click();
    }
    await page.locator(`#layers input[value="${kind}"]`).click();
    assert.notEqual(pictures[0], pictures[1], kind);
    assert.equal(pictures[0], pictures[2], kind);
  }
}
