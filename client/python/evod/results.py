"""The results of queries as frozen dataclasses. Their fields have the names of the protocol (docs/PROTOCOL.md).

Names contain units: _px pixels, _s seconds, _px_s pixels per second. x grows to the right, y grows downward.
"""
from __future__ import annotations

import dataclasses
import enum
import functools
from typing import Any, Callable, Mapping, Sequence

import google.protobuf.descriptor
import google.protobuf.message
import numpy

from evod.genes import GENE_NAMES, ByGene, Genes
from evod.parameters import Value, value_of
from evod.tables import html_table
from evod.v1 import commands_pb2, stream_pb2, world_pb2

# ---- states ---------------------------------------------------------------------------------------------------------------


class _State(enum.IntEnum):
    """A state with the numbers of the protocol. A state that this package does not know is named UNKNOWN_N."""

    @classmethod
    def _missing_(cls, value: object) -> Any:
        if not isinstance(value, int):
            return None
        state = int.__new__(cls, value)
        state._name_, state._value_ = f"UNKNOWN_{value}", value
        return state

    def __str__(self) -> str:
        return self.name.lower()


class RunState(_State):
    """Whether a world runs."""

    WAITING = world_pb2.RUN_STATE_WAITING  #: idle until `World.run`
    RUNNING = world_pb2.RUN_STATE_RUNNING
    PAUSED = world_pb2.RUN_STATE_PAUSED  #: has a goal, but is paused
    TERMINATED = world_pb2.RUN_STATE_TERMINATED  #: a termination criterion has ended the run


class Outcome(_State):
    """The termination criterion that ended a run."""

    GENERATION_LIMIT = world_pb2.OUTCOME_GENERATION_LIMIT
    TARGET_FITNESS = world_pb2.OUTCOME_TARGET_FITNESS
    STAGNATION = world_pb2.OUTCOME_STAGNATION
    EXTINCTION = world_pb2.OUTCOME_EXTINCTION


class StorageState(_State):
    """Whether the server can write a run to the disk."""

    KEEPS_UP = world_pb2.STORAGE_STATE_KEEPS_UP
    FAILING = world_pb2.STORAGE_STATE_FAILING  #: writes fail: commands are refused, worlds continue
    STALLED = world_pb2.STORAGE_STATE_STALLED  #: writes fail: commands are refused, worlds wait
    BEHIND = world_pb2.STORAGE_STATE_BEHIND  #: worlds are faster than the disk and wait for it


class CauseOfDeath(_State):
    """Why an organism died."""

    STARVED = world_pb2.CAUSE_OF_DEATH_STARVED
    POISONED = world_pb2.CAUSE_OF_DEATH_POISONED
    REMOVED = world_pb2.CAUSE_OF_DEATH_REMOVED  #: `World.remove` removed it


class Choice(_State):
    """The action of an organism in the next tick."""

    WANDER = world_pb2.CHOICE_WANDER
    SEEK = world_pb2.CHOICE_SEEK  #: moves towards food
    FLEE = world_pb2.CHOICE_FLEE  #: moves away from poison
    STEER = world_pb2.CHOICE_STEER  #: its neural network steers it


class Detail(_State):
    """The level of detail of a tile."""

    FULL = stream_pb2.DETAIL_FULL  #: all fields of all entities
    DOTS = stream_pb2.DETAIL_DOTS  #: positions only
    DENSITY = stream_pb2.DETAIL_DENSITY  #: numbers of entities per cell


class GeneGroup(_State):
    """What a gene is for."""

    BODY = world_pb2.GENE_GROUP_BODY  #: the six genes that every chromosome begins with
    BRAIN = world_pb2.GENE_GROUP_BRAIN  #: a weight of the neural network that steers the organism
    FREE = world_pb2.GENE_GROUP_FREE  #: the simulation does not read it (parameter free_genes)


class DescendantKind(_State):
    """How an organism came into the next generation."""

    ELITE = commands_pb2.DESCENDANT_KIND_ELITE
    SURVIVOR = commands_pb2.DESCENDANT_KIND_SURVIVOR
    CHILD = commands_pb2.DESCENDANT_KIND_CHILD


