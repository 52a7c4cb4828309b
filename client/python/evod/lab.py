"""The plain face: labs, worlds, and what comes of them; every call waits for its answer."""
from __future__ import annotations

from typing import Any, Iterator, Mapping, Sequence, TypeVar

import numpy.typing

from evod import plans
from evod.core import Core
from evod.endpoint import Endpoint, tls_context, token_of
from evod.generations import Generation, Population
from evod.link import Link
from evod.parameters import Parameters, PlannedChange, Registry, Value
from evod.snapshots import Snapshot
from evod.v1 import commands_pb2 as c, session_pb2, stream_pb2, world_pb2

T = TypeVar("T")


def connect(
    server: str = "localhost",
    *,
    token: str | None = None,
    token_file: str | None = None,
    tls: bool = False,
    ca: str | None = None,
    cert: str | None = None,
    key: str | None = None,
    timeout_s: float = 30.0,
    reconnect: bool = True,
    client_name: str = "evod for Python",
) -> Lab:
    """Connects with a server: HOST, HOST:PORT or [IPV6]:PORT; port 7744 unless said otherwise.

    token, token_file    who comes: a token, or a file with one that nobody else can read; else the environment's EVOD_TOKEN.
    tls                  TLS with a server whose certificate this system trusts.
    ca                   TLS; PEM file of who vouches for the server: its own evod.crt, perhaps; else the environment's EVOD_CA.
    cert, key            TLS; PEM files of a certificate of ours, for servers that want one.
    timeout_s            how long an answer may take, and how long a server may be away.
    reconnect            whether a line that broke is to be opened again.

    NoConnection: there is no server, or it does not want us.

    >>> import evod
    >>> with evod.local() as server:  # in place of a server of yours
    ...     with evod.connect(server.address) as lab:
    ...         lab.role, [info.name for info in lab.worlds()]
    ('admin', ['default'])
    """
    where = Endpoint.parse(server)
    core = Core(token=token_of(token, token_file), client_name=client_name, server=where)
    link = Link(where, core, tls_context(tls, ca, cert, key), timeout_s=timeout_s, reconnect=reconnect)
    link.open()
    return Lab(link)


class _Closing:
    """Something that is closed at the end of a `with`."""

    def close(self) -> None:
        raise NotImplementedError

    def __enter__(self: T) -> T:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()


class Lab(_Closing):
    """A connection with a server, and the worlds on it. Made by connect() or local(); close() ends it, as does `with`."""

    def __init__(self, link: Link) -> None:
        self._link = link
        self._desk = plans.Desk(link.core)

    def __repr__(self) -> str:
        return f"<evod at {self.address}>"

    def close(self) -> None:
        self._link.close()

    @property
    def address(self) -> str:
        """HOST:PORT of the server."""
        return str(self._link.server)

    @property
    def welcome(self) -> session_pb2.Welcome:
        """What the server said of itself when we came last: version, limits, durability, …"""
        return self._link.core.welcome or session_pb2.Welcome()

    @property
    def client_key(self) -> str:
        """What our commands are known by, in journals too."""
        return self._link.core.client_key

    @property
    def damaged_snapshot_count(self) -> int:
        """Pictures that were thrown away because they could not be decoded; others were asked for."""
        return self._link.core.damaged_snapshot_count

    @property
    def role(self) -> str:
        """What we may do there: "viewer", "controller" or "admin"."""
        return str(session_pb2.Role.Name(self.welcome.role)).removeprefix("ROLE_").lower()

    def request(self, **request: Any) -> c.Response:
        """Any request of the protocol, by its name; Error: it was refused.

        >>> import evod
        >>> from evod.v1 import commands_pb2
        >>> with evod.local() as lab:
        ...     lab.request(run_until_tick=commands_pb2.RunUntilTick(tick=60)).applied_tick
        0
        """
        return self._link.perform(plans.answer_to(c.Request(**request)))

    # ---- worlds ---------------------------------------------------------------------------------------------------

    def worlds(self) -> Sequence[world_pb2.WorldInfo]:
        """In order of creation."""
        return self._link.perform(plans.worlds())

    def world(self, name: str | None = None) -> World:
        """The world of that name; without one the only world there is, or "default" if there are several."""
        return World(self, self._link.perform(self._desk.name_of(name)))

    def create_world(
        self,
        name: str,
        parameters: Mapping[str, object] | None = None,
        *,
        seed: int | None = None,
        population: Sequence[numpy.typing.ArrayLike] | None = None,
        speed: float | str | None = None,
    ) -> World:
        """A new world; it waits to be told to run.

        parameters   the rest have their defaults. A mapping instead of a value schedules it: {1: 0.2, 30: 0.05} holds from
                     the first tick of these generations; until the first of them, the default.
        seed         otherwise one that the server draws.
        population   what its first generation consists of, one array of shape (population_size, 6) for each island; otherwise
                     that is drawn by the seed.
        speed        as of World.set_speed(); otherwise that of the clock, or of evod.local().

        >>> import evod
        >>> with evod.local() as lab:
        ...     world = lab.create_world("small", {"population_size": 10}, seed=7)
        ...     world.info().seed, len(world.population())
        (7, 10)
        """
        return World(self, self._link.perform(self._desk.create_world(name, parameters or {}, seed, population, speed)))

    # ---- the server -----------------------------------------------------------------------------------------------

    def registry(self) -> Registry:
        """Every parameter there is."""
        return self._link.perform(self._desk.registry())

    def describe(self) -> c.Description:
        """The messages it knows, the registry and the limits, as they are told."""
        return self._link.perform(plans.ask("describe")).description

    def metrics(self) -> c.Metrics:
        """What the server counts and measures."""
        return self._link.perform(plans.ask("get_metrics")).metrics

    def events(self) -> Events:
        """Events of all worlds, from now on."""
        return Events(self._link, plans.EventStream(self._link.core, self._link.perform(self._desk.subscribe_events(None))))

    def shut_down(self) -> None:
        """Ends the server: what was asked is still answered, all runs are written down."""
        self._link.perform(plans.ask("shut_down"))


