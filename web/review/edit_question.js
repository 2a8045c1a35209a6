// SPDX-License-Identifier: Apache-2.0
//
// The panel below the map when an edit is asked about: red where it lies now, green and dashed as it was drawn, and what
// may become of it.
import { kTools } from "review/edits_on_map.js";
import { causeText } from "review/request_list.js";

const element = (id) => document.getElementById(id);
const kFormat = new ol.format.GeoJSON();
const kLies = new ol.style.Style({ stroke: new ol.style.Stroke({ color: "#d0021b", width: 4 }) });
const kDrawn = new ol.style.Style({ stroke: new ol.style.Stroke({ color: "#00875a", width: 3, lineDash: [8, 6] }) });

function featureOf(geometry, style) {
  const feature = new ol.Feature(kFormat.readGeometry(geometry));
  feature.setStyle(style);
  return feature;
}

export class EditQuestion {
  // `settle` is called with the edit and the geometry that it gets, `redraw` and `retire` with the edit.
  constructor(siteMap, { settle, redraw, retire }) {
    this.map = siteMap.map;
    this.source = new ol.source.Vector();
    siteMap.add(new ol.layer.Vector({ source: this.source, zIndex: 22, properties: { kind: "scan" } }));
    this.settle = settle;
    const click = (id, action) => element(id).addEventListener("click", () => action(this.request.edit));
    click("edit-keep", () => this.keep());
    click("edit-back", (edit) => settle(edit, this.request.drawn));
    click("edit-redraw", redraw);
    click("edit-retire", retire);
  }

  hide() {
    element("edit-question").hidden = true;
    this.source.clear();
  }

  show(request) {
    this.request = request;
    const { edit, drawn } = request;
    element("edit-question").hidden = false;
    element("edit-question-title").textContent = `Request ${request.rank}, block ${request.block}: ${causeText(request)}`;
    element("edit-question-text").textContent = request.causes.map(({ message }) => message).join("; ");
    element("edit-question-why").textContent = edit.why ? `Drawn because: ${edit.why}` : "";
    element("edit-back").disabled = drawn === null;
    element("edit-redraw").disabled = !kTools.some(({ kind }) => kind === edit.kind);
    this.source.clear();
    if (drawn) this.source.addFeature(featureOf(drawn, kDrawn));
    this.source.addFeature(featureOf(edit.geometry, kLies));
    this.map.getView().fit(this.source.getExtent(), { padding: [80, 80, 80, 80], minResolution: 0.01 });
  }

  keep() {
    this.settle(this.request.edit, this.request.edit.geometry);
  }
}
