"""Labs, worlds and streams for asyncio. evod.lab, the synchronous module, is generated from this file.

Threads      all calls on the event loop that connect() or local() was awaited on.
"""
from __future__ import annotations

import os
import weakref
from typing import Any, Mapping, Sequence, TypeVar

import numpy.typing

from evod import local_server, plans, plotting, tables
from evod.aio.attributes import ParameterAttributes
from evod.aio.awaitable import opens, opens_stream
from evod.aio.link import Link, blocking_call
from evod.core import Core
from evod.endpoint import Endpoint, read_token, tls_context
from evod.generations import Generation, Population
from evod.parameters import Parameters, PlannedChange, Registry
from evod.snapshots import Snapshot
from evod.v1 import commands_pb2 as c, session_pb2, stream_pb2, world_pb2

T = TypeVar("T")


@opens
async def connect(
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
    """Connects to a server.

    Parameters
    ----------
    server
        HOST, HOST:PORT or [IPV6]:PORT; the default port is 7744.
    token, token_file
        The access token, or a file with it that only its owner may read. Without both, the environment variable EVOD_TOKEN.
    tls
        Use TLS, with a server whose certificate this system trusts.
    ca
        Use TLS, and trust the certificates in this PEM file, such as the server's own evod.crt. Without it, the environment
        variable EVOD_CA.
    cert, key
        Use TLS with this client certificate, for servers that require one; PEM files. The key may be in the same file.
    timeout_s
        How long an answer may take, and how long the server may be unreachable before calls fail, in seconds. Calls that
        make the server replay a run may take 20 times as long.
    reconnect
        Whether to connect again after the connection was lost.
    client_name
        The name of this program in the server's log.

    Raises
    ------
    NoConnection
        There is no server at that address, or it refuses this client.
    DamagedData
        The program at that address is no evod server.

    Examples
    --------
    >>> import evod.aio
    >>> async with evod.aio.local() as server:  # stands for a server of yours
    ...     async with evod.aio.connect(server.address) as lab:
    ...         lab.role, [info.name for info in await lab.worlds()]
    ('admin', ['default'])
    """
    endpoint = Endpoint.parse(server)
    core = Core(token=read_token(token, token_file), client_name=client_name, server=endpoint)
    link = Link(endpoint, core, tls_context(tls, ca, cert, key), timeout_s=timeout_s, reconnect=reconnect)
    await link.open()
    return Lab(link)


@opens
async def local(
    *,
    seed: int | None = None,
    experiment: str | os.PathLike[str] | Mapping[str, object] | None = None,
    data: str | os.PathLike[str] | None = None,
    speed: float | str = "max",
    threads: int | None = None,
    program: str | os.PathLike[str] | None = None,
    timeout_s: float = 30.0,
) -> LocalLab:
    """Starts a private server at a free port and connects to it.

    The server stops when the lab is closed or garbage collected, and when this program ends, even if it is killed.

    Parameters
    ----------
    seed
        Seed of the first world, 0 to 2**64 - 1. Without it the server draws one.
    experiment
        Parameters of the first world: an experiment file, or a mapping of names to values. Without it, all defaults.
    data
        Folder for the run files. Without it, a temporary folder that is deleted with the server.
    speed
        Speed of every world, including those created later: simulated seconds per second, or "max" for as fast as the
        machine allows.
    threads
        Number of threads that simulate. Without it, one for each processor.
    program
        The program evod. Without it, the one that the environment variable EVOD names, or evod on the path.
    timeout_s
        As for `connect`.

    Raises
    ------
    Error
        The program was not found, or the server did not start; the message contains its last lines of output.

    Examples
    --------
    >>> import evod.aio
    >>> async with evod.aio.local(seed=42, experiment={"population_size": 50}) as lab:
    ...     world = await lab.world()
    ...     async for g in world.run(generations=2):
    ...         print(g)
    generation 1: best 337.6, mean 71.1, 25 of 50 alive
    generation 2: best 294.4, mean 84.7, 27 of 50 alive
    """
    server = await blocking_call(local_server.start, seed, experiment, data, speed, threads, program)
    try:
        lab = await connect(server.address, token="", ca="", timeout_s=timeout_s, client_name="evod.local")
        if data is not None:  # worlds found in the folder have the speed that they were stored with
            for info in await lab.worlds():
                world = await lab.world(info.name)
                await world.set_speed(speed)
    except BaseException:
        server.stop()
        raise
    return LocalLab(lab._link, server, speed)


class _Closing:
    """Closes itself at the end of an `async with` block."""

    async def close(self) -> None:
        raise NotImplementedError

    async def __aenter__(self: T) -> T:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()


class Lab(_Closing):
    """A connection to a server and its worlds; made by `connect`."""

    def __init__(self, link: Link) -> None:
        self._link = link
        self._plans = plans.LabPlans(link.core)

    def __repr__(self) -> str:
        return f"<evod at {self.address}>"

    async def close(self) -> None:
        """Closes the connection; calls that wait for an answer fail with NoConnection."""
        await self._link.close()

    @property
    def address(self) -> str:
        """The server's HOST:PORT."""
        return str(self._link.server)

    @property
    def welcome(self) -> session_pb2.Welcome:
        """What the server reported about itself at the last connect: version, limits, durability, features."""
        return self._link.core.welcome or session_pb2.Welcome()

    @property
    def client_key(self) -> str:
        """The random key that identifies this client's commands to the server and in its journals."""
        return self._link.core.client_key

    @property
    def damaged_snapshot_count(self) -> int:
        """How many snapshots were dropped because they could not be decoded; a keyframe was requested after each."""
        return self._link.core.damaged_snapshot_count

    @property
    def role(self) -> str:
        """The role of this client: "viewer", "controller" or "admin"."""
        return str(c.Role.Name(self.welcome.role)).removeprefix("ROLE_").lower()

    async def request(self, **request: Any) -> c.Response:
        """Sends any request of the protocol and returns the response.

        Parameters
        ----------
        **request
            One field of evod.v1.Request, by its name.

        Raises
        ------
        Error
            The server refused the request.

        Examples
        --------
        >>> import evod.aio
        >>> from evod.v1 import commands_pb2
        >>> async with evod.aio.local() as lab:
        ...     response = await lab.request(run_until_tick=commands_pb2.RunUntilTick(tick=60))
        ...     response.applied_tick
        0
        """
        return await self._link.perform(plans.execute(c.Request(**request)))

    async def _request(self, kind: str, /, **fields: Any) -> c.Response:
        return await self._link.perform(plans.request(kind, **fields))

    # ---- worlds ---------------------------------------------------------------------------------------------------

    async def worlds(self) -> Sequence[world_pb2.WorldInfo]:
        """Returns the state of every world, in order of creation."""
        return await self._link.perform(plans.worlds())

    async def world(self, name: str | None = None) -> World:
        """Returns the world of that name; without a name the only world, or "default" if there are several.

        Raises
        ------
        Error
            NOT_FOUND: the server has no such world.
        """
        return World(self, await self._link.perform(self._plans.world_name(name)))

    async def create_world(
        self,
        name: str,
        parameters: Mapping[str, object] | None = None,
        *,
        seed: int | None = None,
        population: Sequence[numpy.typing.ArrayLike] | None = None,
        speed: float | str | None = None,
    ) -> World:
        """Creates a world, which waits for its first `World.run`.

        Parameters
        ----------
        name
            1 to 64 letters, digits, "_" and "-", not yet in use.
        parameters
            Values by name; the others get their defaults. A mapping in place of a value is a schedule: {1: 0.2, 30: 0.05}
            sets each value at the first tick of its generation; before the first of them the default holds.
        seed
            0 to 2**64 - 1. Without it the server draws one.
        population
            Genes of the first generation: for each island an array of shape (population_size, 6), columns in the order of
            `evod.GENE_NAMES`. Without it they are drawn with the seed.
        speed
            As for `World.set_speed`. Without it real time, or the speed given to `local`.

        Raises
        ------
        Error
            Some values are not allowed: `violations` lists all of them, and nothing was created.

        Examples
        --------
        >>> import evod.aio
        >>> async with evod.aio.local() as lab:
        ...     world = await lab.create_world("small", {"population_size": 10}, seed=7)
        ...     info, population = await world.info(), await world.population()
        >>> info.seed, len(population)
        (7, 10)
        """
        plan = self._plans.create_world(name, parameters or {}, seed, population, speed)
        return World(self, await self._link.perform(plan))

    # ---- the server -----------------------------------------------------------------------------------------------

    async def registry(self) -> Registry:
        """Returns the description of every parameter."""
        return await self._link.perform(self._plans.registry())

    async def describe(self) -> c.Description:
        """Returns what the server supports: its messages, its parameters and its limits."""
        return (await self._request("describe")).description

    async def metrics(self) -> c.Metrics:
        """Returns the current metrics of the server."""
        return (await self._request("get_metrics")).metrics

    @opens_stream
    async def events(self) -> Events:
        """Subscribes to the events of all worlds, from now on."""
        subscription = await self._link.perform(self._plans.subscribe_events(None))
        return Events(self._link, plans.EventStream(self._link.core, subscription))

    async def shut_down(self) -> None:
        """Stops the server. It still answers what it has received, and writes all runs to disk."""
        await self._request("shut_down")


class LocalLab(Lab):
    """A Lab with a private server; made by `local`. Closing it stops the server."""

    def __init__(self, link: Link, server: local_server.Server, speed: float | str) -> None:
        super().__init__(link)
        self._server = server
        self._plans.speed_of_new_worlds = speed
        # Worlds and streams hold the link: once it is garbage collected no object can use the server any more.
        weakref.finalize(link, server.end)

    async def close(self) -> None:
        """Closes the connection and stops the server; waits up to 30 s until it has written its runs."""
        await super().close()
        await blocking_call(self._server.stop)

    @property
    def log(self) -> str:
        """The last 1,000 lines that the server has printed."""
        return "\n".join(self._server.lines)


class World(ParameterAttributes):
    """One experiment on a server; made by `Lab.world` and `Lab.create_world`."""

    def __init__(self, lab: Lab, name: str) -> None:
        self._lab, self._name = lab, name
        self._link, self._plans = lab._link, lab._plans

    @property
    def name(self) -> str:
        """The name of the world on its server."""
        return self._name

    @property
    def lab(self) -> Lab:
        """The connection that this world was made by."""
        return self._lab

    def __repr__(self) -> str:
        return f"<world {self.name} at {self._lab.address}>"

    async def _request(self, kind: str, /, **fields: Any) -> c.Response:
        return await self._link.perform(plans.request(kind, world=self.name, **fields))

    async def _command(self, kind: str, /, **fields: Any) -> world_pb2.WorldInfo:
        return await self._link.perform(plans.request_world(kind, world=self.name, **fields))

    # ---- parameters -----------------------------------------------------------------------------------------------

    async def get_parameters(self) -> Parameters:
        """Returns all parameters as they are now, with the revision, the schedule and the planned changes."""
        return await self._link.perform(self._plans.parameters(self.name))

    async def set(
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

        Parameters
        ----------
        values, **more
            Values by name. Values out of range are refused here, before anything is sent.
        dry_run
            Check the values and return what would hold, without changing anything.
        expected_revision
            The `Parameters.revision` that the change is based on. The server refuses it if another client has changed
            parameters since.
        at_generation
            Plan the change for the first tick of this generation. The plan is in `Parameters.change` of the result.
        at_tick
            Plan the change for the moment after this tick, counted from the beginning of the run.

        Returns
        -------
        Parameters
            All parameters after the change.

        Raises
        ------
        Error
            `violations` lists every value that is not allowed.
        """
        given = {**(values or {}), **more}
        plan = self._plans.set_parameters(self.name, given, dry_run, expected_revision, at_generation, at_tick)
        return await self._link.perform(plan)

    async def planned_changes(self) -> tuple[PlannedChange, ...]:
        """Returns the changes that wait for their generation or tick, in the order in which they were planned."""
        return (await self.get_parameters()).planned

    async def cancel(self, change: int | PlannedChange) -> PlannedChange:
        """Cancels a planned change, given as such or by its id.

        Raises
        ------
        Error
            The change was already made, dropped or cancelled.
        """
        return await self._link.perform(self._plans.cancel_change(self.name, change))

    # ---- running --------------------------------------------------------------------------------------------------

    @opens_stream
    async def run(self, generations: int | None = None) -> Run:
        """Runs the world, and returns its generations as they end.

        The world runs whether or not the result is iterated; `Run.wait` waits for the end.

        Parameters
        ----------
        generations
            How many more generations to run, from 1. Without it the world runs until it is paused.

        Examples
        --------
        >>> import evod.aio
        >>> async with evod.aio.local(seed=42) as lab:
        ...     world = await lab.world()
        ...     best = [g.best async for g in world.run(generations=3)]
        >>> len(best)
        3
        """
        return Run(self._link, await self._link.perform(self._plans.run(self.name, generations)))

    async def run_until_tick(self, tick: int) -> world_pb2.WorldInfo:
        """Starts the world; it pauses after this tick, counted from the beginning of the run. Returns at once: see `wait`."""
        return await self._command("run_until_tick", tick=tick)

    async def step(self, ticks: int = 1) -> world_pb2.WorldInfo:
        """Runs this many ticks and returns after the last.

        Examples
        --------
        >>> import evod.aio
        >>> async with evod.aio.local() as lab:
        ...     world = await lab.world()
        ...     info = await world.step(60)
        >>> info.tick
        60
        """
        return await self._link.perform(self._plans.step(self.name, ticks))

    async def wait(self) -> world_pb2.WorldInfo:
        """Waits until the world no longer runs, and returns its state."""
        return await self._link.perform(self._plans.wait(self.name))

    async def pause(self) -> world_pb2.WorldInfo:
        """Pauses the world; `resume` continues with the same goal."""
        return await self._command("pause")

    async def resume(self) -> world_pb2.WorldInfo:
        """Continues after `pause`, up to the goal of the last `run` or `run_until_tick`."""
        return await self._command("resume")

    async def set_speed(self, speed: float | str) -> world_pb2.WorldInfo:
        """Sets the speed: simulated seconds per second, 0.001 to 10,000, or "max" for as fast as the machine allows."""
        return await self._command("set_speed", speed=plans.speed_message(speed))

    async def reset(self, seed: int | None = None) -> world_pb2.WorldInfo:
        """Starts a new run at generation 1, with the same seed or another one; the world waits for `run`."""
        return await self._command("reset_world", seed=seed)

    async def release_lease(self) -> world_pb2.WorldInfo:
        """Ends the lease of `run_until_tick` or `step`, so that the world runs on its own again."""
        return await self._command("release_lease")

    async def renew_lease(self) -> None:
        """Renews the lease of `run_until_tick` or `step` for its full duration."""
        await self._request("renew_lease")

    async def fork(self, name: str, at_generation: int | None = None) -> World:
        """Creates a world that begins as this one was; this one is not changed.

        Parameters
        ----------
        name
            The name of the new world, which waits for `run`.
        at_generation
            Begin with the first tick of this generation. Without it, with the current state.
        """
        return World(self._lab, (await self._command("fork_world", name=name, at_generation=at_generation)).name)

    async def delete(self) -> None:
        """Deletes the world from the server."""
        await self._request("delete_world")

    # ---- observing ------------------------------------------------------------------------------------------------

    async def info(self) -> world_pb2.WorldInfo:
        """Returns the current tick, generation, run state, speed, seed and gene names."""
        return await self._link.perform(plans.world_info(self.name))

    async def snapshot(self, island: int = 0) -> Snapshot:
        """Returns the state of one island, by its index, as it is now."""
        return await self._link.perform(self._plans.snapshot(self.name, island))

    @opens_stream
    async def snapshots(
        self,
        rate_hz: float = 30.0,
        *,
        island: int | None = None,
        region: tuple[float, float, float, float] | None = None,
        detail: str | None = None,
        bytes_per_s_max: int | None = None,
    ) -> Snapshots:
        """Subscribes to snapshots. A slow reader receives fewer of them, never stale ones.

        With `region`, `detail` or `bytes_per_s_max` each snapshot consists of tiles: see `Snapshot.tiles`.

        Parameters
        ----------
        rate_hz
            The most snapshots of each island per second. The server may lower it: see `Snapshots.rate_hz`.
        island
            Only this island, by its index. Without it, all islands in turn.
        region
            Only the tiles that overlap this rectangle: (left, top, width, height) in px.
        detail
            The finest level of detail wanted: "full", "dots" or "density".
        bytes_per_s_max
            The most bytes per second to send; the server lowers the detail to stay below it.

        Examples
        --------
        >>> import evod.aio
        >>> async with evod.aio.local(seed=1) as lab:
        ...     world = await lab.world()
        ...     async with world.snapshots() as snapshots:
        ...         run = await world.run(generations=1)
        ...         async for snapshot in snapshots:
        ...             if snapshot.tick > 100:
        ...                 break
        >>> bool(snapshot.organisms.health.max() > 0)
        True
        """
        view = plans.view_message(region, detail, bytes_per_s_max)
        subscription = await self._link.perform(self._plans.subscribe_snapshots(self.name, island, rate_hz, view))
        return Snapshots(self._link, plans.SnapshotStream(self._link.core, subscription))

    @opens_stream
    async def events(self) -> Events:
        """Subscribes to the events of this world, from now on."""
        subscription = await self._link.perform(self._plans.subscribe_events(self.name))
        return Events(self._link, plans.EventStream(self._link.core, subscription))

    async def statistics(self) -> c.Statistics:
        """Returns the live statistics of each island, and those of the last generation that ended."""
        return (await self._request("get_statistics")).statistics

    async def history(
        self, first: int | None = None, last: int | None = None, *, island: int | None = None
    ) -> list[Generation]:
        """Returns the generations that have ended, as far back as the server keeps them.

        Parameters
        ----------
        first, last
            The range of generations, both included; from 1. Without them, all.
        island
            Only this island, by its index.
        """
        return await self._link.perform(plans.history(self.name, first, last, island))

    async def organism(self, organism: int, island: int = 0) -> world_pb2.OrganismInfo:
        """Returns the genes, position, health, parents and next choice of one organism, by its id.

        Raises
        ------
        Error
            NOT_FOUND: the current generation has no such organism.
        """
        return (await self._request("get_organism", island=island, organism=organism)).organism

    async def population(self, island: int = 0) -> Population:
        """Returns genes, parents and choices of all organisms of the current generation as arrays.

        Examples
        --------
        >>> import evod.aio
        >>> async with evod.aio.local(seed=1) as lab:
        ...     world = await lab.world()
        ...     population = await world.population()
        >>> population.genes.shape
        (50, 6)
        """
        return await self._link.perform(plans.population(self.name, island))

    async def breeding(
        self,
        island: int = 0,
        generation: int | None = None,
        *,
        first_contender: int = 0,
        first_pick: int = 0,
        first_descendant: int = 0,
    ) -> c.Breeding:
        """Returns how a generation was bred: its contenders, picks, pairs, crossover points and mutations.

        Parameters
        ----------
        island
            Index of the island.
        generation
            The generation of the parents. Without it, the last one that has bred.
        first_contender, first_pick, first_descendant
            Index of the first row of each list to return, for populations that do not fit into one answer.
        """
        response = await self._request(
            "get_breeding",
            island=island,
            generation=generation,
            first_contender=first_contender,
            first_pick=first_pick,
            first_descendant=first_descendant,
        )
        return response.breeding

    async def motion(self, island: int = 0) -> c.Motion:
        """Returns the energy, momentum and overlaps of the bodies on an island."""
        return (await self._request("get_motion", island=island)).motion

    @opens
    async def open_replay(self, generation: int | None = None, tick: int | None = None) -> Replay:
        """Opens a replay of this world's stored run; the server must keep its runs.

        Parameters
        ----------
        generation, tick
            Where the replay begins: a generation, a tick of that generation, or without a generation a tick of the run.
            Without both, the beginning of the run.
        """
        at = plans.moment_message("open_replay.at.", generation, tick) if (generation, tick) != (None, None) else None
        return Replay(self._lab, (await self._command("open_replay", at=at)).name)

    async def export(
        self,
        table: str,
        format: str = "csv",
        *,
        generation: int | None = None,
        of: tuple[int, int, int] | None = None,
    ) -> str:
        """Returns a table of the world's run file as text.

        Parameters
        ----------
        table
            "generations", "organisms", "lineage", "population" or "events".
        format
            "csv" or "jsonl".
        generation
            For "population": which generation. Without it, the last one that has begun.
        of
            For "lineage": only the ancestors of one organism, given as (generation, island, id).
        """
        return await self._link.perform(plans.export(self.name, table, format, generation, of))

    async def table(self, table: str, *, generation: int | None = None, of: tuple[int, int, int] | None = None) -> Any:
        """Returns the table of `export` as a pandas DataFrame."""
        return tables.read_csv(await self.export(table, generation=generation, of=of))

    # ---- plots ----------------------------------------------------------------------------------------------------

    async def plot(self, island: int = 0, ax: Any = None) -> Any:
        """Plots an island as it is now with matplotlib.

        Parameters
        ----------
        island
            Index of the island.
        ax
            The axes to draw into. Without them, new ones.

        Returns
        -------
        matplotlib.axes.Axes

        Examples
        --------
        >>> import evod.aio
        >>> async with evod.aio.local(seed=1) as lab:
        ...     world = await lab.world()
        ...     axes = await world.plot()
        >>> axes.get_title()
        'default, generation 1, 50 alive, 0 s'
        """
        return plotting.plot_island(await self.snapshot(island), ax)

    async def plot_fitness(self, ax: Any = None) -> Any:
        """Plots the fitness of the generations that have ended; returns the axes."""
        history, info = await self.history(), await self.info()
        return plotting.plot_fitness(plotting.statistics_columns(history, info.gene_names), ax)

    async def plot_genes(self, ax: Any = None) -> Any:
        """Plots mean and spread of each gene in the generations that have ended; returns the axes."""
        history, info = await self.history(), await self.info()
        return plotting.plot_genes(plotting.statistics_columns(history, info.gene_names), info.gene_names, ax)

    async def plot_selection(self, gene: str, ax: Any = None) -> Any:
        """Plots what moved the mean of a gene in each generation: selection, transmission, migration, and their sum."""
        history, info = await self.history(), await self.info()
        return plotting.plot_selection(plotting.statistics_columns(history, info.gene_names), info.gene_names, gene, ax)

    async def animate(self, count: int = 100, rate_hz: float = 20.0, island: int = 0) -> Any:
        """Records snapshots of an island and returns a matplotlib animation of them, which notebooks play.

        Parameters
        ----------
        count
            The number of snapshots; recording ends sooner if the world does not run.
        rate_hz
            Snapshots per second, of the recording and of the animation.
        island
            Index of the island.
        """
        recorded: list[Snapshot] = []
        async with self.snapshots(rate_hz, island=island) as snapshots:
            async for snapshot in snapshots:
                recorded.append(snapshot)
                if len(recorded) >= count or snapshot.state != world_pb2.RUN_STATE_RUNNING:
                    break
        return plotting.animate(recorded, 1000 / rate_hz)


class Replay(World, _Closing):
    """A world that shows the stored run of another; made by `World.open_replay`. It ends with close() or the connection."""

    async def seek(self, generation: int | None = None, tick: int | None = None) -> world_pb2.WorldInfo:
        """Moves to a generation, a tick of that generation, or a tick of the run; without both to the last stored moment."""
        return await self._command("seek", to=plans.moment_message("seek.to.", generation, tick))

    async def close(self) -> None:
        """Removes the replay from the server."""
        await self._link.perform(plans.close_replay(self.name))


class _Stream(_Closing):
    def __init__(self, link: Link, stream: Any) -> None:
        self._link, self._stream = link, stream

    async def close(self) -> None:
        """Ends the subscription; the server sends no more of it."""
        await self._link.apply(self._stream.close)


class Run(_Stream):
    """The generations of a run as they end. Each is returned once, including those that end while reconnecting.

    Made by `World.run`; iterate it. Closing it does not stop the world.
    """

    _stream: plans.GenerationStream

    @property
    def info(self) -> world_pb2.WorldInfo:
        """The state of the world when the run began."""
        return self._stream.info

    def __aiter__(self) -> Run:
        return self

    async def __anext__(self) -> Generation:
        generation = await self._link.perform(self._stream.next())
        if generation is None:
            raise StopAsyncIteration
        return generation

    async def wait(self) -> Generation | None:
        """Waits for the end of the run; returns the last generation, or None if all were already taken."""
        last = None
        async for last in self:
            pass
        return last


class Snapshots(_Stream):
    """A subscription to snapshots; made by `World.snapshots`; iterate it.

    Taking a snapshot acknowledges the one before it, which lets the server send another.
    """

    _stream: plans.SnapshotStream

    def __aiter__(self) -> Snapshots:
        return self

    async def __anext__(self) -> Snapshot:
        return await self._link.perform(self._stream.next())

    @property
    def rate_hz(self) -> float:
        """The most snapshots per second and island that the server sends: the requested rate, or its limit."""
        return self._stream.rate_hz

    async def set_view(
        self,
        region: tuple[float, float, float, float] | None = None,
        detail: str | None = None,
        bytes_per_s_max: int | None = None,
    ) -> None:
        """Changes the view of a subscription that has one; the arguments are those of `World.snapshots`."""
        view = plans.view_message(region, detail, bytes_per_s_max) or c.View()
        await self._link.perform(self._stream.set_view(view))

    async def request_keyframe(self) -> None:
        """Requests snapshots encoded without reference to earlier ones. They come at once, even if the world is paused."""
        await self._link.perform(self._stream.request_keyframe())


class Events(_Stream):
    """A subscription to events; made by `World.events` and `Lab.events`; iterate it.

    After a reconnect an `events_dropped` with a count of 0 comes first: the number of events missed is not known.
    """

    _stream: plans.EventStream

    def __aiter__(self) -> Events:
        return self

    async def __anext__(self) -> stream_pb2.Event:
        return await self._link.perform(self._stream.next())