class World:
    """One experiment on a server; made by Lab.world() and Lab.create_world()."""

    def __init__(self, lab: Lab, name: str) -> None:
        self._lab, self._name = lab, name
        self._link, self._desk = lab._link, lab._desk

    @property
    def name(self) -> str:
        return self._name

    @property
    def lab(self) -> Lab:
        return self._lab

    def __repr__(self) -> str:
        return f"<world {self.name} at {self._lab.address}>"

    def _command(self, kind: str, /, **fields: Any) -> world_pb2.WorldInfo:
        return self._link.perform(plans.ask_for_world(kind, world=self.name, **fields))

    # ---- parameters -----------------------------------------------------------------------------------------------

    @property
    def parameters(self) -> LiveParameters:
        """The parameters as attributes, as they are now; assigning one sets it.

        >>> import evod
        >>> with evod.local() as lab:
        ...     world = lab.world()
        ...     world.parameters.mutation_chance = 0.3
        ...     world.parameters.mutation_chance, world.parameters["mutation_chance"].allowed
        (0.3, '0 to 1')
        """
        return LiveParameters(self)

    def get_parameters(self) -> Parameters:
        """All of them, as they are now."""
        return self._link.perform(self._desk.parameters(self.name))

    def set(
        self,
        values: Mapping[str, object] | None = None,
        /,
        *,
        dry_run: bool = False,
        expected_revision: int | None = None,
        at_generation: int | None = None,
        at_tick: int | None = None,
        **more: object,
    ) -> Parameters:
        """Sets parameters, all of them or none: ``world.set(mutation_chance=0.1, selection="tournament")``.

        dry_run             checks and answers as if it were done, and changes nothing.
        expected_revision   refused if somebody has changed parameters since that Parameters.revision was read.
        at_generation       not now, but from the first tick of that generation on.
        at_tick             not now, but right after that tick since the run began. What is planned is in Parameters.change.

        Error: every value that is not allowed; those that are out of range are not even sent.
        """
        given = {**(values or {}), **more}
        plan = self._desk.set_parameters(self.name, given, dry_run, expected_revision, at_generation, at_tick)
        return self._link.perform(plan)

    @property
    def planned_changes(self) -> tuple[PlannedChange, ...]:
        """What waits for its generation or tick, in the order in which it was planned."""
        return self.get_parameters().planned

    def cancel(self, change: int | PlannedChange) -> PlannedChange:
        """Takes back a planned change, by its id. Error: it was made, dropped or cancelled."""
        return self._link.perform(self._desk.cancel_change(self.name, change))

    # ---- running --------------------------------------------------------------------------------------------------

    def run(self, generations: int | None = None) -> Run:
        """Runs until so many more generations have ended, without a number on and on; gives them as they end.

        It runs whether somebody looks at them or not; Run.wait() waits for the end.

        >>> import evod
        >>> with evod.local(seed=42) as lab:
        ...     best = [g.best for g in lab.world().run(generations=3)]
        >>> len(best)
        3
        """
        return Run(self._link, self._link.perform(self._desk.run(self.name, generations)))

    def run_until_tick(self, tick: int) -> world_pb2.WorldInfo:
        """Runs until so many ticks of the run are over, then pauses. Answered at once: wait() waits for it."""
        return self._command("run_until_tick", tick=tick)

    def step(self, ticks: int = 1) -> world_pb2.WorldInfo:
        """Runs so many ticks and waits for it.

        >>> import evod
        >>> with evod.local() as lab:
        ...     lab.world().step(60).tick
        60
        """
        return self._link.perform(self._desk.step(self.name, ticks))

    def wait(self) -> world_pb2.WorldInfo:
        """Waits until it does not run."""
        return self._link.perform(self._desk.wait(self.name))

    def pause(self) -> world_pb2.WorldInfo:
        """Stands still; what it was told to run for is remembered."""
        return self._command("pause")

    def resume(self) -> world_pb2.WorldInfo:
        """Goes on with what it was told to run for."""
        return self._command("resume")

    def set_speed(self, speed: float | str) -> world_pb2.WorldInfo:
        """Simulated seconds per second, 0.001 to 10,000, or "max"."""
        return self._command("set_speed", speed=plans.speed_of(speed))

    def reset(self, seed: int | None = None) -> world_pb2.WorldInfo:
        """The run begins again at generation 1, with the same seed or another one; it waits."""
        return self._command("reset_world", seed=seed)

    def release_lease(self) -> world_pb2.WorldInfo:
        """A world that was lent by run_until_tick() or step() goes on."""
        return self._command("release_lease")

    def renew_lease(self) -> None:
        """It stays lent for as long again."""
        self._link.perform(plans.ask("renew_lease", world=self.name))

    def fork(self, name: str, at_generation: int | None = None) -> World:
        """A second world, from the first moment of a generation, or from now; it waits. Nothing happens to this one."""
        return World(self._lab, self._command("fork_world", name=name, at_generation=at_generation).name)

    def delete(self) -> None:
        """The world is gone."""
        self._link.perform(plans.ask("delete_world", world=self.name))

    # ---- looking --------------------------------------------------------------------------------------------------

    def info(self) -> world_pb2.WorldInfo:
        """Where it stands: tick, generation, state, seed, …"""
        return self._link.perform(plans.info_of(self.name))

    def snapshot(self, island: int = 0) -> Snapshot:
        """A picture of an island as it is now."""
        return self._link.perform(self._desk.snapshot(self.name, island))

    def snapshots(
        self,
        rate_hz: float = 30.0,
        *,
        island: int | None = None,
        region: tuple[float, float, float, float] | None = None,
        detail: str | None = None,
        bytes_per_s_max: int | None = None,
    ) -> Snapshots:
        """Pictures, at most so many a second, of one island or of all; who takes long is shown fewer.

        With one of the others they are made of tiles: region (left, top, width, height in px) is what is wanted, detail
        ("full", "dots" or "density") the most that is of use, bytes_per_s_max what the line may be given.

        >>> import evod
        >>> with evod.local(seed=1) as lab:
        ...     world = lab.world()
        ...     with world.snapshots() as snapshots:
        ...         run = world.run(generations=1)
        ...         for snapshot in snapshots:
        ...             if snapshot.tick > 100:
        ...                 break
        >>> snapshot.organisms.health.max() > 0
        True
        """
        view = plans.view_of(region, detail, bytes_per_s_max)
        subscription = self._link.perform(self._desk.subscribe_snapshots(self.name, island, rate_hz, view))
        return Snapshots(self._link, plans.SnapshotStream(self._link.core, subscription))

    def events(self) -> Events:
        """What happens to it, from now on."""
        subscription = self._link.perform(self._desk.subscribe_events(self.name))
        return Events(self._link, plans.EventStream(self._link.core, subscription))

    def statistics(self) -> c.Statistics:
        """How each island is doing now, and what the last generation came to."""
        return self._link.perform(plans.ask("get_statistics", world=self.name)).statistics

    def history(
        self, first: int | None = None, last: int | None = None, *, island: int | None = None
    ) -> list[Generation]:
        """Generations that have ended, as far back as the server keeps them."""
        return self._link.perform(plans.history(self.name, first, last, island))

    def organism(self, organism: int, island: int = 0) -> world_pb2.OrganismInfo:
        """Genes, place, health and parents of one organism, by its id, and what it is about to do."""
        return self._link.perform(plans.ask("get_organism", world=self.name, island=island, organism=organism)).organism

    def population(self, island: int = 0) -> Population:
        """Genes, parents and choices of all organisms of the generation that runs, as arrays.

        >>> import evod
        >>> with evod.local(seed=1) as lab:
        ...     population = lab.world().population()
        >>> population.genes.shape
        (50, 6)
        """
        return self._link.perform(plans.population(self.name, island))

    def breeding(
        self,
        island: int = 0,
        generation: int | None = None,
        *,
        first_contender: int = 0,
        first_pick: int = 0,
        first_descendant: int = 0,
    ) -> c.Breeding:
        """How a generation was bred: the very picks, pairs, cuts and mutations. Without a number the last that has bred."""
        plan = plans.ask(
            "get_breeding",
            world=self.name,
            island=island,
            generation=generation,
            first_contender=first_contender,
            first_pick=first_pick,
            first_descendant=first_descendant,
        )
        return self._link.perform(plan).breeding

    def motion(self, island: int = 0) -> c.Motion:
        """How its bodies move: energy, momentum, overlaps."""
        return self._link.perform(plans.ask("get_motion", world=self.name, island=island)).motion

    def open_replay(self, generation: int | None = None, tick: int | None = None) -> Replay:
        """Its past, as a world beside it: from a generation, a tick of it, or a tick of the run; without a number from the
        beginning. The server has to keep its runs."""
        at = plans.moment_of("open_replay.at.", generation, tick) if (generation, tick) != (None, None) else None
        return Replay(self._lab, self._command("open_replay", at=at).name)

    def export(
        self,
        table: str,
        format: str = "csv",
        *,
        generation: int | None = None,
        of: tuple[int, int, int] | None = None,
    ) -> str:
        """A table of what the world's run file holds, as text: "generations", "organisms", "lineage", "population" or
        "events"; "csv" or "jsonl".

        generation   of the population; otherwise the last that has begun.
        of           the lineage of one organism: its generation, island and id.
        """
        return self._link.perform(plans.export(self.name, table, format, generation, of))

    def table(self, table: str, *, generation: int | None = None, of: tuple[int, int, int] | None = None) -> Any:
        """The same as a pandas DataFrame."""
        from evod.tables import frame_of

        return frame_of(self.export(table, generation=generation, of=of))

    # ---- pictures -------------------------------------------------------------------------------------------------

    def plot(self, island: int = 0, ax: Any = None) -> Any:
        """Draws an island as it is now with matplotlib, into new axes or those that are given; returns them.

        >>> import evod
        >>> with evod.local(seed=1) as lab:
        ...     axes = lab.world().plot()
        >>> axes.get_title()
        'default, generation 1, 50 alive, 0 s'
        """
        return self.snapshot(island).plot(ax)

    def plot_fitness(self, ax: Any = None) -> Any:
        """Draws the fitness of the generations that have ended."""
        from evod import plotting

        return plotting.plot_fitness(plotting.columns_of(self.history(), self.info().gene_names), ax)

    def plot_genes(self, ax: Any = None) -> Any:
        """Draws the genes of the generations that have ended."""
        from evod import plotting

        names = self.info().gene_names
        return plotting.plot_genes(plotting.columns_of(self.history(), names), names, ax)

    def plot_selection(self, gene: str, ax: Any = None) -> Any:
        """Draws what moved the mean of a gene: selection, transmission, migration, and its change, which they make together."""
        from evod import plotting

        names = self.info().gene_names
        return plotting.plot_selection(plotting.columns_of(self.history(), names), names, gene, ax)

    def animate(self, count: int = 100, rate_hz: float = 20.0, island: int = 0) -> Any:
        """Watches an island for so many pictures, or until it does not run, and gives a matplotlib animation of them, which
        notebooks play."""
        from evod import plotting

        seen: list[Snapshot] = []
        with self.snapshots(rate_hz, island=island) as snapshots:
            for snapshot in snapshots:
                seen.append(snapshot)
                if len(seen) >= count or snapshot.state != world_pb2.RUN_STATE_RUNNING:
                    break
        return plotting.animation_of(seen, 1000 / rate_hz)


