"""Labs, worlds, and what comes of them, as evod.lab has them; what they answer is awaited."""
from __future__ import annotations

import asyncio
import inspect
import os
from typing import Any, Mapping, Sequence, TypeVar

import numpy.typing

from evod import lab as plain
from evod import local_server, plans
from evod.aio.link import Link
from evod.aio.opening import Opening, OpeningStream
from evod.core import Core
from evod.endpoint import Endpoint, tls_context, token_of
from evod.generations import Generation, Population
from evod.parameters import Parameters, PlannedChange, Registry
from evod.snapshots import Snapshot
from evod.plans import Plan
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
) -> Opening[Lab]:
    """As evod.connect()."""

    async def open_lab() -> Lab:
        where = Endpoint.parse(server)
        core = Core(token=token_of(token, token_file), client_name=client_name, server=where)
        link = Link(where, core, tls_context(tls, ca, cert, key), timeout_s=timeout_s, reconnect=reconnect)
        await link.open()
        return Lab(link)

    return Opening(open_lab())


def local(
    *,
    seed: int | None = None,
    experiment: str | os.PathLike[str] | Mapping[str, object] | None = None,
    data: str | os.PathLike[str] | None = None,
    speed: float | str = "max",
    threads: int | None = None,
    program: str | os.PathLike[str] | None = None,
    timeout_s: float = 30.0,
) -> Opening[LocalLab]:
    """As evod.local().

    >>> import asyncio, evod.aio
    >>> async def main():
    ...     async with evod.aio.local(seed=42) as lab:
    ...         world = await lab.world()
    ...         async for g in world.run(generations=2):
    ...             print(g)
    >>> asyncio.run(main())
    generation 1: best 337.6, mean 71.1, 25 of 50 alive
    generation 2: best 294.4, mean 84.7, 27 of 50 alive
    """

    async def open_lab() -> LocalLab:
        server = await asyncio.to_thread(local_server.start, seed, experiment, data, speed, threads, program)
        try:
            lab = await connect(server.address, token="", ca="", timeout_s=timeout_s, client_name="evod.aio.local")
        except BaseException:
            server.stop()
            raise
        return LocalLab(lab._link, server, speed)

    return Opening(open_lab())


class _Closing:
    async def close(self) -> None:
        raise NotImplementedError

    async def __aenter__(self: T) -> T:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()


class Lab(_Closing):
    """As evod.Lab, and what it answers is awaited."""

    def __init__(self, link: Link) -> None:
        self._link = link
        self._desk = plans.Desk(link.core)

    def __repr__(self) -> str:
        return f"<evod at {self.address}>"

    async def close(self) -> None:
        await self._link.close()

    @property
    def address(self) -> str:
        return str(self._link.server)

    @property
    def welcome(self) -> session_pb2.Welcome:
        return self._link.core.welcome or session_pb2.Welcome()

    @property
    def client_key(self) -> str:
        return self._link.core.client_key

    @property
    def damaged_snapshot_count(self) -> int:
        return self._link.core.damaged_snapshot_count

    @property
    def role(self) -> str:
        return str(session_pb2.Role.Name(self.welcome.role)).removeprefix("ROLE_").lower()

    async def request(self, **request: Any) -> c.Response:
        return await self._link.perform(plans.answer_to(c.Request(**request)))

    async def worlds(self) -> Sequence[world_pb2.WorldInfo]:
        return await self._link.perform(plans.worlds())

    async def world(self, name: str | None = None) -> World:
        return World(self, await self._link.perform(self._desk.name_of(name)))

    async def create_world(
        self,
        name: str,
        parameters: Mapping[str, object] | None = None,
        *,
        seed: int | None = None,
        population: Sequence[numpy.typing.ArrayLike] | None = None,
        speed: float | str | None = None,
    ) -> World:
        plan = self._desk.create_world(name, parameters or {}, seed, population, speed)
        return World(self, await self._link.perform(plan))

    async def registry(self) -> Registry:
        return await self._link.perform(self._desk.registry())

    async def describe(self) -> c.Description:
        return (await self._link.perform(plans.ask("describe"))).description

    async def metrics(self) -> c.Metrics:
        return (await self._link.perform(plans.ask("get_metrics"))).metrics

    def events(self) -> OpeningStream[Events, stream_pb2.Event]:
        return _events(self._link, self._desk.subscribe_events(None))

    async def shut_down(self) -> None:
        await self._link.perform(plans.ask("shut_down"))


class LocalLab(Lab):
    """As evod.LocalLab, and what it answers is awaited."""

    def __init__(self, link: Link, server: local_server.Server, speed: float | str) -> None:
        super().__init__(link)
        self._server = server
        self._desk.speed_of_new_worlds = speed

    async def close(self) -> None:
        await super().close()
        await asyncio.to_thread(self._server.stop)

    @property
    def log(self) -> str:
        return "\n".join(self._server.lines)


