"""Plans that need the core, the parameter registry or the speed of new worlds. This module does no I/O."""
from __future__ import annotations

import re
from typing import Any, Iterable, Mapping, Sequence

import numpy
import numpy.typing

from evod import snapshot_decoder, solutions
from evod.conversion import result
from evod.core import UNACKNOWLEDGED_MAX, Core, Subscription
from evod.errors import Error, FailedPrecondition, NotFound, Unimplemented, Violation, copy_of, wrong_argument
from evod.generations import Solution
from evod.genes import GeneNames, Genes
from evod.parameters import Parameters, PlannedChange, Registry
from evod.plans import (
    build,
    execute,
    gene_list,
    gene_names,
    gene_names_of,
    GenerationStream,
    next_event,
    Plan,
    population,
    request,
    request_world,
    SnapshotStream,
    speed_message,
    Until,
    world_info,
)
from evod.results import EntityIds
from evod.snapshots import Snapshot
from evod.v1 import commands_pb2 as c, stream_pb2, world_pb2


class LabPlans:
    """Plans that need the core, the parameter registry or the speed of new worlds. Each connection has one LabPlans."""

    def __init__(self, core: Core) -> None:
        self.core = core
        self._registry: Registry | None = None
        self._registry_instance = ""  # instance_id of the server that sent the registry
        self.speed_of_new_worlds: float | str | None = None  # None: real time

    # ---- the server -------------------------------------------------------------------------------------------------

    def registry(self) -> Plan[Registry]:
        """Returns the parameter registry. Requests it once for each server process."""
        instance = self.core.welcome.instance_id if self.core.welcome else ""
        if self._registry is None or self._registry_instance != instance:
            description = (yield from request("describe")).description
            self._registry, self._registry_instance = Registry.of(description), instance
        return self._registry

    def world_name(self, name: str | None) -> Plan[str]:
        """Checks that a world exists and returns its name. Default: the only world, or "default" if there are
        several."""
        listed = (yield from request("list_worlds")).worlds
        names = sorted(world.name for world in (*listed.worlds, *listed.damaged))
        if name is None:
            name = names[0] if len(names) == 1 else "default"
        if name not in names:
            raise NotFound(f"there is no world '{name}'; the worlds are: {', '.join(names) or 'none'}")
        return name

    # ---- parameters -------------------------------------------------------------------------------------------------

    def parameters(self, world: str) -> Plan[Parameters]:
        """Returns all parameters of a world."""
        registry = yield from self.registry()
        return Parameters(registry, (yield from request("get_parameters", world=world)).parameters)

    def set_parameters(
        self,
        world: str,
        values: Mapping[str, object],
        dry_run: bool,
        expected_revision: int | None,
        at_generation: int | None = None,
        at_tick: int | None = None,
    ) -> Plan[Parameters]:
        """Sets values now or plans the change. If a value is out of range, raises Error before a request is sent."""
        registry = yield from self.registry()
        if at_generation is not None or at_tick is not None:
            self._require("planned_changes", "does not support planned changes")
        response = yield from request(
            "set_parameters",
            world=world,
            parameters=registry.assignments(values),
            dry_run=dry_run,
            expected_revision=expected_revision,
            at_generation=at_generation,
            at_tick=at_tick,
        )
        if not response.HasField("planned_change"):
            return Parameters(registry, response.parameters)
        change = PlannedChange.of(response.planned_change)
        return Parameters(registry, (yield from request("get_parameters", world=world)).parameters, change)

    def cancel_change(self, world: str, change: int | PlannedChange) -> Plan[PlannedChange]:
        """Cancels a planned change. `change` is the change or its id."""
        yield from self.registry()
        self._require("planned_changes", "does not support planned changes")
        identity = change.id if isinstance(change, PlannedChange) else change
        response = yield from request("cancel_change", world=world, id=identity)
        return PlannedChange.of(response.planned_change)

    def place(
        self,
        world: str,
        island: int,
        food: numpy.typing.ArrayLike,
        poison: numpy.typing.ArrayLike,
        organisms: Iterable[tuple[float, float, object]],
    ) -> Plan[EntityIds]:
        """Places items at positions of shape (count, 2), and organisms given as x, y and genes."""
        yield from self.registry()
        self._require("place", "cannot place or remove items and organisms")
        positions = {"food": _positions("food", food), "poison": _positions("poison", poison)}
        items = [
            c.PlacedItem(kind=kind, x_px=x, y_px=y)
            for kind, name in ((c.ITEM_KIND_FOOD, "food"), (c.ITEM_KIND_POISON, "poison"))
            for x, y in positions[name]
        ]
        placed = []
        for index, organism in enumerate(organisms):
            placed.append((yield from _placed_organism(world, index, organism)))
        try:
            response = yield from request("place", world=world, island=island, items=items, organisms=placed)
        except Error as error:
            raise _with_lists(error, len(positions["food"])) from None
        ids: EntityIds = result(response.placed)
        return ids

    def remove(
        self,
        world: str,
        island: int,
        generation: int | None,
        food: Iterable[int],
        poison: Iterable[int],
        organisms: Iterable[int],
    ) -> Plan[EntityIds]:
        """Removes items and organisms by their ids."""
        yield from self.registry()
        self._require("place", "cannot place or remove items and organisms")
        response = yield from request(
            "remove",
            world=world,
            island=island,
            generation=generation,
            food=list(food),
            poison=list(poison),
            organisms=list(organisms),
        )
        ids: EntityIds = result(response.removed)
        return ids

    def rated_world(self, world: str) -> Plan[tuple[bool, int]]:
        """Returns whether the organisms of a world that clients rate live on islands, and how many numbers rate each.

        Raises FailedPrecondition if the world computes its fitness itself.
        """
        parameters = yield from self.parameters(world)
        self._require("fitness", "computes fitness itself and takes none from clients")
        if parameters.fitness != "external":
            raise FailedPrecondition(
                f"the world '{world}' computes its fitness itself: set fitness to external and reset the world, "
                "or create a world with fitness external",
                [Violation("fitness", "external", str(parameters.fitness))],
            )
        return bool(parameters.external_bodies), int(parameters.objectives)

    def hall_of_fame(
        self, world: str, k: int, first: int | None, last: int | None, island: int | None, minimize: bool
    ) -> Plan[list[Solution]]:
        """Returns the k best organisms of ended generations, best first."""
        names = gene_names_of((yield from world_info(world)))
        return (yield from solutions.hall_of_fame(world, names, k, first, last, island, minimize))

    def set_fitness(
        self, world: str, generation: int, island: int, fitness: numpy.typing.NDArray[Any],
        genes: numpy.typing.NDArray[Any] | None = None
    ) -> Plan[bool]:
        """Sends the fitness of all organisms of an island, and their repaired chromosomes; returns False if the server
        needs them no longer."""
        limit = self.core.welcome.limits.control_frame_bytes_max if self.core.welcome else 0
        bytes_each = fitness[:1].size * 8 + (0 if genes is None else genes[:1].size * 4)
        most = max(((limit or 65536) - 4096) // bytes_each, 1)  # the organisms in one request
        for first in range(0, len(fitness), most):
            try:
                yield from request(
                    "set_fitness",
                    world=world,
                    generation=generation,
                    island=island,
                    first_organism=first,
                    fitness=fitness[first : first + most].ravel(),
                    genes=() if genes is None else genes[first : first + most].ravel(),
                )
            except Error as error:
                if error.reason in (c.REASON_FITNESS_NOT_AWAITED, c.REASON_GENERATION_CHANGED):
                    return False
                raise
        return True

    def _require(self, feature: str, what: str) -> None:
        """Raises Unimplemented if the server lacks a feature. It might apply such a request in another way."""
        welcome = self.core.welcome
        if welcome is not None and feature not in welcome.features:
            raise Unimplemented(f"the server, evod {welcome.server_version}, {what}: update it")

    def new_world(
        self,
        name: str,
        parameters: Mapping[str, object],
        seed: int | None,
        population: Sequence[numpy.typing.ArrayLike] | None,
    ) -> Plan[c.CreateWorld]:
        """Returns the request that creates a world."""
        registry = yield from self.registry()
        parameters = dict(parameters)
        listed = parameters.pop("free_genes", None)
        if not isinstance(listed, (list, tuple)) and listed is not None:
            parameters["free_genes"] = listed
        first, later = registry.planned(parameters)
        if later:
            self._require("planned_changes", "does not support planned changes")
        return build(
            c.CreateWorld,
            "create_world.",
            name=name,
            parameters=first,
            schedule=later,
            seed=seed,
            population=[c.IslandPopulation(genes=_numbers(genes, listed).ravel()) for genes in population or ()],
            population_gene_names=_gene_names_in(population),
            free_genes=gene_list(listed) if isinstance(listed, (list, tuple)) else None,
        )

    def create_world(
        self,
        name: str,
        parameters: Mapping[str, object],
        seed: int | None,
        population: Sequence[numpy.typing.ArrayLike] | None,
        speed: float | str | None,
    ) -> Plan[str]:
        """Creates a world and sets its speed; returns its name."""
        speed = self.speed_of_new_worlds if speed is None else speed
        requested = None if speed is None else speed_message(speed)  # raises before the world is created
        message = yield from self.new_world(name, parameters, seed, population)
        info = (yield from execute(c.Request(create_world=message))).world
        world = info.name
        columns = len(info.gene_names)  # the server sees only how many numbers there are
        for island, genes in enumerate(population or ()):
            if numpy.ndim(genes) == 2 and numpy.shape(genes)[1] != columns:
                yield from request("delete_world", world=world)
                allowed = f"the shape (organisms, {columns}): a column for each of {', '.join(info.gene_names[:8])}"
                raise wrong_argument(f"population[{island}]", allowed + (", …" if columns > 8 else ""),
                                     f"the shape {numpy.shape(genes)}")
        if requested is not None:
            yield from request("set_speed", world=world, speed=requested)
        return world

    def derived_world(self, kind: str, /, **fields: Any) -> Plan[str]:
        """Sends ForkWorld or OpenReplay, and sets the speed of the new world; returns its name."""
        world = (yield from request_world(kind, **fields)).name
        if self.speed_of_new_worlds is not None:
            yield from request("set_speed", world=world, speed=speed_message(self.speed_of_new_worlds))
        return world

    # ---- subscriptions ----------------------------------------------------------------------------------------------

    def subscribe_events(self, world: str | None) -> Plan[Subscription]:
        """Subscribes to the events of a world, or of all worlds."""
        request = c.Request(subscribe_events=c.SubscribeEvents(world=world))
        return (yield from self._subscribe(request))

    def subscribe_snapshots(
        self, world: str, island: int | None, rate_hz: float, view: c.View | None
    ) -> Plan[Subscription]:
        """Subscribes to snapshots. Requests the best codec and compression that this client can decode."""
        snapshots = build(
            c.SubscribeSnapshots,
            "subscribe_snapshots.",
            world=world,
            island=island,
            rate_hz=rate_hz,
            codec=stream_pb2.CODEC_DELTA,
            compression=stream_pb2.COMPRESSION_ZSTD if snapshot_decoder.can_unpack else stream_pb2.COMPRESSION_NONE,
            unacknowledged_max=UNACKNOWLEDGED_MAX,
            headings=True,
            species=True,
            view=view,
        )
        return (yield from self._subscribe(c.Request(subscribe_snapshots=snapshots)))

    def _subscribe(self, request: c.Request) -> Plan[Subscription]:
        subscription = self.core.subscribe(request)
        yield Until(lambda: subscription.sessions or subscription.refused, within_timeout=True)
        if subscription.refused:
            self.core.unsubscribe(subscription)
            raise subscription.refused
        return subscription

    def run(self, world: str, generations: int | None) -> Plan[GenerationStream]:
        """Runs a world. Subscribes to its events before, so that no generation is missed."""
        stream = GenerationStream(self.core, world, (yield from self.subscribe_events(world)))
        try:
            # A waiting world is at the end of a generation. The event for this generation was sent earlier, so the
            # stream begins with the next generation.
            last = (yield from request("get_statistics", world=world)).statistics.last
            info = yield from request_world("run", world=world, generations=generations)
        except BaseException:
            stream.close()
            raise
        stream.begin(info, max(info.generation, last[0].generation + 1 if last else 0))
        return stream

    def wait(self, world: str) -> Plan[world_pb2.WorldInfo]:
        """Waits until the world is not running any more."""
        subscription = yield from self.subscribe_events(world)
        try:
            while True:
                info = yield from world_info(world)
                if info.state != world_pb2.RUN_STATE_RUNNING:
                    return info
                changed = False
                while not changed:
                    event = yield from next_event(subscription)
                    changed = event.WhichOneof("kind") not in ("generation_finished", "migration", "extinction")
        finally:
            self.core.unsubscribe(subscription)

    def step(self, world: str, ticks: int) -> Plan[world_pb2.WorldInfo]:
        """Runs a number of ticks and waits for the last one."""
        if isinstance(ticks, bool) or not isinstance(ticks, (int, numpy.integer)) or not 0 <= ticks < 2**64:
            raise wrong_argument("ticks", f"a whole number, 0 to {2**64 - 1}", ticks)
        tick = (yield from world_info(world)).tick + ticks
        yield from request("run_until_tick", world=world, tick=tick)
        return (yield from self.wait(world))

    def snapshot(self, world: str, island: int, genes: bool) -> Plan[Snapshot]:
        """Returns the current state of an island. Subscribes to snapshots and ends the subscription after the first
        one."""
        stream = SnapshotStream(self.core, (yield from self.subscribe_snapshots(world, island, 1, None)), genes)
        try:
            return (yield from stream.next())
        finally:
            stream.close()


def _gene_names_in(population: Sequence[numpy.typing.ArrayLike] | None) -> Sequence[str]:
    """The names of the genes of an initial population; () if its arrays have no names."""
    first = population[0] if population else None
    return first.names or () if isinstance(first, Genes) else ()


def _numbers(genes: numpy.typing.ArrayLike, listed: Any) -> numpy.typing.NDArray[Any]:
    """Converts chromosomes to numbers. The genes of a list, which are the last ones, may be the texts of choices."""
    array = numpy.asarray(genes)
    if array.dtype.kind in "OU" and array.ndim == 2 and isinstance(listed, (list, tuple)):
        array = array.astype(object)
        columns = [gene.get("choices", ()) for gene in listed for _ in range(gene.get("permutation", 1))]
        names = GeneNames((), {str(column): [str(choice) for choice in choices]
                               for column, choices in enumerate(columns, array.shape[1] - len(columns))})
        for (row, column), value in numpy.ndenumerate(array):
            array[row, column] = names.value(str(column), value)
    return numpy.asarray(array, "<f4")


def _positions(field: str, positions: numpy.typing.ArrayLike) -> list[tuple[float, float]]:
    try:
        array = numpy.asarray(positions, float)
    except (TypeError, ValueError):
        raise wrong_argument(field, "pairs of numbers: x and y in px", positions) from None
    if array.size == 0:
        return []
    if array.ndim != 2 or array.shape[1] != 2:
        raise wrong_argument(field, "pairs of numbers: x and y in px", positions)
    return [(float(x), float(y)) for x, y in array]


def _placed_organism(world: str, index: int, organism: tuple[float, float, object]) -> Plan[c.PlacedOrganism]:
    allowed = "x and y in px, and the genes: a number for each, or numbers by gene name"
    try:
        x, y, genes = organism
        values = genes
        if isinstance(genes, Mapping):
            names = yield from gene_names(world, len(genes))
            values = [names.value(name, genes[name]) for name in names]
        numbers = numpy.asarray(values, "<f4").ravel()
        return c.PlacedOrganism(x_px=float(x), y_px=float(y), genes=numbers)
    except (KeyError, TypeError, ValueError):
        raise wrong_argument(f"organisms[{index}]", allowed, organism) from None


def _with_lists(error: Error, food_count: int) -> Error:
    """Renames the items in a refusal of Place: the request contains the food, then the poison."""

    def renamed(field: str) -> str:
        found = re.match(r"items\[(\d+)\]", field)
        if found is None:
            return field
        index = int(found[1])
        name = f"food[{index}]" if index < food_count else f"poison[{index - food_count}]"
        return name + field[found.end() :]

    copy = copy_of(error)
    copy.violations = tuple(Violation(renamed(v.field), v.allowed, v.got) for v in error.violations)
    return copy

