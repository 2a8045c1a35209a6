# SPDX-License-Identifier: Apache-2.0
"""One simulated run of the glass hall, and an operator who answers from the truth with an operator's error."""

import json
import math
import os
import pathlib
import random
import re
import sqlite3
import subprocess

HERE = pathlib.Path(__file__).resolve().parent
BIN = pathlib.Path(os.environ.get("PLUMBLINE_BIN", HERE.parent.parent / "build" / "bin"))
LIGHT = {"day": {"dropout": 0.06, "glass": 0.1}, "night": {"dropout": 0.02, "glass": 0.3}}


def stage(name, *arguments):
    subprocess.run([BIN / f"plumbline-{name}", "--quiet", "--threads", "1", *map(str, arguments)], check=True,
                   stderr=subprocess.DEVNULL if name in ("ingest", "adjust") else None)


def write_scenario(path, values):
    """hall.toml with the lines marked `#: key` set."""
    lines = []
    for line in (HERE / "hall.toml").read_text(encoding="utf-8").splitlines():
        key = re.search(r"#: (\w+)$", line)
        if key and key.group(1) in values:
            line = f"{line.split('=')[0]}= {values[key.group(1)]}"
        lines.append(line)
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


def read_truth(path):
    """(x, y, theta) of every scan."""
    rows = [list(map(float, line.split())) for line in path.read_text(encoding="utf-8").splitlines() if line[0] != "#"]
    return [(r[1], r[2], 2.0 * math.atan2(r[6], r[7])) for r in rows]


def between(a, b):
    """Pose b in the frame of pose a."""
    dx, dy = b[0] - a[0], b[1] - a[1]
    c, s = math.cos(a[2]), math.sin(a[2])
    return (c * dx + s * dy, -s * dx + c * dy, math.remainder(b[2] - a[2], 2.0 * math.pi))


def fitted(estimate, truth):
    """The estimated poses after the rigid fit of all on the truth."""
    e = [complex(x, y) for x, y, _ in estimate]
    t = [complex(x, y) for x, y, _ in truth]
    mean_e, mean_t = sum(e) / len(e), sum(t) / len(t)
    turn = sum((b - mean_t) * (a - mean_e).conjugate() for a, b in zip(e, t))
    turn /= abs(turn)
    angle = math.atan2(turn.imag, turn.real)
    places = [(a - mean_e) * turn + mean_t for a in e]
    return [(place.real, place.imag, theta + angle) for place, (_, _, theta) in zip(places, estimate)]


def largest_error(estimate, truth):
    """Largest distance of a pose from the truth after the rigid fit of all."""
    return max(math.dist(a[:2], b[:2]) for a, b in zip(fitted(estimate, truth), truth))


def select(file, query):
    with sqlite3.connect(f"file:{file}?mode=ro", uri=True) as artefact:
        return artefact.execute(query).fetchall()


