// SPDX-License-Identifier: Apache-2.0
//
// Map edits as they are drawn over the map, and the tools that draw them.

// key, kind, how it is drawn. `box`: two corners; `arrow`: from, to.
export const kTools = [
  { key: "1", kind: "line_occupied", title: "Draw wall", shape: "LineString", wide: true },
  { key: "2", kind: "line_free", title: "Erase along line", shape: "LineString", wide: true },
  { key: "3", kind: "area_free", title: "Delete region", shape: "box" },
  { key: "4", kind: "area_unknown", title: "Set unknown", shape: "Polygon" },
  { key: "5", kind: "area_occupied", title: "Fill", shape: "Polygon" },
  { key: "6", kind: "forbidden", title: "Forbidden area", shape: "Polygon" },
  { key: "7", kind: "adjust", title: "Adjust", shape: "arrow" },
  { key: "8", kind: "mask_returns", title: "Mask returns", shape: "Polygon" },
];

const kColours = {
  line_occupied: "#b30000",
  line_free: "#00695c",
  area_free: "#00695c",
  area_unknown: "#5d4037",
  area_occupied: "#b30000",
  cells: "#b30000",
  forbidden: "#c2185b",
  mask_returns: "#6a1b9a",
  adjust: "#0050b3",
};

export function titleOf(kind) {
  return kTools.find((tool) => tool.kind === kind)?.title ?? kind;
}

function arrowHead(geometry, colour) {
  const [from, to] = geometry.getCoordinates();
  return new ol.style.Style({
    geometry: new ol.geom.Point(to),
    image: new ol.style.RegularShape({
      points: 3,
      radius: 9,
      rotation: Math.PI / 2 - Math.atan2(to[1] - from[1], to[0] - from[0]),
      rotateWithView: true,
      fill: new ol.style.Fill({ color: colour }),
    }),
  });
}

function styleOf(feature, resolution) {
  const kind = feature.get("kind");
  const colour = kColours[kind] ?? "#000000";
  const width = Math.max(2.5, (feature.get("width_m") ?? 0) / resolution);
  const stroke = new ol.style.Stroke({
    color: feature.get("selected") ? "#ffb300" : colour,
    width: feature.get("selected") ? width + 3 : width,
    lineDash: kind === "line_free" || kind === "area_free" ? [8, 6] : undefined,
  });
  const style = new ol.style.Style({ stroke, fill: new ol.style.Fill({ color: `${colour}33` }) });
  if (kind !== "adjust") return style;
  return [style, ...feature.getGeometry().getLineStrings().map((line) => arrowHead(line, colour))];
}

const kFormat = new ol.format.GeoJSON();

export class EditsOnMap {
  // `drawn` is called with the tool and the GeoJSON geometry of a new edit.
  constructor(siteMap, drawn) {
    this.map = siteMap.map;
    this.drawn = drawn;
    this.features = new ol.Collection();
    this.sources = { edits: new ol.source.Vector(), keepout: new ol.source.Vector() };
    for (const [kind, source] of Object.entries(this.sources)) {
      siteMap.add(new ol.layer.Vector({ source, style: styleOf, zIndex: 10, properties: { kind, frame: "site" } }));
    }
    this.snap = new ol.interaction.Snap({ features: this.features, pixelTolerance: 8 });
  }

  show(edits) {
    this.features.clear();
    for (const source of Object.values(this.sources)) source.clear();
    for (const edit of edits) {
      const geometry = kFormat.readGeometry(edit.shown ?? edit.geometry);
      const feature = new ol.Feature({ uid: edit.uid, kind: edit.kind, width_m: edit.width_m, geometry });
      this.features.push(feature);
      this.sources[edit.kind === "forbidden" ? "keepout" : "edits"].addFeature(feature);
    }
  }

  select(uid) {
    for (const feature of this.features.getArray()) feature.set("selected", feature.get("uid") === uid);
  }

  extentOf(uid) {
    return this.features.getArray().find((feature) => feature.get("uid") === uid)?.getGeometry().getExtent();
  }

  // Takes up a tool; null puts it down.
  use(tool) {
    if (this.draw) {
      this.map.removeInteraction(this.draw);
      this.map.removeInteraction(this.snap);
      this.draw = null;
    }
    this.tool = tool;
    if (!tool) return;
    this.draw = this.#drawing(tool);
    this.map.addInteraction(this.draw);
    this.map.addInteraction(this.snap);
  }

  undoPoint() {
    this.draw?.removeLastPoint();
  }

  finish() {
    this.draw?.finishDrawing();
  }

  #drawing(tool) {
    const box = tool.shape === "box";
    const arrow = tool.shape === "arrow";
    const draw = new ol.interaction.Draw({
      type: box ? "Circle" : arrow ? "LineString" : tool.shape,
      geometryFunction: box ? ol.interaction.Draw.createBox() : undefined,
      maxPoints: arrow ? 2 : undefined,
      style: new ol.style.Style({
        stroke: new ol.style.Stroke({ color: kColours[tool.kind], width: 3 }),
        fill: new ol.style.Fill({ color: `${kColours[tool.kind]}33` }),
        image: new ol.style.Circle({ radius: 5, fill: new ol.style.Fill({ color: kColours[tool.kind] }) }),
      }),
    });
    draw.on("drawend", ({ feature }) => {
      const geometry = kFormat.writeGeometryObject(feature.getGeometry());
      if (arrow) Object.assign(geometry, { type: "MultiLineString", coordinates: [geometry.coordinates] });
      this.drawn(tool, geometry);
    });
    return draw;
  }
}
