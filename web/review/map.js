// SPDX-License-Identifier: Apache-2.0
//
// The map: site coordinates in metres as they are, no geographic projection. One frame is shown at a time: the site, or
// the local frame of a block that is tied to nothing.

const kColours = { control: "#0b5394", check: "#a64d00", excluded: "#666666", seam: "#b00070" };

export function siteProjection() {
  return new ol.proj.Projection({ code: "plumbline-site", units: "m", getPointResolution: (resolution) => resolution });
}

function tileLayer(source, layer, projection) {
  const tileGrid = new ol.tilegrid.TileGrid({
    extent: layer.extent,
    origin: layer.origin,
    resolutions: layer.resolutions,
    tileSize: layer.tile,
  });
  return new ol.layer.Tile({
    extent: layer.extent,
    source: new ol.source.XYZ({ projection, tileGrid, url: source.tileUrl(layer), interpolate: false, transition: 0 }),
    properties: { kind: layer.kind, frame: layer.frame },
    visible: layer.kind === "map",
  });
}

function pointStyle(feature, resolution) {
  const colour = kColours[feature.get("role")];
  const text = new ol.style.Text({
    text: resolution < 0.2 ? feature.get("name") : "",
    offsetY: -14,
    font: "bold 13px sans-serif",
    fill: new ol.style.Fill({ color: colour }),
    stroke: new ol.style.Stroke({ color: "#ffffff", width: 3 }),
  });
  const image = new ol.style.RegularShape({
    points: feature.get("role") === "control" ? 3 : 4,
    radius: 8,
    fill: new ol.style.Fill({ color: "#ffffff" }),
    stroke: new ol.style.Stroke({ color: colour, width: 2.5 }),
  });
  return new ol.style.Style({ image, text });
}

function controlLayer(points) {
  const features = points.map(
    ({ name, role, x, y }) => new ol.Feature({ name, role, geometry: new ol.geom.Point([x, y]) }),
  );
  return new ol.layer.Vector({
    source: new ol.source.Vector({ features }),
    style: pointStyle,
    properties: { kind: "control", frame: "site" },
  });
}

function seamLayer(seams) {
  const features = new ol.format.GeoJSON().readFeatures({ ...seams, crs: undefined });
  return new ol.layer.Vector({
    source: new ol.source.Vector({ features }),
    style: new ol.style.Style({ stroke: new ol.style.Stroke({ color: kColours.seam, width: 2.5 }) }),
    properties: { kind: "seams", frame: "site" },
    visible: false,
  });
}

function positionText([x, y]) {
  return `E ${x.toFixed(3)}  N ${y.toFixed(3)}`;
}

export class SiteMap {
  constructor(target, source, documents) {
    this.projection = siteProjection();
    this.layers = [
      ...documents.site.layers.map((layer) => tileLayer(source, layer, this.projection)),
      seamLayer(documents.seams),
      controlLayer(documents.control),
    ];
    this.map = new ol.Map({
      target,
      layers: this.layers,
      controls: [
        new ol.control.Zoom(),
        new ol.control.ScaleLine({ minWidth: 90 }),
        new ol.control.MousePosition({ coordinateFormat: positionText, placeholder: "" }),
      ],
      keyboardEventTarget: document.createElement("div"), // keys move the scan, not the map
    });
    this.frames = [...new Set(documents.site.layers.map((layer) => layer.frame))];
    this.extents = Object.fromEntries(this.frames.map((frame) => [frame, this.#extentOf(frame, documents.site.layers)]));
    this.hidden = new Set(["raw", "uncertainty", "seams"]);
    this.show(this.frames.includes("site") ? "site" : this.frames[0]);
  }

  #extentOf(frame, layers) {
    const extent = ol.extent.createEmpty();
    for (const layer of layers) if (layer.frame === frame) ol.extent.extend(extent, layer.extent);
    return extent;
  }

  // Shows a frame from its edge to its edge; stays where it is when there is no such frame.
  show(frame) {
    if (frame === this.frame || !this.frames.includes(frame)) return;
    this.frame = frame;
    const view = new ol.View({ projection: this.projection, minResolution: 0.001, maxResolution: 20 });
    this.map.setView(view);
    view.fit(this.extents[frame], { size: this.map.getSize(), padding: [20, 20, 20, 20] });
    this.#refresh();
  }

  // `kind`: map, raw, uncertainty, control, seams, edits, backdrop.
  setVisible(kind, visible) {
    if (visible) this.hidden.delete(kind);
    else this.hidden.add(kind);
    this.#refresh();
  }

  add(layer) {
    this.layers.push(layer);
    this.map.addLayer(layer);
    this.#refresh();
  }

  // A plan in the place of the one before: pictures under the map, which then lets them through; drawings over it.
  setBackdrop(layer) {
    const isPicture = layer instanceof ol.layer.Image;
    this.layers = this.layers.filter((other) => other !== this.backdrop);
    if (this.backdrop) this.map.removeLayer(this.backdrop);
    this.backdrop = layer;
    layer.setZIndex(isPicture ? -1 : 5);
    for (const other of this.layers) if (other.get("kind") === "map") other.setOpacity(isPicture ? 0.6 : 1);
    this.add(layer);
  }

  centreOn([x, y], width_m) {
    const view = this.map.getView();
    view.setCenter([x, y]);
    view.setResolution(width_m / Math.max(300, this.map.getSize()[0]));
  }

  #refresh() {
    for (const layer of this.layers) {
      const frame = layer.get("frame");
      layer.setVisible((frame === undefined || frame === this.frame) && !this.hidden.has(layer.get("kind")));
    }
  }
}
