"""Starting evod under mpirun in tests. EVOD names the program.

All processes run on this machine, more of them than it has processors.
"""
import contextlib
import os
import signal

import waiting
from open_mpi import OPEN_MPI

EVOD = os.environ["EVOD"]
ENVIRONMENT = {**os.environ, **OPEN_MPI}
LOST = r"evod: rank {} on [^,]* did not respond for {} s \(--rank-timeout\): all ranks end"
EXIT_RANK_LOST = 5


def mpirun(processes):
    """The words before a program that start it in so many processes."""
    return ["mpirun", "-n", str(processes)]


def processes_by_rank(job):
    """The processes of evod that a mpirun has started."""
    ranks = {}
    for process in waiting.descendants(job.pid):
        with contextlib.suppress(OSError, ValueError):
            with open(f"/proc/{process}/environ") as environment:
                variables = dict(line.split("=", 1) for line in environment.read().split("\0") if "=" in line)
            if os.readlink(f"/proc/{process}/exe") == os.path.realpath(EVOD):
                ranks[int(variables["OMPI_COMM_WORLD_RANK"])] = int(process)
    return ranks


def kill(job):
    """Kills the processes of a mpirun, which then ends. It removes their files from /dev/shm, so it must not be killed
    itself."""
    ranks = processes_by_rank(job)
    for process in ranks.values():
        with contextlib.suppress(OSError):
            os.kill(process, signal.SIGKILL)
    if not ranks:
        job.kill()