class Run:
    def __init__(self, folder, metres, light, particles, seed):
        self.folder, self.metres, self.particles, self.seed = folder, metres, particles, seed
        folder.mkdir(parents=True, exist_ok=True)
        write_scenario(folder / "hall.toml", {"range": metres, **LIGHT[light]})
        stage("simulate", "--scenario", folder / "hall.toml", "--output", folder / "field", "--seed", seed)
        block = folder / "field" / "blocks" / "B1"
        self.session = folder / "session.sqlite"
        stage("ingest", "--raw", block / "scans.csv", block / "odometry.csv", "--output", self.session)
        self.truth = read_truth(folder / "field" / "truth" / "B1.tum")

    def filtered(self, name, answers=()):
        """The particle filter; as published, every drop of the effective sample size is a request."""
        output = self.folder / name
        stage("track", "--session", self.session, "--output", output, "--engine", "particle-filter",
              "--particles", self.particles, "--seed", self.seed, "--drops-together", 0,
              "--cache", self.folder / "particles.cache", *(["--answers", *answers] if answers else []))
        return output

    def prepare_graph(self):
        """The graph engine up to its loops: what answers do not touch."""
        self.track, self.loops = self.folder / "graph-track.sqlite", self.folder / "graph-loops.sqlite"
        stage("track", "--session", self.session, "--output", self.track)
        stage("loops", "--session", self.session, "--track", self.track, "--output", self.loops)

    def adjusted(self, answers=(), name="alone"):
        solution = self.folder / f"solution-{name}.sqlite"
        stage("adjust", "--track", self.track, "--loops", self.loops, "--output", solution,
              *(["--answers", *answers] if answers else []))
        return solution

    def requests(self, solution, answers):
        """What `requests` asks about the adjusted block, without an answer so far, where an earlier pass is in view."""
        grid, output = self.folder / "grid.tif", self.folder / "requests.jsonl"
        stage("grid", "--session", self.session, "--solution", solution, "--output", grid, "--cell-size-m", 0.1)
        inputs = {"session": self.session, "track": self.track, "loops": self.loops, "solution": solution, "grid": grid}
        stage("requests", *(word for name, file in inputs.items() for word in (f"--{name}", f"B1={file}")),
              *(word for file in answers for word in ("--answers", f"B1={file}")), "--output", output)
        asked = [json.loads(line) for line in output.read_text(encoding="utf-8").splitlines()[1:]]
        return [r for r in asked if r["answer"] is None and r["reference"] and r["reference"]["kind"] == "earlier pass"]

    @staticmethod
    def poses(file):
        return select(file, "SELECT x, y, theta FROM scans ORDER BY scan")

    @staticmethod
    def stamps(file):
        return [row[0] for row in select(file, "SELECT stamp_ns FROM scans ORDER BY rowid")]


class Operator:
    """Sees errors of more than 0.3 m or 5.7 degrees, answers to 4 cm and 0.7 degrees; `wrong_share` of the answers are grossly
    wrong. Answers stand in a folder of their own."""

    def __init__(self, run, folder, wrong_share=0.0):
        self.run, self.folder, self.wrong_share = run, run.folder / folder, wrong_share
        self.folder.mkdir(exist_ok=True)
        for old in self.folder.glob("*.json"):
            old.unlink()
        self.noise = random.Random(run.seed)
        self.stamps = run.stamps(run.session)
        self.files, self.changed, self.wrong, self.righted = [], 0, [], []

    def answer(self, scan, reference, shown):
        """Writes the answer to a pose that is shown relative to a reference; true when it changes the pose."""
        truth = between(self.run.truth[reference], self.run.truth[scan])
        off = math.dist(truth[:2], shown[:2]) > 0.3 or abs(math.remainder(truth[2] - shown[2], 2.0 * math.pi)) > 0.1
        pose = self.near(truth) if off else list(shown)
        gross = self.noise.random() < self.wrong_share
        if gross:
            direction = self.noise.uniform(-math.pi, math.pi)
            pose = [truth[0] + 2.0 * math.cos(direction), truth[1] + 2.0 * math.sin(direction), truth[2]]
        file = self.folder / f"{self.stamps[scan]}.json"
        file.write_text(json.dumps({"schema": 1, "stamp_ns": self.stamps[scan], "ref": {"stamp_ns": self.stamps[reference]},
                                    "decision": "correct" if off or gross else "confirm", "pose": pose,
                                    "operator": "scripted"}) + "\n", encoding="utf-8")
        if file not in self.files:
            self.files.append(file)
        if gross:
            self.wrong.append(file.name)
        self.changed += off or gross
        return off or gross

    def near(self, pose):
        return [pose[0] + self.noise.gauss(0, 0.04), pose[1] + self.noise.gauss(0, 0.04), pose[2] + self.noise.gauss(0, 0.012)]

    def look_again(self, names):
        """Rights the grossly wrong ones among some answers; true when there were any that he had not looked at."""
        wrong = [name for name in names if name in self.wrong and name not in self.righted]
        self.righted += wrong
        for name in wrong:
            answer = json.loads((self.folder / name).read_text(encoding="utf-8"))
            scan, reference = (self.stamps.index(stamp) for stamp in (answer["stamp_ns"], answer["ref"]["stamp_ns"]))
            answer["pose"] = self.near(between(self.run.truth[reference], self.run.truth[scan]))
            (self.folder / name).write_text(json.dumps(answer) + "\n", encoding="utf-8")
        return bool(wrong)