class MutationKind(_State):
    """How a gene was changed."""

    CREEP = commands_pb2.MUTATION_KIND_CREEP
    RESET = commands_pb2.MUTATION_KIND_RESET
    BIT_FLIP = commands_pb2.MUTATION_KIND_BIT_FLIP
    CLAMP = commands_pb2.MUTATION_KIND_CLAMP  #: the value was outside its bounds and was set to the nearest bound
    SCALE = commands_pb2.MUTATION_KIND_SCALE  #: multiplied by a random factor


# ---- worlds ---------------------------------------------------------------------------------------------------------------


class _Result:
    """The base class of results. Notebooks show a result as a table of its fields."""

    def _repr_html_(self) -> str:
        return html_table((), ((name, str(value)) for name, value in vars(self).items()))


@dataclasses.dataclass(frozen=True)
class Storage(_Result):
    """Whether the server can write a run to the disk."""

    state: StorageState
    reason: str  #: "" while the server can write the run


@dataclasses.dataclass(frozen=True)
class ReplayRange(_Result):
    """The moments that a replay can show."""

    replay_of: str  #: the world whose run is replayed; "" if the server shows a run file
    first_generation: int
    last_generation: int
    first_tick: int  #: ticks since the run began
    last_tick: int  #: increases while the original world runs


@dataclasses.dataclass(frozen=True)
class AwaitedFitness(_Result):
    """The fitness for which a world waits at the end of a generation: see `World.evaluate`."""

    generation: int
    islands: tuple[int, ...]  #: the islands that are not rated completely


@dataclasses.dataclass(frozen=True)
class WorldInfo(_Result):
    """The state of a world, returned by `World.info` and by the functions that control a world."""

    name: str
    run_id: str  #: 32 hexadecimal digits; every creation, fork and reset begins a run with a new id
    seed: int
    island_count: int
    tick: int  #: ticks since the run began
    generation: int  #: the first is 1
    generation_tick: int  #: ticks since the generation began
    simulated_s: float  #: simulated time since the run began
    state: RunState
    outcome: Outcome | None  #: None: no termination criterion has ended the run
    speed: float | str  #: requested simulated seconds per second, or "max"
    state_hash: str  #: hash of the state after `tick`, 32 hexadecimal digits
    parameter_revision: int
    run_until_generation: int | None  #: the world runs until the generation before this one has ended
    run_until_tick: int | None  #: the world runs until this tick
    ticks_per_s: float  #: measured over about the last second; 0 while the world does not run
    gene_names: tuple[str, ...]  #: the names of the genes, in the order of all arrays
    gene_groups: tuple[GeneGroup, ...]  #: the group of each gene; () from a server that knows only the six genes of the body
    replay: ReplayRange | None  #: None: this is not a replay
    storage: Storage | None  #: None: the server does not store the run
    leased: bool  #: a client has a lease from `World.run_until_tick`
    slowed: bool  #: the machine is too slow for `speed`
    awaited_fitness: AwaitedFitness | None  #: None: the world does not wait for fitness from a client


@dataclasses.dataclass(frozen=True)
class DamagedWorld(_Result):
    """A world that does not run, because the server cannot restore it from its run file."""

    name: str
    run_id: str  #: 32 hexadecimal digits; "": the server cannot read the file at all
    reason: str  #: what is wrong, and what can be done


# ---- statistics -----------------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True)
class GeneAccount(_Result):
    """Why the mean of a gene changed since the previous generation: selection + transmission + migration = change."""

    selection: float
    transmission: float  #: effect of crossover, mutation and the bounds of the gene
    migration: float
    change: float


@dataclasses.dataclass(frozen=True)
class GeneStatistics(_Result):
    """The distribution of a gene among the organisms of an island."""

    mean: float
    deviation: float  #: standard deviation of the population
    min: float
    max: float
    account: GeneAccount | None  #: None in the first generation, and if the reason of the change is unknown


