# SPDX-License-Identifier: Apache-2.0
"""MRPT's icp-slam and rbpf-slam (Debian package mrpt-apps) on a CARMEN log: a reference that anyone can repeat beside
our figures.

The parameters are those of demos that come with MRPT: icp-slam_demo_classic.ini, with every point matched instead of
every fifth, and gridmapping_optimal_sampling.ini (25 particles on grids of 0.07 m) with an update every 0.2 m or 10
degrees. carmen2rawlog writes single observations, at which rbpf-slam 2.5.8 crashes: it gets pairs of an action and
what was observed after it.
"""

import gzip
import math
import re
import shutil
import struct

ICP_CONFIGURATION = """[ICP]
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

RBPF_CONFIGURATION = """[MappingApplication]
rawlog_file = {rawlog}
rawlog_offset = 0
logOutput_dir = {output}
verbosity = ERROR
LOG_FREQUENCY = 1000000000
SAVE_MAP_IMAGES = 0
SAVE_3D_SCENE = 0
SAVE_POSE_LOG = 0
SHOW_PROGRESS_IN_WINDOW = 0
RANDOM_SEED = 1
insertionLinDistance = 1.0
insertionAngDistance_deg = 40
localizeLinDistance = 0.2
localizeAngDistance_deg = 10
PF_algorithm = 3
adaptiveSampleSize = 0
resamplingMethod = 0
sampleSize = 25
BETA = 0.5
occupancyGrid_count = 1
gasGrid_count = 0
landmarksMap_count = 0
beaconMap_count = 0
pointsMap_count = 0
likelihoodMapSelection = -1
powFactor = 0.01
pfAuxFilterOptimal_MaximumSearchSamples = 400
pfOptimalProposal_mapSelection = 0
KLD_maxSampleSize = 150
KLD_minSampleSize = 15
KLD_binSize_XY = 0.03
KLD_binSize_PHI_deg = 1
KLD_delta = 0.001
KLD_epsilon = 0.5
[MappingApplication_occupancyGrid_00_creationOpts]
resolution = 0.07
disableSaveAs3DObject = 0
[MappingApplication_occupancyGrid_00_insertOpts]
mapAltitude = 0
useMapAltitude = 0
maxDistanceInsertion = 35
maxOccupancyUpdateCertainty = 0.60
considerInvalidRangesAsFreeSpace = 1
minLaserScanNoiseStd = 0.001
wideningBeamsWithDistance = 0
[MappingApplication_occupancyGrid_00_likelihoodOpts]
likelihoodMethod = 4
LF_decimation = 5
LF_stdHit = 0.20
LF_maxCorrsDistance = 0.30
LF_zHit = 0.999
LF_zRandom = 0.001
LF_maxRange = 30
LF_alternateAverageMethod = 0
enableLikelihoodCache = 1
"""

ODOMETRY = b"\x9fmrpt::obs::CObservationOdometry"
SCAN = b"\xa2mrpt::obs::CObservation2DRangeScan"


def installed():
    return all(shutil.which(program) for program in ("carmen2rawlog", "icp-slam", "rbpf-slam"))


def laser_stamps(log):
    """The stamps that the log prints beside its front laser's scans."""
    with open(log, encoding="latin-1") as lines:
        return [float(line.split()[-3]) for line in lines if line.startswith(("FLASER ", "ROBOTLASER1 "))]


def serialized(name, version, content):
    """An object as MRPT writes it: length and text of its class, version, content, end mark."""
    return bytes([0x80 | len(name)]) + name.encode() + bytes([version]) + content + b"\x88"


def action(before, after):
    """The motion between two poses of the odometry, with MRPT's own motion model (Gaussian, its usual parameters)."""
    dx, dy = after[0] - before[0], after[1] - before[1]
    cosine, sine = math.cos(before[2]), math.sin(before[2])
    motion = (cosine * dx + sine * dy, cosine * dy - sine * dx, math.remainder(after[2] - before[2], 2 * math.pi))
    degree = math.radians(1)
    content = struct.pack("<i", 0) + serialized("mrpt::poses::CPose2D", 1, struct.pack("<3d", *motion))
    content += struct.pack("<i6f", 0, 0.01, 0.001 / degree, degree, 0.05, 0.01, 0.2 * degree)
    content += struct.pack("<i6f", 300, 0.05, 4 * degree, 0.01, 0.0001 / degree, 0.001, 0.05 * degree)
    content += struct.pack("<?ff?iiQ", False, 0, 0, False, 0, 0, 0)  # no velocities, no encoders, no stamp
    moved = serialized("mrpt::obs::CActionRobotMovement2D", 6, content)
    return serialized("mrpt::obs::CActionCollection", 0, struct.pack("<I", 1) + moved)


def write_pairs(observations, pairs):
    """The rawlog `observations` once more, every scan with the motion since the scan before."""
    data = gzip.open(observations).read()
    starts = [match.start() for match in re.finditer(re.escape(ODOMETRY) + b"|" + re.escape(SCAN), data)] + [len(data)]
    before = pose = None
    with gzip.open(pairs, "wb") as out:
        for start, end in zip(starts, starts[1:]):
            if data.startswith(ODOMETRY, start):
                values = data.index(b"CPose2D", start) + 8
                pose = struct.unpack_from("<3d", data, values)
                continue
            scan = serialized("mrpt::obs::CSensoryFrame", 2, struct.pack("<I", 1) + data[start:end])
            out.write(action(before or pose, pose) + scan)
            before = pose


def trajectory(log, rows, heading):
    """TUM text. `rows`: number, x, y, ... of each object of the rawlog; a scan may have its odometry before it."""
    stamps = laser_stamps(log)
    text = ""
    for i, stamp in enumerate(stamps):
        row = rows[(i + 1) * len(rows) // len(stamps) - 1].split()
        x, y, theta = float(row[1]), float(row[2]), float(row[heading])
        text += f"{stamp:.6f} {x:.6f} {y:.6f} 0 0 0 {math.sin(theta / 2):.9f} {math.cos(theta / 2):.9f}\n"
    return text


def runs(log, folder, run):
    """Both programs on the log; `run` starts a command and tells what it took. Yields (program, usage, TUM text)."""
    rawlog, pairs = folder / "mrpt.rawlog", folder / "pairs.rawlog"
    run(["carmen2rawlog", "-q", "-i", log, "-o", rawlog])
    write_pairs(rawlog, pairs)
    for program, configuration, objects, heading in (("icp-slam", ICP_CONFIGURATION, rawlog, 3),
                                                     ("rbpf-slam", RBPF_CONFIGURATION, pairs, 4)):
        output, options = folder / program, folder / f"{program}.ini"
        options.write_text(configuration.format(rawlog=objects, output=output))
        usage, _ = run([program, options])
        rows = (output / "log_estimated_path.txt").read_text().splitlines()
        yield program, usage, trajectory(log, rows, heading)