class World:
    """As evod.World, and what it answers is awaited."""

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

    async def _command(self, kind: str, /, **fields: Any) -> world_pb2.WorldInfo:
        return await self._link.perform(plans.ask_for_world(kind, world=self.name, **fields))

    async def get_parameters(self) -> Parameters:
        return await self._link.perform(self._desk.parameters(self.name))

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
        given = {**(values or {}), **more}
        plan = self._desk.set_parameters(self.name, given, dry_run, expected_revision, at_generation, at_tick)
        return await self._link.perform(plan)

    async def planned_changes(self) -> tuple[PlannedChange, ...]:
        return (await self.get_parameters()).planned

    async def cancel(self, change: int | PlannedChange) -> PlannedChange:
        return await self._link.perform(self._desk.cancel_change(self.name, change))

    def run(self, generations: int | None = None) -> OpeningStream[Run, Generation]:
        async def open_run() -> Run:
            return Run(self._link, await self._link.perform(self._desk.run(self.name, generations)))

        return OpeningStream(open_run())

    async def run_until_tick(self, tick: int) -> world_pb2.WorldInfo:
        return await self._command("run_until_tick", tick=tick)

    async def step(self, ticks: int = 1) -> world_pb2.WorldInfo:
        return await self._link.perform(self._desk.step(self.name, ticks))

    async def wait(self) -> world_pb2.WorldInfo:
        return await self._link.perform(self._desk.wait(self.name))

    async def pause(self) -> world_pb2.WorldInfo:
        return await self._command("pause")

    async def resume(self) -> world_pb2.WorldInfo:
        return await self._command("resume")

    async def set_speed(self, speed: float | str) -> world_pb2.WorldInfo:
        return await self._command("set_speed", speed=plans.speed_of(speed))

    async def reset(self, seed: int | None = None) -> world_pb2.WorldInfo:
        return await self._command("reset_world", seed=seed)

    async def release_lease(self) -> world_pb2.WorldInfo:
        return await self._command("release_lease")

    async def renew_lease(self) -> None:
        await self._link.perform(plans.ask("renew_lease", world=self.name))

    async def fork(self, name: str, at_generation: int | None = None) -> World:
        return World(self._lab, (await self._command("fork_world", name=name, at_generation=at_generation)).name)

    async def delete(self) -> None:
        await self._link.perform(plans.ask("delete_world", world=self.name))

    async def info(self) -> world_pb2.WorldInfo:
        return await self._link.perform(plans.info_of(self.name))

    async def snapshot(self, island: int = 0) -> Snapshot:
        return await self._link.perform(self._desk.snapshot(self.name, island))

    def snapshots(
        self,
        rate_hz: float = 30.0,
        *,
        island: int | None = None,
        region: tuple[float, float, float, float] | None = None,
        detail: str | None = None,
        bytes_per_s_max: int | None = None,
    ) -> OpeningStream[Snapshots, Snapshot]:
        async def open_snapshots() -> Snapshots:
            view = plans.view_of(region, detail, bytes_per_s_max)
            plan = self._desk.subscribe_snapshots(self.name, island, rate_hz, view)
            return Snapshots(self._link, plans.SnapshotStream(self._link.core, await self._link.perform(plan)))

        return OpeningStream(open_snapshots())

    def events(self) -> OpeningStream[Events, stream_pb2.Event]:
        return _events(self._link, self._desk.subscribe_events(self.name))

    async def statistics(self) -> c.Statistics:
        return (await self._link.perform(plans.ask("get_statistics", world=self.name))).statistics

    async def history(
        self, first: int | None = None, last: int | None = None, *, island: int | None = None
    ) -> list[Generation]:
        return await self._link.perform(plans.history(self.name, first, last, island))

    async def organism(self, organism: int, island: int = 0) -> world_pb2.OrganismInfo:
        return (await self._link.perform(plans.ask("get_organism", world=self.name, island=island, organism=organism))).organism

    async def population(self, island: int = 0) -> Population:
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
        plan = plans.ask(
            "get_breeding",
            world=self.name,
            island=island,
            generation=generation,
            first_contender=first_contender,
            first_pick=first_pick,
            first_descendant=first_descendant,
        )
        return (await self._link.perform(plan)).breeding

    async def motion(self, island: int = 0) -> c.Motion:
        return (await self._link.perform(plans.ask("get_motion", world=self.name, island=island))).motion

    def open_replay(self, generation: int | None = None, tick: int | None = None) -> Opening[Replay]:
        async def open_it() -> Replay:
            at = plans.moment_of("open_replay.at.", generation, tick) if (generation, tick) != (None, None) else None
            return Replay(self._lab, (await self._command("open_replay", at=at)).name)

        return Opening(open_it())

    async def export(
        self,
        table: str,
        format: str = "csv",
        *,
        generation: int | None = None,
        of: tuple[int, int, int] | None = None,
    ) -> str:
        return await self._link.perform(plans.export(self.name, table, format, generation, of))

    async def table(self, table: str, *, generation: int | None = None, of: tuple[int, int, int] | None = None) -> Any:
        from evod.tables import frame_of

        return frame_of(await self.export(table, generation=generation, of=of))


    async def plot(self, island: int = 0, ax: Any = None) -> Any:
        return (await self.snapshot(island)).plot(ax)

    async def plot_fitness(self, ax: Any = None) -> Any:
        from evod import plotting

        columns = plotting.columns_of(await self.history(), (await self.info()).gene_names)
        return plotting.plot_fitness(columns, ax)

    async def plot_genes(self, ax: Any = None) -> Any:
        from evod import plotting

        names = (await self.info()).gene_names
        return plotting.plot_genes(plotting.columns_of(await self.history(), names), names, ax)

    async def plot_selection(self, gene: str, ax: Any = None) -> Any:
        from evod import plotting

        names = (await self.info()).gene_names
        return plotting.plot_selection(plotting.columns_of(await self.history(), names), names, gene, ax)

    async def animate(self, count: int = 100, rate_hz: float = 20.0, island: int = 0) -> Any:
        from evod import plotting

        seen: list[Snapshot] = []
        async with self.snapshots(rate_hz, island=island) as snapshots:
            async for snapshot in snapshots:
                seen.append(snapshot)
                if len(seen) >= count or snapshot.state != world_pb2.RUN_STATE_RUNNING:
                    break
        return plotting.animation_of(seen, 1000 / rate_hz)


