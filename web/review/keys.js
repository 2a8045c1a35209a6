// SPDX-License-Identifier: Apache-2.0
//
// Keys of the page; the help text in index.html lists them.
import { kTools } from "review/edits_on_map.js";

const kStep_m = 0.05;
const kFineStep_m = 0.01;
const kTurn_rad = (0.5 * Math.PI) / 180;
const kFineTurn_rad = (0.1 * Math.PI) / 180;

const kDirections = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowDown: [0, -1], ArrowUp: [0, 1] };
const kTurns = { q: 1, e: -1 };

function isTyping({ target }) {
  return target.matches?.("input:not([type=checkbox]), select, textarea");
}

function movesScan(event, scan) {
  const direction = kDirections[event.key];
  const turn = kTurns[event.key.toLowerCase()];
  if (direction) {
    const step = event.shiftKey ? kFineStep_m : kStep_m;
    scan.move(direction[0] * step, direction[1] * step, 0);
  } else if (turn) {
    scan.move(0, 0, turn * (event.shiftKey ? kFineTurn_rad : kTurn_rad));
  }
  return Boolean(direction || turn);
}

// `actions`: by name, what the page can do.
export function listenToKeys(scan, actions) {
  const commands = {
    Enter: actions.accept,
    s: actions.saveCorrection,
    r: actions.rejectStretch,
    k: actions.skip,
    n: actions.next,
    0: actions.resetPose,
    z: actions.undo,
    Escape: actions.putToolDown,
    Backspace: actions.undoPoint,
    "?": actions.help,
  };
  // A button that was pressed by mouse must not take the Enter that is meant for the request.
  window.addEventListener("click", ({ detail, target }) => detail > 0 && target.closest("button")?.blur());
  window.addEventListener("keydown", (event) => {
    if (isTyping(event) || document.querySelector("dialog[open]")) return;
    if ((event.ctrlKey || event.metaKey) && event.key !== "z") return;
    const tool = kTools.find(({ key }) => key === event.key);
    const command = commands[event.key] ?? commands[event.key.toLowerCase()];
    if (event.key === "Enter" && event.target.matches("button, summary")) return; // presses it
    if (movesScan(event, scan)) event.preventDefault();
    else if (tool) actions.useTool(tool);
    else if (command) {
      event.preventDefault();
      command();
    }
  });
}
