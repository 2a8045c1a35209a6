// SPDX-License-Identifier: Apache-2.0
//
// What lies on the floor: the map, control points, edits and the scan of a request, all in one group that is placed by
// the alignment. Inside it coordinates count from an origin near by: graphics cards have seven digits.
import * as THREE from "vendor/three/three.module.js";
import { transformed } from "shared/pose.js";

const kMaxTiles = 48;
const kColours = { control: 0x2f8fff, check: 0xff9800, edit: 0xff3d3d, sketch: 0xffe000, scan: 0xff2020 };

function label(text) {
  const canvas = document.createElement("canvas");
  canvas.width = 256;
  canvas.height = 64;
  const context = canvas.getContext("2d");
  context.font = "bold 44px sans-serif";
  context.fillStyle = "#ffffff";
  context.strokeStyle = "#000000";
  context.lineWidth = 8;
  context.textAlign = "center";
  context.strokeText(text, 128, 48);
  context.fillText(text, 128, 48);
  const sprite = new THREE.Sprite(new THREE.SpriteMaterial({ map: new THREE.CanvasTexture(canvas) }));
  sprite.scale.set(0.6, 0.15, 1);
  return sprite;
}

// The finest level of a layer that needs no more tiles than a headset holds.
function levelFor({ extent, resolutions, tile }) {
  const tilesAt = (resolution) =>
    Math.ceil((extent[2] - extent[0]) / (tile * resolution)) * Math.ceil((extent[3] - extent[1]) / (tile * resolution));
  const fine = resolutions.findLastIndex((resolution) => tilesAt(resolution) <= kMaxTiles);
  return Math.max(0, fine);
}

export class FloorScene {
  constructor(source) {
    this.source = source;
    this.scene = new THREE.Scene();
    this.group = new THREE.Group(); // site, from an origin near by
    this.group.visible = false;
    this.map = new THREE.Group();
    this.edits = new THREE.Group();
    this.sketch = new THREE.Group();
    this.scan = new THREE.Group();
    this.group.add(this.map, this.edits, this.scan);
    this.scene.add(this.group, this.sketch, new THREE.AmbientLight(0xffffff, 3));
  }

  setOrigin(origin) {
    this.origin = origin;
  }

  // three.js coordinates inside the group.
  #local([x, y], height = 0) {
    return new THREE.Vector3(x - this.origin[0], height, this.origin[1] - y);
  }

  place(floorFromSite) {
    const [x, y] = transformed(floorFromSite, this.origin);
    this.group.position.set(x, 0, -y);
    this.group.rotation.set(0, floorFromSite[2], 0);
    this.group.visible = true;
  }

  showMap(layer) {
    this.map.clear();
    const level = levelFor(layer);
    const size = layer.tile * layer.resolutions[level];
    const columns = Math.ceil((layer.extent[2] - layer.extent[0]) / size);
    const rows = Math.ceil((layer.extent[3] - layer.extent[1]) / size);
    for (let column = 0; column < columns; ++column) {
      for (let row = 0; row < rows; ++row) this.map.add(this.#tile(layer, level, column, row, size));
    }
  }

  #tile(layer, level, column, row, size) {
    const url = this.source.tileUrl(layer).replace("{z}", level).replace("{x}", column).replace("{y}", row);
    const texture = new THREE.TextureLoader().load(url);
    texture.colorSpace = THREE.SRGBColorSpace;
    texture.magFilter = THREE.NearestFilter;
    const material = new THREE.MeshBasicMaterial({ map: texture, transparent: true, opacity: 0.5, depthWrite: false });
    const plane = new THREE.Mesh(new THREE.PlaneGeometry(size, size), material);
    plane.rotation.x = -Math.PI / 2;
    const [west, north] = layer.origin;
    plane.position.copy(this.#local([west + (column + 0.5) * size, north - (row + 0.5) * size]));
    return plane;
  }

  showControl(points) {
    for (const point of points) {
      const colour = kColours[point.role] ?? 0x888888;
      const ring = new THREE.Mesh(new THREE.RingGeometry(0.06, 0.1, 32), new THREE.MeshBasicMaterial({ color: colour }));
      ring.rotation.x = -Math.PI / 2;
      ring.position.copy(this.#local([point.x, point.y], 0.01));
      const name = label(point.name);
      name.position.copy(this.#local([point.x, point.y], 0.25));
      this.group.add(ring, name);
    }
  }

  #line(points, colour, local) {
    const geometry = new THREE.BufferGeometry().setFromPoints(points.map(local));
    return new THREE.Line(geometry, new THREE.LineBasicMaterial({ color: colour }));
  }

  showEdits(edits) {
    this.edits.clear();
    for (const { geometry } of edits) {
      const lines = geometry.type === "LineString" ? [geometry.coordinates] : geometry.coordinates;
      for (const line of geometry.type === "MultiPolygon" ? lines.flat() : lines) {
        this.edits.add(this.#line(line, kColours.edit, (point) => this.#local(point, 0.02)));
      }
    }
  }

  showScan(points, siteFromScan) {
    this.scan.clear();
    if (!points) return;
    const places = points.map((point) => this.#local(transformed(siteFromScan, point), 0.03));
    const geometry = new THREE.BufferGeometry().setFromPoints(places);
    this.scan.add(new THREE.Points(geometry, new THREE.PointsMaterial({ color: kColours.scan, size: 0.04 })));
  }

  // What is being drawn, on the floor.
  showSketch(points) {
    this.sketch.clear();
    const onFloor = ([x, y]) => new THREE.Vector3(x, 0.03, -y);
    if (points.length > 1) this.sketch.add(this.#line(points, kColours.sketch, onFloor));
    for (const point of points) {
      const dot = new THREE.Mesh(new THREE.SphereGeometry(0.02), new THREE.MeshBasicMaterial({ color: kColours.sketch }));
      dot.position.copy(onFloor(point));
      this.sketch.add(dot);
    }
  }
}