class Replay(World, _Closing):
    """As evod.Replay, and what it answers is awaited."""

    async def seek(self, generation: int | None = None, tick: int | None = None) -> world_pb2.WorldInfo:
        return await self._command("seek", to=plans.moment_of("seek.to.", generation, tick))

    async def close(self) -> None:
        await self._link.perform(plans.close_replay(self.name))


class _Stream(_Closing):
    def __init__(self, link: Link, stream: Any) -> None:
        self._link, self._stream = link, stream

    async def close(self) -> None:
        await self._link.tell(self._stream.close)


class Run(_Stream):
    """As evod.Run, for `async for`."""

    _stream: plans.GenerationStream

    @property
    def info(self) -> world_pb2.WorldInfo:
        return self._stream.info

    def __aiter__(self) -> Run:
        return self

    async def __anext__(self) -> Generation:
        generation = await self._link.perform(self._stream.next())
        if generation is None:
            raise StopAsyncIteration
        return generation

    async def wait(self) -> Generation | None:
        last = None
        async for last in self:
            pass
        return last


class Snapshots(_Stream):
    """As evod.Snapshots, for `async for`."""

    _stream: plans.SnapshotStream

    def __aiter__(self) -> Snapshots:
        return self

    async def __anext__(self) -> Snapshot:
        return await self._link.perform(self._stream.next())

    @property
    def rate_hz(self) -> float:
        return self._stream.rate_hz

    async def set_view(
        self,
        region: tuple[float, float, float, float] | None = None,
        detail: str | None = None,
        bytes_per_s_max: int | None = None,
    ) -> None:
        view = plans.view_of(region, detail, bytes_per_s_max) or c.View()
        await self._link.perform(self._stream.set_view(view))

    async def request_keyframe(self) -> None:
        await self._link.perform(self._stream.request_keyframe())


class Events(_Stream):
    """As evod.Events, for `async for`."""

    _stream: plans.EventStream

    def __aiter__(self) -> Events:
        return self

    async def __anext__(self) -> stream_pb2.Event:
        return await self._link.perform(self._stream.next())


def _events(link: Link, plan: Plan[Any]) -> OpeningStream[Events, stream_pb2.Event]:
    async def open_events() -> Events:
        return Events(link, plans.EventStream(link.core, await link.perform(plan)))

    return OpeningStream(open_events())


def _say_what_the_plain_face_says() -> None:
    """Without its examples, which do not await anything."""
    for ours, theirs in ((Lab, plain.Lab), (LocalLab, local_server.LocalLab), (World, plain.World),
                        (Replay, plain.Replay), (Run, plain.Run), (Snapshots, plain.Snapshots), (Events, plain.Events),
                        (_Stream, plain._Stream)):  # fmt: skip
        for name, member in vars(ours).items():
            if not name.startswith("_") and inspect.isfunction(member):
                member.__doc__ = (getattr(theirs, name).__doc__ or "").partition(">>>")[0].rstrip()


_say_what_the_plain_face_says()
