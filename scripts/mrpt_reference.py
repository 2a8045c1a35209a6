# SPDX-License-Identifier: Apache-2.0
"""MRPT's icp-slam (Debian package mrpt-apps) on a CARMEN log: a reference that anyone can repeat beside our figures.

The parameters are those of the demo that comes with MRPT (icp-slam_demo_classic.ini), with every point matched instead of
every fifth. rbpf-slam is not run: as Debian 12 has it, it crashes on rawlogs made by carmen2rawlog, which hold
single observations instead of pairs of actions and observations.
"""

import math
import pathlib
import shutil

CONFIGURATION = """[ICP]
ICP_algorithm = icpClassic
maxIterations = 80
minAbsStep_trans = 1e-6
minAbsStep_rot = 1e-6
thresholdDist = 0.3
thresholdAng_DEG = 5
ALFA = 0.8
smallestThresholdDist = 0.05
onlyClosestCorrespondences = true
onlyUniqueRobust = true
corresponding_points_decimation = 1
[MappingApplication]
rawlog_file = {rawlog}
rawlog_offset = 0
logOutput_dir = {output}
LOG_FREQUENCY = 1000000000
SAVE_3D_SCENE = 0
SAVE_POSE_LOG = 1
CAMERA_3DSCENE_FOLLOWS_ROBOT = 0
SHOW_PROGRESS_3D_REAL_TIME = 0
localizationLinDistance = 0.2
localizationAngDistance = 5
insertionLinDistance = 1.2
insertionAngDistance = 45
minICPgoodnessToAccept = 0.40
matchAgainstTheGrid = 0
occupancyGrid_count = 0
gasGrid_count = 0
landmarksMap_count = 0
beaconMap_count = 0
pointsMap_count = 1
likelihoodMapSelection = -1
[MappingApplication_pointsMap_00_insertOpts]
minDistBetweenLaserPoints = 0.05
fuseWithExisting = false
isPlanarMap = 1
"""


def installed():
    return all(shutil.which(program) for program in ("carmen2rawlog", "icp-slam"))


def laser_stamps(log):
    """The stamps that the log prints beside its front laser's scans."""
    with open(log, encoding="latin-1") as lines:
        return [float(line.split()[-3]) for line in lines if line.startswith("FLASER ")]


def icp_slam(log, folder, run):
    """Runs the log; `run` starts a command and tells what it took. Returns (usage, trajectory as TUM text)."""
    rawlog, output = folder / "mrpt.rawlog", folder / "mrpt"
    run(["carmen2rawlog", "-q", "-i", log, "-o", rawlog])
    configuration = folder / "icp.ini"
    configuration.write_text(CONFIGURATION.format(rawlog=rawlog, output=output))
    usage, _ = run(["icp-slam", configuration])
    # A pose after each object of the rawlog; the odometry of a scan is an object of its own before it or after.
    rows = (output / "log_estimated_path.txt").read_text().splitlines()
    stamps = laser_stamps(log)
    text = ""
    for i, stamp in enumerate(stamps):
        _, x, y, theta = map(float, rows[(i + 1) * len(rows) // len(stamps) - 1].split()[:4])
        text += f"{stamp:.6f} {x:.6f} {y:.6f} 0 0 0 {math.sin(theta / 2):.9f} {math.cos(theta / 2):.9f}\n"
    return usage, text