@dataclasses.dataclass(frozen=True)
class GenerationStatistics(_Result):
    """The results of one generation on one island."""

    generation: int
    island: int
    end_tick: int  #: the last tick of the generation, counted from the beginning of the run
    organism_count: int
    fitness_best: float
    fitness_mean: float
    fitness_median: float
    fitness_worst: float
    fitness_deviation: float  #: standard deviation of the population
    genes: ByGene[GeneStatistics]  #: genes["body_size"].mean
    diversity: float  #: mean over all genes of the standard deviation divided by the width of the gene's range
    alive_count: int
    starved_count: int
    poisoned_count: int
    food_eaten: int
    poison_eaten: int
    clamp_count: int  #: genes that were set to a bound when this generation was bred
    too_fast_count: int  #: how often a body moved by more than its radius in one tick
    speed_limit_count: int  #: how often max_speed_px_s limited the speed of a body
    best_organism: int  #: id of the organism with the best fitness
    simulated_s: float  #: simulated duration of the generation


@dataclasses.dataclass(frozen=True)
class LiveStatistics(_Result):
    """The state of an island in the current generation."""

    island: int
    organism_count: int  #: organisms born in this generation
    alive_count: int
    health_mean: float  #: mean health of the living organisms; 0 if there are none
    food_eaten: int
    poison_eaten: int
    starved_count: int
    poisoned_count: int


@dataclasses.dataclass(frozen=True)
class Statistics(_Result):
    """The statistics of a world, returned by `World.statistics`."""

    world: WorldInfo
    live: tuple[LiveStatistics, ...]  #: of each island; () if the fitness depends only on the genes
    last: tuple[GenerationStatistics, ...]  #: of each island in the last ended generation; () in the first generation


@dataclasses.dataclass(frozen=True)
class Motion(_Result):
    """The motion of the bodies on an island, returned by `World.motion`."""

    tick: int
    tick_s: float
    body_count: int  #: movable bodies: living organisms and crates
    kinetic_energy: float  #: kg px²/s²
    momentum_x: float  #: kg px/s
    momentum_y: float
    touching_count: int  #: pairs of bodies that touch or overlap
    deepest_overlap_px: float
    deepest_overlap_share: float  #: as a share of the smaller body's radius or smallest half side
    fastest_px_s: float
    fastest_step_share: float  #: largest movement in one tick, as a share of the body's radius or smallest half side
    cell_px: float
    too_fast_count: int  #: in this generation
    speed_limit_count: int  #: in this generation
    generation_tick: int  #: ticks since the generation began


# ---- organisms ------------------------------------------------------------------------------------------------------------


@dataclasses.dataclass(frozen=True, eq=False)
class Brain(_Result):
    """The neural network that steers an organism, at the start of the next tick.

    Its weights are the genes of the group ``brain``: for each hidden neuron the weights of its inputs, then its bias; then for
    each output the weights of the hidden neurons, then its bias. A neuron is tanh of the sum of its weighted inputs.
    The inputs are computed from the current items; if food or poison reappears at the start of the next tick, they may differ.
    """

    input_names: tuple[str, ...]
    inputs: Any  #: shape (inputs,), in the order of input_names
    hidden: Any  #: shape (hidden neurons,)
    output_names: tuple[str, ...]
    outputs: Any  #: shape (outputs,), in the order of output_names
    has_bias: bool  #: whether every neuron has a bias


@dataclasses.dataclass(frozen=True, eq=False)
class OrganismInfo(_Result):
    """The current state of one organism, returned by `World.organism`."""

    id: int
    island: int
    generation: int
    genes: Genes  #: shape (genes,): genes["body_size"]
    alive: bool
    x_px: float
    y_px: float
    velocity_x_px_s: float
    velocity_y_px_s: float
    radius_px: float
    mass_kg: float
    health: float  #: 0 if the organism is dead
    lived_s: float
    cause_of_death: CauseOfDeath | None  #: None: the organism is alive
    food_eaten: int
    poison_eaten: int
    parents: tuple[int, ...]  #: ids in the previous generation; () in the first generation and for a placed organism
    choice: Choice | None  #: the action in the next tick; None: it does not act
    force_x: float  #: force in the next tick, kg px/s²
    force_y: float
    target_x_px: float  #: position of the food or poison that it seeks or flees; its own position otherwise
    target_y_px: float
    placed_tick: int | None  #: the tick of its generation after which it was placed; None: it was bred
    heading: float | None  #: radians, -pi to pi, from +x (right) toward +y (down); None: it is dead or has no heading
    #: Its neural network; None: it is dead, its generation has ended, or the controller of the world is not ``network``.
    brain: Brain | None


