"""evod: controls an evolution laboratory from Python.

    import evod

    with evod.connect("host:7744", token="…") as lab:
        world = lab.world("default")
        world.set(mutation_chance=0.1)
        for g in world.run(generations=50):
            print(g.best, g.mean)

`evod.local()` starts a private server, for scripts and notebooks. `evod.open_run("x.evod")` reads a run file without a
server. `evod.aio` has the same classes for asyncio. `evod.v1` contains the messages of the protocol.

evod.lab and evod.version are generated when the package is built (setup.py).
"""
from evod.errors import DamagedData, Error, NoConnection, Timeout, Violation
from evod.generations import Generation, Population
from evod.lab import Events, Lab, LocalLab, Replay, Run, Snapshots, World, connect, local
from evod.parameters import Actor, Parameter, Parameters, PlannedChange, Registry
from evod.run_file import RunFile, open_run
from evod.snapshots import Boxes, Items, Organisms, Snapshot, Tile
from evod.tables import GENE_NAMES
from evod.v1.world_pb2 import (
    RUN_STATE_PAUSED as PAUSED,
    RUN_STATE_RUNNING as RUNNING,
    RUN_STATE_TERMINATED as TERMINATED,
    RUN_STATE_WAITING as WAITING,
)
from evod.version import __version__

__all__ = [
    "Actor", "Boxes", "DamagedData", "Error", "Events", "GENE_NAMES", "Generation", "Items", "Lab", "LocalLab", "NoConnection",
    "Organisms", "Parameter", "Parameters", "PAUSED", "PlannedChange", "Population", "Registry", "Replay", "Run", "RunFile",
    "RUNNING", "Snapshot", "Snapshots", "TERMINATED", "Tile", "Timeout", "Violation", "WAITING", "World", "connect",
    "__version__", "local", "open_run",
]  # fmt: skip
