// SPDX-License-Identifier: Apache-2.0
//
// The lines of a DXF drawing (text form): LINE, LWPOLYLINE, POLYLINE, CIRCLE and ARC of the model space, in metres.
// Bulges, blocks, splines and texts are left out: a backdrop needs the walls.

const kMetresOfUnit = { 1: 0.0254, 2: 0.3048, 4: 0.001, 5: 0.01, 6: 1 };
const kArcStep = Math.PI / 36;

function pairsOf(text) {
  const lines = text.split(/\r?\n/);
  const pairs = [];
  for (let i = 0; i + 1 < lines.length; i += 2) pairs.push([Number(lines[i]), lines[i + 1].trim()]);
  return pairs;
}

function entitiesOf(pairs) {
  const entities = [];
  let section = "";
  for (let i = 0; i < pairs.length; ++i) {
    const [code, value] = pairs[i];
    if (code === 0 && value === "SECTION") section = pairs[i + 1]?.[1] ?? "";
    else if (code === 0 && section === "ENTITIES") entities.push({ type: value, groups: [] });
    else if (entities.length > 0 && section === "ENTITIES") entities.at(-1).groups.push([code, Number(value)]);
  }
  return entities;
}

function valueOf(entity, code) {
  return entity.groups.find(([c]) => c === code)?.[1] ?? 0;
}

function pointsOf(entity) {
  const xs = entity.groups.filter(([code]) => code === 10).map(([, value]) => value);
  const ys = entity.groups.filter(([code]) => code === 20).map(([, value]) => value);
  return xs.map((x, i) => [x, ys[i]]);
}

function arc(entity, from, to) {
  const [x, y, radius] = [10, 20, 40].map((code) => valueOf(entity, code));
  const steps = Math.max(2, Math.ceil((to - from) / kArcStep));
  return Array.from({ length: steps + 1 }, (_, i) => {
    const angle = from + ((to - from) * i) / steps;
    return [x + radius * Math.cos(angle), y + radius * Math.sin(angle)];
  });
}

function arcOf(entity) {
  const from = (valueOf(entity, 50) * Math.PI) / 180;
  const to = (valueOf(entity, 51) * Math.PI) / 180;
  return arc(entity, from, to > from ? to : to + 2 * Math.PI);
}

function closedIf(closed, points) {
  return closed ? [...points, points[0]] : points;
}

// Old polylines spread over several entities: POLYLINE, VERTEX ..., SEQEND.
function oldPolyline(entities, start) {
  const points = [];
  for (let i = start + 1; entities[i]?.type === "VERTEX"; ++i) points.push(...pointsOf(entities[i]));
  return closedIf((valueOf(entities[start], 70) & 1) === 1, points);
}

function lineOf(entity, i, entities) {
  switch (entity.type) {
    case "LINE":
      return [pointsOf(entity)[0], [valueOf(entity, 11), valueOf(entity, 21)]];
    case "LWPOLYLINE":
      return closedIf((valueOf(entity, 70) & 1) === 1, pointsOf(entity));
    case "POLYLINE":
      return oldPolyline(entities, i);
    case "CIRCLE":
      return arc(entity, 0, 2 * Math.PI);
    case "ARC":
      return arcOf(entity);
    default:
      return null;
  }
}

// Lines as arrays of [x, y], m. Error when it is no DXF text or has no lines.
export function linesOfDxf(text) {
  const pairs = pairsOf(text);
  const units = pairs.findIndex(([code, value]) => code === 9 && value === "$INSUNITS");
  const scale = (units >= 0 && kMetresOfUnit[Number(pairs[units + 1][1])]) || 1;
  const lines = entitiesOf(pairs)
    .map(lineOf)
    .filter((line) => line && line.length >= 2 && line.flat().every(Number.isFinite));
  if (lines.length === 0) throw new Error("no LINE, LWPOLYLINE, POLYLINE, CIRCLE or ARC found (is it a text DXF?)");
  return lines.map((line) => line.map(([x, y]) => [x * scale, y * scale]));
}