@dataclasses.dataclass(frozen=True)
class EntityIds(_Result):
    """The items and organisms that `World.place` has placed or `World.remove` has removed."""

    island: int
    generation: int  #: the ids belong to this generation
    food: tuple[int, ...]  #: ids in the order of the call
    poison: tuple[int, ...]
    organisms: tuple[int, ...]


@dataclasses.dataclass(frozen=True)
class Migrant(_Result):
    """The organism on another island of which a migrant is a copy."""

    island: int
    organism: int


@dataclasses.dataclass(frozen=True)
class Contender(_Result):
    """An organism that could be selected as a parent."""

    fitness: float
    rank: int  #: 0: the fittest; among equal ones, the lower id comes first
    weight: float  #: scaled fitness
    slot_begin: float  #: begin of its slot in turns of the wheel; 0 if there is no wheel
    slot_end: float
    expected_copies: float  #: expected number of picks
    copies: int  #: actual number of picks
    migrant: Migrant | None  #: None: the organism lived on this island
    own_fitness: float | None  #: the fitness that it reached itself, if shuffle_fitness gave it that of another organism
    expected_copies_error: float  #: standard deviation of `copies` over repetitions of the breeding
    unpicked_chance: float  #: probability of 0 copies


@dataclasses.dataclass(frozen=True)
class Pick(_Result):
    """One selection of a parent."""

    organism: int
    turns: float | None  #: where the pointer of the roulette wheel stopped, in turns
    tournament: int | None  #: index of the tournament that the organism won
    contestants: tuple[int, ...]  #: in the order in which they were drawn; () if unknown or more than 64


@dataclasses.dataclass(frozen=True)
class OrderMutation(_Result):
    """A mutation that changed the order of the genes."""

    method: str  #: a value of the parameter order_mutation
    order: tuple[int, ...]  #: gene g received the value of the gene with the index order[g]


@dataclasses.dataclass(frozen=True)
class Mutation(_Result):
    """A mutation of one gene."""

    gene: int  #: index in `gene_names` of the world
    kind: MutationKind
    before: float
    after: float


@dataclasses.dataclass(frozen=True, eq=False)
class Descendant(_Result):
    """An organism of the next generation."""

    id: int
    kind: DescendantKind
    first_parent: int  #: of a survivor: its id in the parents' generation
    second_parent: int
    first_genes: Genes  #: genes of the first parent
    second_genes: Genes
    from_second: int  #: bit g is set if gene g comes from the second parent
    second_share: float  #: blend crossover: the weight of the second parent in every gene; otherwise 0
    crossed: bool  #: crossover took place
    order_mutation: OrderMutation | None
    mutations: tuple[Mutation, ...]  #: in the order in which they happened
    genes: Genes  #: genes of the descendant


@dataclasses.dataclass(frozen=True)
class Breeding(_Result):
    """How a generation was bred, returned by `World.breeding`."""

    generation: int  #: the generation of the parents
    island: int
    parameters: Mapping[str, Value]  #: parameters of the genetic algorithm, by name
    contender_count: int  #: organisms in the parents' generation
    pick_count: int
    descendant_count: int  #: organisms in the next generation
    elite_count: int  #: the elite are the descendants 0 to elite_count - 1
    survivor_count: int  #: the survivors, elite included, are the descendants 0 to survivor_count - 1
    contenders: tuple[Contender, ...]  #: ordered by id
    picks: tuple[Pick, ...]  #: in the order of picking
    descendants: tuple[Descendant, ...]  #: ordered by id


# ---- conversion -----------------------------------------------------------------------------------------------------------


def _genes(values: Sequence[float], names: Sequence[str]) -> Genes:
    return Genes(numpy.array(values or [numpy.nan] * len(names), numpy.float32), names)


def _activations(values: Sequence[float]) -> Any:
    return numpy.array(values, numpy.float32)


