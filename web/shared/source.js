// SPDX-License-Identifier: Apache-2.0
//
// Where a page has its site from and where decisions go: the review server, or data.js beside a page without a server,
// whose decisions are kept in the browser until they are saved as a file for `plumbline review SITE --import FILE`.

export const kDocuments = ["site", "requests", "control", "seams", "answers", "edits"];

// A decision that was not taken over. `stale`: somebody else was faster, so that the state has to be loaded again.
export class Refusal extends Error {
  constructor(message, stale) {
    super(message);
    this.stale = stale;
  }
}

function seen(tag) {
  return tag ? { "If-Match": `"${tag}"` } : { "If-None-Match": "*" };
}

export class ServerSource {
  constructor(build) {
    this.build = build;
    this.keepsFile = false;
  }

  async load(name) {
    const response = await fetch(`/api/${name}`);
    if (!response.ok) throw new Error((await response.json()).error);
    return response.json();
  }

  tileUrl(layer) {
    return `/tiles/${layer.id}/{z}/{x}/{y}.png?v=${layer.version}`;
  }

  // Both return the tag of the new state.
  async putAnswer(block, stamp, answer, tag) {
    return (await this.#send("PUT", `/api/answers/${block}/${stamp}`, seen(tag), answer)).tag;
  }
  async appendEdits(operations, head) {
    return (await this.#send("POST", "/api/edits", seen(head), { operations })).tag;
  }
  async removeAnswer(block, stamp, tag) {
    await this.#send("DELETE", `/api/answers/${block}/${stamp}`, seen(tag));
  }

  async #send(method, path, headers, body) {
    const response = await fetch(path, {
      method,
      headers: { "X-Plumbline-Page": this.build, "Content-Type": "application/json", ...headers },
      body: body === undefined ? undefined : JSON.stringify(body),
    });
    const document = await response.json();
    if (!response.ok) throw new Refusal(document.error, response.status === 412);
    return document;
  }
}

export class StaticSource {
  constructor(data) {
    this.data = data;
    this.keepsFile = true;
    this.key = `plumbline-review ${data.site.name} ${data.edits.head}`;
    const kept = JSON.parse(localStorage.getItem(this.key) ?? "null");
    this.answers = kept?.answers ?? {};
    this.operations = kept?.operations ?? [];
  }

  async load(name) {
    const document = structuredClone(this.data[name]);
    if (name === "answers") this.#overlayAnswers(document);
    if (name === "edits") document.edits = this.#overlaidEdits(document.edits);
    return document;
  }

  tileUrl(layer) {
    return `tiles/${layer.id}/{z}/{x}/{y}.png`;
  }

  async putAnswer(block, stamp, answer) {
    const original = this.data.answers[block]?.[stamp]?.tag ?? "";
    this.answers[`${block}/${stamp}`] = { block, seen: original, answer };
    this.#keep();
    return "kept";
  }
  async removeAnswer(block, stamp) {
    delete this.answers[`${block}/${stamp}`];
    this.#keep();
  }
  async appendEdits(operations, head) {
    this.operations.push(...operations);
    this.#keep();
    return head;
  }

  // The file for `plumbline review --import`.
  saved() {
    const file = {
      format: "plumbline-review",
      format_version: 1,
      answers: Object.values(this.answers),
      operations: this.operations,
    };
    return JSON.stringify(file, null, 1);
  }

  #keep() {
    localStorage.setItem(this.key, JSON.stringify({ answers: this.answers, operations: this.operations }));
  }

  #overlayAnswers(document) {
    for (const { block, answer } of Object.values(this.answers)) {
      (document[block] ??= {})[answer.stamp_ns] = { tag: "kept", answer };
    }
  }

  #overlaidEdits(edits) {
    const byUid = new Map(edits.map((edit) => [edit.uid, edit]));
    for (const operation of this.operations) {
      if (operation.op === "retire") byUid.delete(operation.uid);
      else byUid.set(operation.uid, { rev: 1, ...operation });
    }
    return [...byUid.values()];
  }
}

export function sourceOfPage() {
  if (window.PLUMBLINE) return new StaticSource(window.PLUMBLINE);
  return new ServerSource(document.querySelector("meta[name=plumbline-build]").content);
}
