"""evod: an evolution laboratory, from Python.

    import evod

    with evod.connect("host:7744", token="…") as lab:
        world = lab.world("default")
        world.set(mutation_chance=0.1)
        for g in world.run(generations=50):
            print(g.best, g.mean)

`evod.local()` starts a private server and stops it; notebooks need nothing else. `evod.open_run("x.evod")` reads a run file
without a server. `evod.aio` has the same words for asyncio. `evod.v1` has the messages of the protocol.
"""
from evod.lab import Events, Snapshots, Lab, Replay, Run, World, connect
from evod.errors import DamagedData, Error, NoConnection, Timeout, Violation
from evod.generations import Generation, Population
from evod.local_server import LocalLab, local
from evod.parameters import Actor, Parameter, Parameters, PlannedChange, Registry
from evod.snapshots import Boxes, Snapshot, Items, Organisms, Tile
from evod.run_file import RunFile, open_run
from evod.tables import GENE_NAMES
from evod.v1.world_pb2 import (
    RUN_STATE_PAUSED as PAUSED,
    RUN_STATE_RUNNING as RUNNING,
    RUN_STATE_TERMINATED as TERMINATED,
    RUN_STATE_WAITING as WAITING,
)
from evod.version import __version__

__all__ = [
    "Actor", "Boxes", "DamagedData", "Error", "Events", "Snapshot", "Snapshots", "GENE_NAMES", "Generation", "Items", "Lab",
    "LocalLab", "NoConnection", "Organisms", "Parameter", "Parameters", "Replay", "PAUSED", "PlannedChange", "Population", "Registry",
    "Run", "RunFile", "RUNNING", "TERMINATED", "Tile", "Timeout", "Violation", "WAITING", "World", "connect",
    "__version__", "local", "open_run",
]  # fmt: skip