class Replay(World, _Closing):
    """A world that shows the past of another one; made by World.open_replay(), gone with close() or the connection."""

    def seek(self, generation: int | None = None, tick: int | None = None) -> world_pb2.WorldInfo:
        """To a generation, a tick of it, or a tick of the run; without a number to the last moment that is known."""
        return self._command("seek", to=plans.moment_of("seek.to.", generation, tick))

    def close(self) -> None:
        self._link.perform(plans.close_replay(self.name))


class LiveParameters(Mapping[str, Any]):
    """A world's parameters as they are now, as attributes and by name."""

    def __init__(self, world: World) -> None:
        object.__setattr__(self, "_world", world)

    _world: World

    def __getattr__(self, name: str) -> Value:
        if name.startswith("_"):
            raise AttributeError(name)
        return self._world.get_parameters().__getattr__(name)

    def __setattr__(self, name: str, value: object) -> None:
        self._world.set({name: value})

    def __getitem__(self, name: str) -> Any:
        return self._world.get_parameters()[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._world.lab.registry())

    def __len__(self) -> int:
        return len(self._world.lab.registry())

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self]

    def __repr__(self) -> str:
        return f"<parameters of {self._world!r}>"

    def _repr_html_(self) -> str:
        return self._world.get_parameters()._repr_html_()


