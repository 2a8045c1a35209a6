// SPDX-License-Identifier: Apache-2.0
//
// Two walls that lie alike, one of the doubtful scan and one of the scan that it is measured from. Each is given by two
// clicks, which go to the nearest point of its scan.

const kPrompts = [
  "click one end of a wall of the red scan",
  "click its other end",
  "click one end of the wall of the blue scan",
  "click its other end",
];
const kShortest_m = 0.5;

function nearest(points, [x, y]) {
  const away = (point) => Math.hypot(point[0] - x, point[1] - y);
  return points.reduce((best, point) => (away(point) < away(best) ? point : best));
}

export class WallPair {
  // `tell` is called with what to do next, `done` with the relation and the four ends in the site.
  constructor(siteMap, scan, { tell, done }) {
    this.scan = scan;
    this.tell = tell;
    this.done = done;
    this.relation = null; // that is being given
    this.shown = new ol.Feature();
    this.shown.setStyle(
      new ol.style.Style({
        stroke: new ol.style.Stroke({ color: "#00875a", width: 4 }),
        image: new ol.style.Circle({ radius: 5, fill: new ol.style.Fill({ color: "#00875a" }) }),
      }),
    );
    const source = new ol.source.Vector({ features: [this.shown] });
    siteMap.add(new ol.layer.Vector({ source, zIndex: 21, properties: { kind: "scan" } }));
    siteMap.map.on("click", ({ coordinate }) => this.#click(coordinate));
    siteMap.map.on("dblclick", () => !this.tookClick); // ends that are clicked quickly do not zoom
  }

  // null: nothing is being given any more.
  start(relation) {
    this.relation = relation;
    this.scan.held = relation !== null; // a click must not move it
    this.#keep([]);
    if (relation) this.tell(kPrompts[0]);
  }

  undoPoint() {
    this.#keep(this.ends.slice(0, -1));
    this.tell(kPrompts[this.ends.length]);
  }

  #keep(ends) {
    this.ends = ends;
    const walls = [ends.slice(0, 2), ends.slice(2)].filter((wall) => wall.length === 2);
    const parts = [new ol.geom.MultiPoint(ends), new ol.geom.MultiLineString(walls)];
    this.shown.setGeometry(new ol.geom.GeometryCollection(parts));
  }

  #click(coordinate) {
    this.tookClick = this.relation !== null;
    if (!this.relation) return;
    const onRed = this.ends.length < 2;
    const end = nearest(onRed ? this.scan.pointsOnSite : this.scan.referenceOnSite, coordinate);
    const secondEnd = this.ends.length % 2 === 1;
    if (secondEnd && Math.hypot(end[0] - this.ends.at(-1)[0], end[1] - this.ends.at(-1)[1]) < kShortest_m) {
      this.tell(`the ends of a wall must be ${kShortest_m} m apart`, true);
      return;
    }
    this.#keep([...this.ends, end]);
    if (this.ends.length < kPrompts.length) this.tell(kPrompts[this.ends.length]);
    else this.done(this.relation, this.ends);
  }
}
