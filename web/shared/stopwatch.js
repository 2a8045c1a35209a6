// SPDX-License-Identifier: Apache-2.0
//
// Time and clicks that a decision took: kept with it, so that every job measures what people's work costs.
import { utc } from "shared/decisions.js";

export class Stopwatch {
  constructor() {
    this.start();
    window.addEventListener("pointerdown", () => ++this.clicks, { capture: true });
    window.addEventListener("keydown", ({ repeat }) => repeat || ++this.keys, { capture: true });
  }

  start() {
    this.began = new Date();
    this.clicks = 0;
    this.keys = 0;
  }

  // "review: 3.2 s, 2 clicks, 1 key"
  get tool() {
    const seconds = ((Date.now() - this.began) / 1000).toFixed(1);
    const counted = (count, word) => `${count} ${word}${count === 1 ? "" : "s"}`;
    return `review: ${seconds} s, ${counted(this.clicks, "click")}, ${counted(this.keys, "key")}`;
  }

  // The remarks of an answer on its making.
  about(operator) {
    return { operator, tool: this.tool, shown_at: utc(this.began), answered_at: utc(new Date()) };
  }
}
