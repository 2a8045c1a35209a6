// SPDX-License-Identifier: Apache-2.0
//
// An architect's plan under the map: a DXF drawing in site coordinates, or a picture with its world file. It stays in the
// browser and goes nowhere.
import { linesOfDxf } from "review/dxf.js";

const kPictures = ["png", "jpg", "jpeg"];
const kWorldFiles = ["pgw", "jgw", "wld", "pngw", "jpgw"];

function extensionOf(file) {
  return file.name.split(".").pop().toLowerCase();
}

// Six lines A D B E C F; C F is the centre of the upper left pixel.
export function extentOfWorldFile(text, width, height) {
  const [a, d, b, e, c, f] = text.trim().split(/\s+/).map(Number);
  if (![a, b, c, d, e, f].every(Number.isFinite)) throw new Error("the world file does not hold six numbers");
  if (b !== 0 || d !== 0 || a <= 0 || e >= 0) throw new Error("the world file turns the picture: export it north up");
  return [c - a / 2, f + e * (height - 0.5), c + a * (width - 0.5), f - e / 2];
}

async function pictureLayer(picture, worldFile, projection) {
  if (!worldFile) throw new Error(`choose ${picture.name} together with its world file (.pgw, .jgw, .wld)`);
  const { width, height } = await createImageBitmap(picture);
  const imageExtent = extentOfWorldFile(await worldFile.text(), width, height);
  const source = new ol.source.ImageStatic({ url: URL.createObjectURL(picture), imageExtent, projection });
  return { layer: new ol.layer.Image({ source, properties: { kind: "backdrop" } }), extent: imageExtent };
}

async function drawingLayer(file) {
  const features = linesOfDxf(await file.text()).map((line) => new ol.Feature(new ol.geom.LineString(line)));
  const source = new ol.source.Vector({ features });
  const style = new ol.style.Style({ stroke: new ol.style.Stroke({ color: "#1565c0", width: 1.5 }) });
  return { layer: new ol.layer.Vector({ source, style, properties: { kind: "backdrop" } }), extent: source.getExtent() };
}

// The layer for the chosen files, and where it lies. Error says what is missing or wrong.
export async function backdropOf(files, projection) {
  const drawing = files.find((file) => extensionOf(file) === "dxf");
  if (drawing) return drawingLayer(drawing);
  const picture = files.find((file) => kPictures.includes(extensionOf(file)));
  if (!picture) throw new Error("choose a .dxf, or a .png or .jpg with its world file");
  const worldFile = files.find((file) => kWorldFiles.includes(extensionOf(file)));
  return pictureLayer(picture, worldFile, projection);
}
