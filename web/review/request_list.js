// SPDX-License-Identifier: Apache-2.0
//
// The requests, most doubtful first, and what the person has said to each.
import { titleOf } from "review/edits_on_map.js";

const kCauses = {
  neff: "particles disagree",
  odometry_only: "no scan match, wheels only",
  inertial_only: "no scan match, IMU only",
  constant_velocity_only: "no scan match at all",
  break: "track may be broken",
  several_modes: "several places fit",
  engines_disagree: "two methods disagree",
  contradiction: "another pass saw through these walls",
  loop_rejected: "a loop was not believed",
  control_residual: "does not fit a control point",
  edit_review: "an edit could not follow the map",
  stale: "newer scans contradict an edit",
};

export const kDecisions = {
  confirm: "confirmed",
  correct: "corrected",
  pick: "picked",
  reject_stretch: "stretch rejected",
  relate: "walls related",
  skip: "skipped",
  renewed: "settled",
  retired: "retired",
};

export function causeText(request) {
  const causes = request.causes.map(({ cause }) => kCauses[cause] ?? cause).join(", ");
  return request.kind === "edit" ? `${causes}: ${titleOf(request.edit.kind)}` : causes;
}

// The answers that lie in the stretch of a request, as {block: {stamp: {tag, answer}}} has them.
export function answerFor(request, answers) {
  const from = BigInt(request.from_ns);
  const until = BigInt(request.until_ns);
  for (const [stamp, entry] of Object.entries(answers[request.block] ?? {})) {
    if (BigInt(stamp) >= from && BigInt(stamp) <= until) return entry;
  }
  return null;
}

// What was decided about a request: the word of an answer; of an edit, whether somebody has said something about it since
// the run that asks. null: nothing.
export function decisionOn(request, { answers, edits }) {
  if (request.kind !== "edit") return answerFor(request, answers)?.answer.decision ?? null;
  const edit = edits.find(({ uid }) => uid === request.edit.uid);
  if (!edit) return "retired";
  return edit.rev > request.edit.rev ? "renewed" : null;
}

export class RequestList {
  constructor(list, summary, choose) {
    this.list = list;
    this.summary = summary;
    this.choose = choose;
    this.buttons = new Map();
  }

  // `decided`: {answers, edits}.
  show(requests, decided) {
    this.requests = requests;
    this.buttons.clear();
    this.list.replaceChildren(...requests.map((request) => this.#item(request)));
    this.refresh(decided);
  }

  #item(request) {
    const item = document.createElement("li");
    const button = document.createElement("button");
    const title = document.createElement("b");
    title.textContent = `${request.rank}  ${request.block}`;
    const doubt = document.createElement("span");
    doubt.className = "doubt";
    doubt.textContent = `±${request.score.toFixed(2)} m`;
    const text = document.createElement("span");
    text.className = "cause";
    text.textContent = causeText(request);
    const state = document.createElement("span");
    state.className = "state";
    button.append(title, doubt, text, state);
    button.addEventListener("click", () => this.choose(request));
    item.append(button);
    this.buttons.set(request.id, button);
    return item;
  }

  refresh(decided) {
    let open = 0;
    for (const request of this.requests) {
      const decision = decisionOn(request, decided);
      const button = this.buttons.get(request.id);
      button.dataset.state = decision ?? "open";
      button.querySelector(".state").textContent = decision ? kDecisions[decision] ?? decision : "";
      if (!decision) ++open;
    }
    this.summary.textContent = this.requests.length === 0 ? "no requests" : `${open} open of ${this.requests.length}`;
  }

  select(request) {
    for (const [id, button] of this.buttons) button.setAttribute("aria-current", String(id === request?.id));
    this.buttons.get(request?.id)?.scrollIntoView({ block: "nearest" });
  }

  // The next one without an answer behind `request`, from the top again at the end.
  nextOpen(request, decided) {
    const from = this.requests.findIndex(({ id }) => id === request?.id) + 1;
    const inOrder = [...this.requests.slice(from), ...this.requests.slice(0, from)];
    return inOrder.find((candidate) => !decisionOn(candidate, decided)) ?? null;
  }
}
