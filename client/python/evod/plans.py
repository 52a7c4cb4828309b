"""Plans: operations of a client that may consist of several requests. This module does no I/O.

A plan is a generator. It yields a request and receives the response, or yields an Until and continues when the
condition is true. Its return value is the result of the operation. Link.perform() (aio/link.py) executes plans.
"""
from __future__ import annotations

import csv
import dataclasses
import io
import warnings
from typing import Any, Callable, Generator, Mapping, Sequence, TypeVar, Union

import google.protobuf.descriptor
import google.protobuf.message
import numpy
import numpy.typing

from evod.conversion import result
from evod.core import Core, Subscription
from evod.errors import (
    DamagedData,
    FailedPrecondition,
    InvalidArgument,
    NoConnection,
    NotFound,
    Violation,
    argument_of,
    damaged_world,
    printable,
    refusal,
    wrong_argument,
)
from evod.genes import GENE_NAMES, GeneNames, Genes
from evod.generations import Generation, History, Population, gene_count_of, generations_of, population_of
from evod.snapshots import Snapshot
from evod.v1 import commands_pb2 as c, stream_pb2, world_pb2

T = TypeVar("T")
M = TypeVar("M", bound=google.protobuf.message.Message)


@dataclasses.dataclass(frozen=True)
class Until:
    """Makes the plan wait until `condition()` is true: as long as the server can be reached, or also at most the
    timeout."""

    condition: Callable[[], object]
    within_timeout: bool = False


Step = Union[c.Request, Until]
Plan = Generator[Step, Any, T]

_F = google.protobuf.descriptor.FieldDescriptor
_ALLOWED = {
    _F.TYPE_UINT32: f"a whole number, 0 to {2**32 - 1}",
    _F.TYPE_UINT64: f"a whole number, 0 to {2**64 - 1}",
    _F.TYPE_DOUBLE: "a number",
    _F.TYPE_BOOL: "true or false",
    _F.TYPE_STRING: "text",
}

TABLES = {
    "generations": c.RUN_TABLE_GENERATIONS,
    "organisms": c.RUN_TABLE_ORGANISMS,
    "lineage": c.RUN_TABLE_LINEAGE,
    "population": c.RUN_TABLE_POPULATION,
    "events": c.RUN_TABLE_EVENTS,
    "notes": c.RUN_TABLE_NOTES,
}
FORMATS = {"csv": c.TEXT_FORMAT_CSV, "jsonl": c.TEXT_FORMAT_JSON_LINES}
DETAILS = {"full": stream_pb2.DETAIL_FULL, "dots": stream_pb2.DETAIL_DOTS, "density": stream_pb2.DETAIL_DENSITY}


def execute(message: c.Request) -> Plan[c.Response]:
    """Sends a request. Raises Error if the server refuses it. Warns about settings with which nothing can evolve."""
    response: c.Response = yield message
    if response.status.code != c.CODE_UNSPECIFIED:
        raise refusal(response.status)
    if not message.HasField("get_parameters"):
        for warning in response.warnings:
            warnings.warn(printable(warning), stacklevel=2)
    return response


def request(kind: str, /, **fields: Any) -> Plan[c.Response]:
    """Sends a request. `kind` is its field in evod.v1.Request. Raises Error for a wrong type, or if the server
    refuses."""
    message = build(type(getattr(c.Request(), kind)), f"{kind}.", **fields)
    return (yield from execute(c.Request(**{kind: message})))


def request_world(kind: str, /, **fields: Any) -> Plan[world_pb2.WorldInfo]:
    """Sends a request that the server answers with the state of a world, and returns this state."""
    return (yield from request(kind, **fields)).world


# ---- streams
# ----------------------------------------------------------------------------------------------------------


class EventStream:
    """The events of a subscription, in the order in which they arrive."""

    def __init__(self, core: Core, subscription: Subscription) -> None:
        self._core, self._subscription = core, subscription

    def next(self) -> Plan[stream_pb2.Event]:
        """Waits for the next event."""
        return (yield from next_event(self._subscription))

    def close(self) -> None:
        """Ends the subscription."""
        self._core.unsubscribe(self._subscription)


