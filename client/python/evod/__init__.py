"""evod: controls an evolution laboratory from Python.

    import evod

    with evod.connect("host:7744", token="…") as lab:
        world = lab.world("default")
        world.set(mutation_chance=0.1)
        for g in world.run(generations=50):
            print(g.best, g.mean)

`evod.local()` starts a private server, for scripts and notebooks. `evod.open_run("x.evod")` reads a run file without a
server. `evod.aio` has the same classes for asyncio. `evod.v1` contains the messages of the protocol.

`evod.run()`, `evod.sweep()` and `evod.compare()` compute whole experiments in one call. `evod.run_table()` is made for
tasks of an executor.

evod.results, evod.version, and a synchronous module for every module of evod.aio that has one, such as evod.lab, are
generated when the package is built (setup.py).
"""
from evod.class_plans import Note
from evod.classrooms import Classroom
from evod.comparisons import ComparedWorld, Comparison, Difference
from evod.connection import LocalLab, connect, join, local
from evod.errors import (
    Aborted,
    AlreadyExists,
    AnswerExpired,
    DamagedData,
    Error,
    FailedPrecondition,
    FileNotFound,
    InvalidArgument,
    MissingPackage,
    NoConnection,
    NotFound,
    PermissionDenied,
    ProgramFailed,
    ResourceExhausted,
    Timeout,
    Unauthenticated,
    Unavailable,
    Unimplemented,
    Violation,
)
from evod.evaluation import Evaluation
from evod.experiments import compare, run, run_table, sweep
from evod.generations import Generation, History, Life, Population, Solution
from evod.genes import GENE_NAMES, ByGene, Genes
from evod.lab import Lab, Replay, World
from evod.objectives import Front, hypervolume, nondominated
from evod.parameters import Actor, Parameter, Parameters, PlannedChange, Registry
from evod.rating import Repaired
from evod.results import (
    AwaitedFitness,
    Brain,
    Breeding,
    CauseOfDeath,
    Choice,
    ClassInfo,
    ClassMember,
    ClassSeeds,
    ColonyStatistics,
    Contender,
    DamagedWorld,
    Descendant,
    DescendantKind,
    Detail,
    EntityIds,
    GeneAccount,
    GeneGroup,
    GenerationStatistics,
    GeneStatistics,
    LiveStatistics,
    Membership,
    Migrant,
    Motion,
    Mutation,
    MutationKind,
    OrderMutation,
    OrganismInfo,
    Outcome,
    PersonalCode,
    Pick,
    ReplayRange,
    RunState,
    Species,
    Statistics,
    Storage,
    StorageState,
    WorldInfo,
)
from evod.run_file import RunFile, open_run
from evod.snapshots import Box, Boxes, Item, Items, Organism, Organisms, Snapshot, Tile
from evod.streams import Events, Run, Snapshots
from evod.sweeps import Sweep, open_sweep
from evod.version import __version__

PAUSED, RUNNING, TERMINATED, WAITING = RunState.PAUSED, RunState.RUNNING, RunState.TERMINATED, RunState.WAITING

__all__ = [
    "Aborted", "Actor", "AlreadyExists", "AnswerExpired", "AwaitedFitness", "Box", "Brain", "Boxes", "Breeding",
    "ByGene", "CauseOfDeath", "Choice", "ClassInfo", "ClassMember", "ClassSeeds", "Classroom", "ColonyStatistics",
    "ComparedWorld", "Comparison", "Contender", "DamagedData", "DamagedWorld", "Descendant", "DescendantKind",
    "Detail", "Difference", "EntityIds", "Error", "Evaluation", "Events", "FailedPrecondition", "FileNotFound",
    "Front", "GENE_NAMES", "GeneAccount", "GeneGroup", "GeneStatistics", "Generation", "GenerationStatistics", "Genes",
    "History", "InvalidArgument", "Item", "Items", "Lab", "Life", "LiveStatistics", "LocalLab", "Membership",
    "Migrant", "MissingPackage", "Motion", "Mutation", "MutationKind", "NoConnection", "NotFound", "Note",
    "OrderMutation", "Organism", "OrganismInfo", "Organisms", "Outcome", "PAUSED", "Parameter", "Parameters",
    "PermissionDenied", "PersonalCode", "Pick", "PlannedChange", "Population", "ProgramFailed", "RUNNING", "Registry",
    "Repaired", "Replay", "ReplayRange", "ResourceExhausted", "Run", "RunFile", "RunState", "Snapshot", "Snapshots",
    "Solution", "Species", "Statistics", "Storage", "StorageState", "Sweep", "TERMINATED", "Tile", "Timeout",
    "Unauthenticated", "Unavailable", "Unimplemented", "Violation", "WAITING", "World", "WorldInfo", "__version__",
    "compare", "connect", "hypervolume", "join", "local", "nondominated", "open_run", "open_sweep", "run", "run_table",
    "sweep",
]  # fmt: skip