class _Stream(_Closing):
    def __init__(self, link: Link, stream: Any) -> None:
        self._link, self._stream = link, stream

    def close(self) -> None:
        """No more of it is sent."""
        self._link.tell(self._stream.close)


class Run(_Stream):
    """The generations of a run as they end, each once, also those that end while the line is broken."""

    _stream: plans.GenerationStream

    @property
    def info(self) -> world_pb2.WorldInfo:
        """The world as it was when it was told to run."""
        return self._stream.info

    def __iter__(self) -> Run:
        return self

    def __next__(self) -> Generation:
        generation = self._link.perform(self._stream.next())
        if generation is None:
            raise StopIteration
        return generation

    def wait(self) -> Generation | None:
        """Waits until it is over; the last generation of those that were not taken yet."""
        last = None
        for last in self:
            pass
        return last


class Snapshots(_Stream):
    """Pictures as they come; the next ones are let come by taking them."""

    _stream: plans.SnapshotStream

    def __iter__(self) -> Snapshots:
        return self

    def __next__(self) -> Snapshot:
        return self._link.perform(self._stream.next())

    @property
    def rate_hz(self) -> float:
        """So many pictures a second are sent at most: what was asked for, or what the server gives."""
        return self._stream.rate_hz

    def set_view(
        self,
        region: tuple[float, float, float, float] | None = None,
        detail: str | None = None,
        bytes_per_s_max: int | None = None,
    ) -> None:
        """Another view for pictures that were asked for with one; holds from the next picture."""
        view = plans.view_of(region, detail, bytes_per_s_max) or c.View()
        self._link.perform(self._stream.set_view(view))

    def request_keyframe(self) -> None:
        """The next pictures are whole, and come at once, even if the world stands still."""
        self._link.perform(self._stream.request_keyframe())


class Events(_Stream):
    """Events as they happen, as the protocol has them. After the line broke an `events_dropped` comes with a count of 0, as
    nobody can tell how many there were meanwhile."""

    _stream: plans.EventStream

    def __iter__(self) -> Events:
        return self

    def __next__(self) -> stream_pb2.Event:
        return self._link.perform(self._stream.next())
