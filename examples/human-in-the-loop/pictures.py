# SPDX-License-Identifier: Apache-2.0
"""Occupancy maps of runs as in figures 9-11 of [AS]: black walls, white floor, grey unknown, fitted on the truth; the true walls in
red, glass in blue."""

import math
import struct
import tomllib
import zlib

import scripted

CELL_M = 0.1
MARGIN_M = 4.0
DRAWN_EVERY = 4  # scans
UNKNOWN, FLOOR, WALL = (190, 190, 190), (255, 255, 255), (0, 0, 0)
TRUE_WALL, TRUE_GLASS = (225, 60, 50), (70, 120, 220)
BETWEEN = 6  # cells between panels


def cells_on_line(a, b):
    steps = max(1, math.ceil(max(abs(b[0] - a[0]), abs(b[1] - a[1]))))
    for i in range(steps + 1):
        yield int(a[0] + (b[0] - a[0]) * i / steps), int(a[1] + (b[1] - a[1]) * i / steps)


class Canvas:
    """Pixels of one cell, north up, over the hall."""

    def __init__(self, scenario):
        self.origin = scenario["origin"]
        lines = [entry["line"] for kind in ("wall", "glass") for entry in scenario[kind]]
        x, y = zip(*(point for line in lines for point in line))
        self.low = (min(x) - MARGIN_M, min(y) - MARGIN_M)
        self.width, self.height = (int((max(v) - min(v) + 2 * MARGIN_M) / CELL_M) for v in (x, y))
        self.pixels = [[UNKNOWN] * self.width for _ in range(self.height)]

    def cell(self, x, y):
        """Of a place in the hall."""
        return ((x - self.low[0]) / CELL_M, self.height - (y - self.low[1]) / CELL_M)

    def paint(self, cells, colour):
        for column, row in cells:
            if 0 <= column < self.width and 0 <= row < self.height:
                self.pixels[row][column] = colour


def returns_of_scan(pose, geometry, ranges):
    for i, text in enumerate(ranges):
        metres = float(text or 0.0)
        if metres > 0.0:
            angle = pose[2] + geometry["angle_min"] + i * geometry["angle_increment"]
            yield pose[0] + metres * math.cos(angle), pose[1] + metres * math.sin(angle)


def draw_scans(canvas, run, poses):
    """Walls where at least as many beams ended as a quarter of those that went through."""
    hits, passed = {}, {}
    with open(run.folder / "field" / "blocks" / "B1" / "scans.csv", encoding="utf-8") as file:
        geometry = {key: float(value) for key, value in (word.split("=") for word in next(file)[1:].split())}
        for pose, line in list(zip(poses, file))[::DRAWN_EVERY]:
            x, y = pose[0] - canvas.origin[0], pose[1] - canvas.origin[1]
            begin = canvas.cell(x, y)
            for place in returns_of_scan((x, y, pose[2]), geometry, line.rstrip().split(",")[1:]):
                cells = list(cells_on_line(begin, canvas.cell(*place)))
                for cell in cells[:-1]:
                    passed[cell] = passed.get(cell, 0) + 1
                hits[cells[-1]] = hits.get(cells[-1], 0) + 1
    canvas.paint(passed, FLOOR)
    canvas.paint((cell for cell, count in hits.items() if 4 * count >= passed.get(cell, 0)), WALL)


def draw_truth(canvas, scenario):
    for kind, colour in (("wall", TRUE_WALL), ("glass", TRUE_GLASS)):
        for entry in scenario[kind]:
            line = entry["line"] + entry["line"][:1] * entry.get("closed", False)
            for a, b in zip(line, line[1:]):
                canvas.paint(cells_on_line(canvas.cell(*a), canvas.cell(*b)), colour)


def map_of(run, poses):
    """Rows of pixels."""
    scenario = tomllib.loads((run.folder / "hall.toml").read_text(encoding="utf-8"))
    canvas = Canvas(scenario)
    draw_truth(canvas, scenario)
    draw_scans(canvas, run, scripted.fitted(poses, run.truth))
    return canvas.pixels


def write_png(path, rows):
    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    header = struct.pack(">IIBBBBB", len(rows[0]), len(rows), 8, 2, 0, 0, 0)
    raw = b"".join(b"\0" + bytes(value for pixel in row for value in pixel) for row in rows)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


def write_panels(path, shown):
    """Maps of (run, poses), two beside each other."""
    rows = []
    for i in range(0, len(shown), 2):
        left, right = (map_of(*each) for each in shown[i:i + 2])
        if rows:
            rows += [[FLOOR] * len(rows[0])] * BETWEEN
        rows += [a + [FLOOR] * BETWEEN + b for a, b in zip(left, right)]
    write_png(path, rows)