class SnapshotStream:
    """The snapshots of a subscription, in the order in which they arrive. next() acknowledges the snapshot returned
    before.

    genes  whether the organisms of the snapshots have their genes.
    """

    def __init__(self, core: Core, subscription: Subscription, genes: bool = False) -> None:
        self._core, self._subscription = core, subscription
        # Genes by island, with the run and the generation to which they belong; None: they are not requested.
        self._genes: dict[int, tuple[tuple[str, int], Genes]] | None = {} if genes else None
        self._taken: tuple[int, Snapshot] | None = None  # the last returned snapshot, and the number of its session

    def next(self) -> Plan[Snapshot]:
        """Acknowledges the snapshot returned before, and waits for the next one."""
        subscription = self._subscription
        if self._taken is not None:
            session, taken = self._taken
            self._taken = None
            if session == subscription.sessions:
                self._core.acknowledge(subscription, taken)
        yield Until(lambda: subscription.arrived or subscription.refused)
        if not subscription.arrived:
            raise subscription.refused or DamagedData("the subscription ended without a snapshot")
        snapshot: Snapshot = subscription.arrived.popleft()
        self._taken = subscription.sessions, snapshot
        return snapshot if self._genes is None else (yield from self._with_genes(snapshot, self._genes))

    def _with_genes(self, snapshot: Snapshot, island_genes: dict[int, tuple[tuple[str, int], Genes]]) -> Plan[Snapshot]:
        moment = snapshot.run_id, snapshot.generation
        if snapshot.island not in island_genes or island_genes[snapshot.island][0] != moment:
            island_genes[snapshot.island] = moment, (yield from genes_of(snapshot))
        return snapshot.with_genes(island_genes[snapshot.island][1])

    def set_view(self, view: c.View) -> Plan[None]:
        """Changes the view in this session and in later sessions."""
        subscription_id = yield from self._server_id()
        yield from request("set_view", subscription_id=subscription_id, view=view)
        # The server has accepted the new view, so later sessions request it too.
        self._subscription.request.subscribe_snapshots.view.CopyFrom(view)

    def _server_id(self) -> Plan[int]:
        """Waits until the server has accepted the subscription in this session, and returns its id."""
        subscription = self._subscription
        yield Until(lambda: subscription.server_id is not None or subscription.refused)
        if subscription.server_id is None:
            raise subscription.refused or DamagedData("the server did not accept the subscription")
        return subscription.server_id

    @property
    def rate_hz(self) -> float:
        """The snapshots per second that the server granted."""
        return self._subscription.rate_hz

    def request_keyframe(self) -> Plan[None]:
        """Requests keyframes of all islands."""
        subscription_id = yield from self._server_id()
        yield from request("request_keyframe", subscription_id=subscription_id)

    def close(self) -> None:
        """Ends the subscription."""
        self._core.unsubscribe(self._subscription)