_CLASSES: Mapping[str, type[Any]] = {
    kind.__name__: kind
    for kind in (AwaitedFitness, Brain, Breeding, Contender, DamagedWorld, Descendant, GeneAccount, GenerationStatistics, GeneStatistics, LiveStatistics, Migrant,
                 Motion, Mutation, OrderMutation, OrganismInfo, Pick, Statistics, Storage, WorldInfo)
} | {"Replay": ReplayRange, "Placed": EntityIds, "Removed": EntityIds}  # fmt: skip
_STATES: Mapping[str, type[_State]] = {
    kind.__name__: kind
    for kind in (CauseOfDeath, Choice, DescendantKind, GeneGroup, MutationKind, Outcome, RunState, StorageState)
}
_OF_GENES: Mapping[str, Callable[[Any, Sequence[str]], Any]] = {
    "GenerationStatistics.genes": lambda genes, names: ByGene((result(gene) for gene in genes), names),
    "OrganismInfo.genes": _genes,
    "Descendant.genes": _genes,
    "Descendant.first_genes": _genes,
    "Descendant.second_genes": _genes,
}
_SPECIAL: Mapping[str, Callable[[Any], Any]] = {
    "Speed": lambda speed: "max" if speed.max else speed.real_time_factor,
    "Brain.inputs": _activations,
    "Brain.hidden": _activations,
    "Brain.outputs": _activations,
    "Breeding.parameters": lambda assigned: {assignment.name: value_of(assignment.value) for assignment in assigned},
}


def result(message: google.protobuf.message.Message, gene_names: Sequence[str] = GENE_NAMES) -> Any:
    """Converts a message of the protocol to the dataclass of the same name. `gene_names` are those of the message's world."""
    make, fields = _converters(message.DESCRIPTOR)
    return make(*(convert(message, gene_names) for convert in fields))


_Converter = Callable[[google.protobuf.message.Message, Sequence[str]], Any]


@functools.lru_cache(maxsize=None)
def _converters(message: google.protobuf.descriptor.Descriptor) -> tuple[type[Any], tuple[_Converter, ...]]:
    made = _CLASSES[message.name]
    return made, tuple(_converter(message.fields_by_name[field.name]) for field in dataclasses.fields(made))


def _from_second(descendant: Any, names: Sequence[str]) -> int:
    words = (descendant.from_second, *descendant.more_from_second)
    return sum(word << 32 * index for index, word in enumerate(words))


def _of_message(name: str) -> _Converter:
    if name not in _SPECIAL:
        return result
    special = _SPECIAL[name]
    return lambda message, names: special(message)


def _converter(field: google.protobuf.descriptor.FieldDescriptor) -> _Converter:
    name = field.name
    full_name = f"{field.containing_type.name}.{name}"
    if full_name == "Descendant.from_second":
        return _from_second
    if full_name in _OF_GENES:
        of_genes = _OF_GENES[full_name]
        return lambda message, names: of_genes(getattr(message, name), names)
    # Newer versions of protobuf have is_repeated in place of label.
    is_repeated = field.is_repeated if hasattr(field, "is_repeated") else field.label == field.LABEL_REPEATED
    is_optional = field.has_presence and not is_repeated
    convert = _SPECIAL.get(full_name)
    if field.enum_type is not None:
        state = _STATES[field.enum_type.name]
        if is_repeated:
            convert = lambda numbers: tuple(state(number) for number in numbers)
        else:
            convert = lambda number: state(number) if number else None
    elif convert is None and field.message_type is not None:
        of_item: _Converter = _of_message(field.message_type.name)
        if is_repeated:
            return lambda message, names: tuple(of_item(item, names) for item in getattr(message, name))
        if is_optional:
            return lambda message, names: of_item(getattr(message, name), names) if message.HasField(name) else None
        return lambda message, names: of_item(getattr(message, name), names)
    elif convert is None and is_repeated:
        convert = tuple
    if is_optional:
        present = convert
        return lambda message, names: (
            (present(getattr(message, name)) if present else getattr(message, name)) if message.HasField(name) else None
        )
    if convert is None:
        return lambda message, names: getattr(message, name)
    always = convert
    return lambda message, names: always(getattr(message, name))
