# SPDX-License-Identifier: Apache-2.0
"""CPU time and memory of each stage of a job, by GNU time put before it with the graph's LAUNCH."""

import re

CUT_OFF = 0.01  # s; GNU time drops what is below 10 ms, of user and of system time: half of it each on average


def launch(times):
    """The value of LAUNCH that appends to the file `times`."""
    return f"/usr/bin/time -a -o {times} -f '%U %S %M %C'"


def read(times):
    """Stage, CPU seconds and peak MB of each run."""
    for line in times.read_text().splitlines():
        user, system, kilobytes, program = line.split()[:4]
        yield program.rsplit("plumbline-", 1)[1], float(user) + float(system) + CUT_OFF, float(kilobytes) / 1024


def provenance(site):
    """CPU seconds that the stages took to hash their inputs and to read their provenance, as their logs tell it."""
    logs = "".join(log.read_text() for log in (site / "logs").glob("*.log"))
    return sum(map(float, re.findall(r"^provenance: (\S+) s of CPU$", logs, re.MULTILINE)))