class GenerationStream:
    """The generations of a run. Each is returned once, when it has ended.

    The data come from events. If an event was dropped, or missed during a reconnect, the data come from the history.
    """

    def __init__(self, core: Core, world: str, subscription: Subscription) -> None:
        self._core, self._world, self._subscription = core, world, subscription
        self.info = world_pb2.WorldInfo()  # the state of the world when the run began
        self._next = 0  # number of the next generation to return
        self._goal: int | None = None  # the first generation after the run; None: the run has no end
        self._ready: list[Generation] = []  # generations that next() returns before it processes another event
        # whether the event caused by this Run has arrived; earlier events belong to earlier commands
        self._began = False
        self._over = False  # whether the run has ended; next() then returns only the generations in _ready
        self._awaited: world_pb2.AwaitedFitness | None = None  # the fitness for which the world waits, for step()
        # a generation, and those of its islands that rated_step() has not returned
        self._to_rate: tuple[int, list[int]] = (0, [])
        self.is_open = True  # whether the subscription has not ended
        self.reason = ""  # why the run has ended: "generations", "pause", or a termination criterion of the world

    def begin(self, info: world_pb2.WorldInfo, first: int) -> None:
        """Call it with the server's answer to Run and the number of the first generation to return."""
        self.info, self._next = info, first
        self._goal = _goal_of(info)
        self._await_fitness(info)

    @property
    def goal(self) -> int | None:
        """The number of the last generation of the run; None if the run has no end."""
        return None if self._goal is None else self._goal - 1

    def next(self) -> Plan[Generation | None]:
        """Waits for the next generation and returns it; returns None after the last generation."""
        while True:
            step = yield from self.step()
            if not isinstance(step, world_pb2.AwaitedFitness):
                return step

    def step(self) -> Plan[Generation | world_pb2.AwaitedFitness | None]:
        """Like next(), but also returns when the world waits for fitness."""
        while True:
            if self._ready:
                generation = self._ready.pop(0)
                self._next = generation.number + 1
                return generation
            if self._awaited is not None and not self._over:
                awaited, self._awaited = self._awaited, None
                return awaited
            if self._over or self._goal is not None and self._next >= self._goal:
                self.reason = self.reason or "generations"
                self.close()
                return None
            yield from self._take((yield from next_event(self._subscription)))

    def rated_step(self, sent: Plan[bool] | None) -> Plan[Generation | Population | None]:
        """Like next(), but also returns each population for whose fitness the world waits.

        sent  sends the fitness of the population that was returned before: one plan is faster than two.
        """
        if sent is not None and not (yield from sent):
            self._to_rate[1].clear()
        while True:
            generation, islands = self._to_rate
            while islands:
                found = yield from population(self._world, islands.pop(0), gene_names_of(self.info))
                if found.generation == generation:
                    return found
                islands.clear()  # another client has rated this generation
            step = yield from self.step()
            if not isinstance(step, world_pb2.AwaitedFitness):
                return step
            self._to_rate = step.generation, list(step.islands)

    def _take(self, event: stream_pb2.Event) -> Plan[None]:
        kind = event.WhichOneof("kind")
        if kind == "events_dropped":
            yield from self._catch_up()
        elif kind == "world_damaged":
            self.close()
            raise damaged_world(event)
        elif event.run_id != self.info.run_id:
            if kind in ("world_reset", "world_deleted") and self._began:
                raise self._close_with_error(kind.removeprefix("world_"))
        elif kind == "generation_finished":
            number = event.generation_finished.statistics[0].generation
            if number > self._next:
                yield from self._fill(number - 1)
            if number >= self._next:
                self._ready += generations_of(event.generation_finished.statistics, gene_names_of(self.info))
        elif kind == "fitness_awaited":
            self._awaited = event.fitness_awaited
        elif kind == "run_control_changed":
            info = event.run_control_changed.world
            self._began = self._began or _goal_of(info) == self._goal and info.state == world_pb2.RUN_STATE_RUNNING
            if self._began:
                self._update_goal(info)
                if self._over:
                    yield from self._fill()
        elif kind == "run_terminated":
            yield from self._catch_up()
            self._over = True
        elif kind in ("world_reset", "world_deleted"):
            raise self._close_with_error(kind.removeprefix("world_"))

    def _catch_up(self) -> Plan[None]:
        """Requests the state of the world and the ended generations, after events were missed."""
        try:
            info = yield from world_info(self._world)
        except NotFound:
            raise self._close_with_error("deleted") from None
        except FailedPrecondition:  # the world is damaged
            self.close()
            raise
        if info.run_id != self.info.run_id:
            raise self._close_with_error("reset")
        self._began = True
        self._update_goal(info)
        self._await_fitness(info)
        yield from self._fill()

    def _await_fitness(self, info: world_pb2.WorldInfo) -> None:
        self._awaited = info.awaited_fitness if info.HasField("awaited_fitness") else None

    def _update_goal(self, info: world_pb2.WorldInfo) -> None:
        if info.state == world_pb2.RUN_STATE_TERMINATED:
            self.reason = str(world_pb2.Outcome.Name(info.outcome)).removeprefix("OUTCOME_").lower()
        # A lease pauses the world for a while only.
        is_paused = info.state == world_pb2.RUN_STATE_PAUSED and not info.leased
        if is_paused:
            self.reason = "pause"
        if is_paused or info.state in (world_pb2.RUN_STATE_WAITING, world_pb2.RUN_STATE_TERMINATED):
            self._over = True
        else:
            self._goal = _goal_of(info)

    def _fill(self, last: int | None = None) -> Plan[None]:
        """Adds ended generations to _ready, up to `last`, but not beyond the goal."""
        first = max(self._next, self._ready[-1].number + 1 if self._ready else 0)
        if last is None or first <= last:
            ended = yield from history(self._world, first, last, None)
            self._ready += [g for g in ended if self._goal is None or g.number < self._goal]

    def _close_with_error(self, how: str) -> NotFound:
        self.close()
        return NotFound(f"the world '{self._world}' was {how} while it ran")

    def close(self) -> None:
        """Ends the subscription. Afterwards next() returns None."""
        self._over, self.is_open = True, False
        self._core.unsubscribe(self._subscription)


