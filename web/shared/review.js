// SPDX-License-Identifier: Apache-2.0
//
// What a person decides, sent one after the other, and taken back in the reverse order. Nobody overwrites anybody: where
// somebody else was faster, the page loads what he did; an edit is then added to it, an answer is left to the person.
import { additionOf, retirementOf, revisionOf } from "shared/decisions.js";

export class Review {
  // `changed` is called when answers or edits are other than before.
  constructor(source, { answers, edits }, changed) {
    this.source = source;
    this.changed = changed;
    this.#take(answers, edits);
    this.history = []; // functions that take a decision back
    this.queue = Promise.resolve();
    this.numWaiting = 0;
  }

  // Loads what others did.
  async refresh() {
    const [answers, edits] = await Promise.all([this.source.load("answers"), this.source.load("edits")]);
    this.#take(answers, edits);
    this.changed();
  }

  #take(answers, { edits, head, findings }) {
    this.answers = answers;
    this.edits = edits;
    this.head = head;
    this.findings = findings;
  }

  answer(block, answer) {
    return this.#inTurn(async () => {
      const before = this.answers[block]?.[answer.stamp_ns];
      await this.#put(block, answer, before?.tag);
      this.history.push(() => this.#takeBack(block, answer.stamp_ns, before));
    });
  }

  // Shown at once; taken away again when it is refused.
  add(geometry, attributes) {
    const addition = additionOf(geometry, attributes);
    this.#apply(addition);
    this.changed();
    return this.#inTurn(async () => {
      try {
        await this.#append([addition]);
      } catch (refusal) {
        this.#apply({ ...addition, op: "retire" });
        this.changed();
        throw refusal;
      }
      this.history.push(() => this.#append([retirementOf({ ...addition, rev: 1 }, addition.who, "review: undo")]));
    });
  }

  // Additions that were made elsewhere, all or none.
  append(additions) {
    return this.#inTurn(() => this.#append(additions));
  }

  retire(edit, who) {
    return this.#inTurn(async () => {
      await this.#append([retirementOf(edit, who, "review")]);
      const { rev, uid, basis, shown, geometry, when, ...members } = edit;
      this.history.push(() => this.#append([additionOf(shown ?? geometry, { ...members, who, why: `again: ${uid}` })]));
    });
  }

  // Gives an edit another geometry, tied to the map as it is now. `edit`: of the run that asks about it.
  revise({ uid, rev }, geometry, about) {
    return this.#inTurn(async () => {
      const edit = this.edits.find((candidate) => candidate.uid === uid);
      if (edit?.rev !== rev) throw new Error("somebody has settled this already");
      const revision = revisionOf(edit, geometry, about);
      await this.#append([revision]);
      const before = edit.shown ?? edit.geometry;
      this.history.push(() => this.#append([revisionOf(revision, before, { ...about, tool: "review: undo" })]));
    });
  }

  // Takes the last decision back; false when there is none.
  undo() {
    return this.#inTurn(async () => {
      const takeBack = this.history.pop();
      if (takeBack) await takeBack();
      return takeBack !== undefined;
    });
  }

  // What is shown already but not yet stored.
  get isSaving() {
    return this.numWaiting > 0;
  }

  #inTurn(step) {
    ++this.numWaiting;
    const result = this.queue.then(step).finally(() => --this.numWaiting);
    this.queue = result.catch(() => {});
    return result;
  }

  async #put(block, answer, tag) {
    try {
      const now = await this.source.putAnswer(block, answer.stamp_ns, answer, tag);
      (this.answers[block] ??= {})[answer.stamp_ns] = { tag: now, answer };
      this.changed();
    } catch (refusal) {
      if (refusal.stale) await this.refresh();
      throw refusal;
    }
  }

  async #takeBack(block, stamp, before) {
    const { tag } = this.answers[block][stamp];
    if (before) return this.#put(block, before.answer, tag);
    await this.source.removeAnswer(block, stamp, tag);
    delete this.answers[block][stamp];
    this.changed();
  }

  async #append(operations) {
    try {
      this.head = await this.source.appendEdits(operations, this.head);
    } catch (refusal) {
      if (!refusal.stale) throw refusal;
      await this.refresh();
      this.head = await this.source.appendEdits(operations, this.head);
    }
    for (const operation of operations) this.#apply(operation);
    this.changed();
  }

  #apply(operation) {
    this.edits = this.edits.filter(({ uid }) => uid !== operation.uid);
    if (operation.op !== "retire") this.edits.push({ rev: 1, ...operation, op: undefined });
  }
}
