// SPDX-License-Identifier: Apache-2.0
//
// The edits that count, newest first, to be looked at and undone.
import { titleOf } from "review/edits_on_map.js";

export class EditList {
  constructor(list, summary, { choose, retire }) {
    this.list = list;
    this.summary = summary;
    this.choose = choose;
    this.retire = retire;
  }

  // `findings`: {kind, uids, message} of the last run.
  show(edits, findings) {
    this.summary.textContent = `${edits.length}`;
    const about = ({ uid }) => findings.filter(({ uids }) => uids.includes(uid)).map(({ message }) => message);
    this.list.replaceChildren(...edits.toReversed().map((edit) => this.#item(edit, about(edit))));
  }

  #item(edit, findings) {
    const item = document.createElement("li");
    const look = document.createElement("button");
    look.textContent = `${titleOf(edit.kind)}${edit.class ? ` (${edit.class})` : ""}`;
    look.title = [edit.who, edit.when, edit.why, ...findings].filter(Boolean).join(" · ");
    look.classList.toggle("doubted", findings.length > 0);
    look.addEventListener("click", () => this.choose(edit));
    const remove = document.createElement("button");
    remove.textContent = "Undo";
    remove.setAttribute("aria-label", `Undo ${titleOf(edit.kind)} by ${edit.who}`);
    remove.className = "small";
    remove.addEventListener("click", () => this.retire(edit));
    item.append(look, remove);
    return item;
  }
}