def next_event(subscription: Subscription) -> Plan[stream_pb2.Event]:
    """Waits for an event. Raises Error if the server refused the subscription after a reconnect."""
    yield Until(lambda: subscription.has_event or subscription.refused)
    event = subscription.take_event()
    if event is None:
        raise subscription.refused or DamagedData("the subscription ended without an event")
    return event


def _goal_of(info: world_pb2.WorldInfo) -> int | None:
    """Returns the first generation after the run; None if the world runs until it is paused."""
    return info.run_until_generation if info.HasField("run_until_generation") else None


def close_replay(world: str) -> Plan[None]:
    """Closes a replay. Does nothing if the replay has already ended with its session, or ends with it now."""
    try:
        yield from request("close_replay", world=world)
    except (NotFound, NoConnection):
        pass


# ---- queries
# ------------------------------------------------------------------------------------------------------------


def worlds() -> Plan[Sequence[world_pb2.WorldInfo]]:
    """Returns the state of all worlds."""
    infos: Sequence[world_pb2.WorldInfo] = (yield from request("list_worlds")).worlds.worlds
    return infos


def damaged_worlds() -> Plan[Sequence[world_pb2.DamagedWorld]]:
    """Returns the worlds that do not run, because the server cannot restore them."""
    damaged: Sequence[world_pb2.DamagedWorld] = (yield from request("list_worlds")).worlds.damaged
    return damaged


def world_info(world: str) -> Plan[world_pb2.WorldInfo]:
    """Returns the state of a world or replay. The request ListWorlds would not return replays."""
    return (yield from request("get_statistics", world=world)).statistics.world


def history(world: str, first: int | None, last: int | None, island: int | None) -> Plan[History]:
    """Requests the ended generations in several parts and returns them."""
    rows: list[world_pb2.GenerationStatistics] = []
    while True:
        response = yield from request("get_history", world=world, first_generation=first, last_generation=last,
                                      island=island)
        answer = response.history
        rows += answer.generations
        if not answer.HasField("next_generation"):
            names = yield from gene_names(world, len(rows[0].genes) if rows else None)
            return History(generations_of(rows, names))
        first = answer.next_generation


def gene_list(genes: Sequence[Mapping[str, object]]) -> world_pb2.FreeGeneList:
    """Converts a list of free genes, as experiment files contain it, to a message.

    Raises InvalidArgument if an entry has an unknown field or a value of another type. The server checks the rest.
    """
    message = world_pb2.FreeGeneList()
    for index, gene in enumerate(genes):
        fields: dict[str, Any] = {**gene, "logarithmic": gene.get("scale", "linear") == "logarithmic"}
        if fields.pop("scale", "linear") not in ("linear", "logarithmic"):
            raise wrong_argument(f"free_genes[{index}].scale", '"linear" or "logarithmic"', repr(gene["scale"]))
        try:
            fields.setdefault("name", f"free{index}")
            message.genes.add(**fields)
        except (TypeError, ValueError) as error:
            raise wrong_argument(f"free_genes[{index}]", "a gene such as evod.genes.Real(\"rate\", 0, 1)",
                                 repr(gene)) from error
    return message


def gene_names_of(world: world_pb2.WorldInfo) -> GeneNames:
    """Returns the names of the genes of a world, and their choices."""
    return GeneNames(world.gene_names, {gene.name: tuple(gene.choices) for gene in world.free_genes.genes
                                        if gene.choices})


def gene_names(world: str, count: int | None) -> Plan[GeneNames]:
    """Returns the names of the genes of a world in which organisms had `count` genes; None: an unknown number."""
    names = gene_names_of((yield from world_info(world)))
    if count not in (None, len(names)):
        raise NotFound(f"the world '{world}' was reset while its genes were requested")
    return names


def population(world: str, island: int, names: Sequence[str] | None = None) -> Plan[Population]:
    """Requests the population of an island in several parts and returns it. All parts belong to the same generation.

    names  of the genes; None: requested from the server
    """
    parts: list[c.Population] = []
    first = 0
    while True:
        response = yield from request(
            "get_population", world=world, island=island, first_organism=first, with_life=True
        )
        part = response.population
        if parts and part.generation != parts[-1].generation:  # the next generation has begun: request all parts again
            parts, first = [], 0
            continue
        parts.append(part)
        first = part.first + part.count
        if first >= part.organism_count or part.count == 0:
            if names is None:
                names = yield from gene_names(world, gene_count_of(parts[0]))
            return population_of(parts, island, names)


def genes_of(snapshot: Snapshot) -> Plan[Genes]:
    """Requests the genes of all organisms in the generation of a snapshot, ordered by id."""
    now = yield from population(snapshot.world, snapshot.island)
    if now.generation == snapshot.generation:
        genes = now.genes
    else:  # the next generation has begun: the run file contains the genes
        text = yield from export(snapshot.world, "population", "csv", snapshot.generation, None)
        rows = [row for row in csv.DictReader(io.StringIO(text)) if int(row["island"]) == snapshot.island]
        names = now.genes.names or GeneNames(GENE_NAMES)
        genes = Genes(numpy.array([[names.value(name, row[name]) for name in names] for row in rows], numpy.float32),
                      names)
    if (yield from world_info(snapshot.world)).run_id != snapshot.run_id:
        raise NotFound(f"the world '{snapshot.world}' was reset before the genes of the snapshot were requested")
    return genes


def export(
    world: str, table: str, text_format: str, generation: int | None, of: tuple[int, int, int] | None
) -> Plan[str]:
    """Requests a table in several parts and returns it as text."""
    organism = None
    if of is not None:
        organism = build(c.OrganismName, "of.", **dict(zip(("generation", "island", "organism"), of)))
    data = yield from exported(
        world=world,
        table=_choice("table", table, TABLES),
        format=_choice("format", text_format, FORMATS),
        generation=generation,
        of=organism,
    )
    return data.decode()


def exported(**fields: Any) -> Plan[bytes]:
    """Requests an export in several parts and returns its bytes."""
    part = (yield from request("export_run", **fields)).export_part
    data = [part.text]
    while not part.last:
        part = (yield from request("continue_export", export_id=part.export_id)).export_part
        data.append(part.text)
    return b"".join(data)


# ---- arguments
# ----------------------------------------------------------------------------------------------------------


def build(message: type[M], field_prefix: str, /, **fields: Any) -> M:
    """Creates a message. Fields that are None stay unset. Raises InvalidArgument with every field whose value
    has a wrong type."""
    try:
        whole: M = message(**fields)
        return whole
    except (TypeError, ValueError):
        violations = []
    for name, value in fields.items():
        try:
            message(**{name: value})
        except (TypeError, ValueError):
            allowed = _ALLOWED.get(message.DESCRIPTOR.fields_by_name[name].type, "a value of the type of the field")
            violations.append(Violation(argument_of(field_prefix + name), allowed, str(value)))
    raise InvalidArgument("an argument is not allowed", violations)


def speed_message(speed: float | str) -> world_pb2.Speed:
    """Converts a speed to the message to send. The speed is a factor of real time, or "max"."""
    if speed == "max":
        return world_pb2.Speed(max=True)
    if isinstance(speed, (str, bool)) or not isinstance(speed, (int, float, numpy.number)):
        raise wrong_argument("speed", "0.001 to 10000, or max", speed)
    return build(world_pb2.Speed, "set_speed.speed.", real_time_factor=speed)


def moment_message(generation: int | None, tick: int | None) -> c.RunMoment:
    """Converts a moment of a run to the message to send."""
    return build(c.RunMoment, "", generation=generation, tick=tick)


def view_message(
    region: tuple[float, float, float, float] | None, detail: str | None, bytes_per_s_max: int | None
) -> c.View | None:
    """Converts a view to the message to send; returns None if no argument is given: snapshots then have no tiles."""
    if region is None and detail is None and bytes_per_s_max is None:
        return None
    part = None
    if region is not None:
        names = ("left_px", "top_px", "width_px", "height_px")
        if len(region) != len(names):
            raise wrong_argument("region", "left, top, width and height in px", region)
        part = build(c.Region, "region.", **dict(zip(names, region)))
    wanted = None if detail is None else _choice("detail", detail, DETAILS)
    return build(c.View, "", region=part, detail=wanted, bytes_per_s_max=bytes_per_s_max)


def _choice(field: str, word: str, choices: Mapping[str, Any]) -> Any:
    if word not in choices:
        raise wrong_argument(field, ", ".join(choices), word)
    return choices[word]

