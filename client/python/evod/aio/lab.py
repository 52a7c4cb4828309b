"""Labs and worlds for asyncio. evod.lab, the synchronous module, is generated from this file.

Threads      call everything on the event loop on which connect() or local() ran.
"""
from __future__ import annotations

from typing import Any, Callable, Iterable, Mapping, Sequence

import numpy.typing

from evod import page_link, plans
from evod.aio.attributes import ParameterAttributes
from evod.aio.awaitable import opens, opens_stream
from evod.aio.classrooms import Classrooms
from evod.aio.evaluation import Evaluation
from evod.aio.link import Link
from evod.aio.streams import Closing, Events, Run
from evod.aio.world_queries import WorldQueries
from evod.conversion import result
from evod.experiment import Experiment, world_values
from evod.genes import Genes
from evod.generations import Generation, Life, Population
from evod.lab_plans import LabPlans
from evod.notebook import PageFrame, in_notebook
from evod.parameters import Parameters, PlannedChange, Registry
from evod.progress import ProgressLine
from evod.rating import EndRules, Rater, refuse_unknown, Repaired
from evod.results import DamagedWorld, EntityIds, Membership, WorldInfo
from evod.tables import html_table
from evod.v1 import commands_pb2 as c, session_pb2


class Lab(Classrooms, Closing):
    """A connection to a server and its worlds, returned by `connect`."""

    def __init__(self, link: Link) -> None:
        self._link = link
        self._plans = LabPlans(link.core)

    def __repr__(self) -> str:
        return f"<evod at {self.address}>"

    def _repr_html_(self) -> str:
        welcome = self.welcome
        fields = (("address", self.address), ("version", welcome.server_version), ("role", self.role))
        return html_table((), fields, "lab of evod")

    async def close(self) -> None:
        """Closes the connection. Calls that wait for an answer raise NoConnection."""
        await self._link.close()

    @property
    def address(self) -> str:
        """The address of the server, as HOST:PORT."""
        return str(self._link.server)

    @property
    def welcome(self) -> session_pb2.Welcome:
        """The server's description of itself, received at the last connect: version, limits, durability, features."""
        return self._link.core.welcome or session_pb2.Welcome()

    @property
    def client_key(self) -> str:
        """The random key that identifies this client's commands to the server and in its journals."""
        return self._link.core.client_key

    @property
    def damaged_snapshot_count(self) -> int:
        """The number of snapshots that were dropped because they could not be decoded."""
        return self._link.core.damaged_snapshot_count

    @property
    def role(self) -> str:
        """The role of this client: "viewer", "teacher", "controller" or "admin"."""
        return str(c.Role.Name(self.welcome.role)).removeprefix("ROLE_").lower()

    @property
    def membership(self) -> Membership | None:
        """The class, the name and the world of a member: see `evod.join`. None if this client is none."""
        membership: Membership | None = result(self.welcome.membership) if self.welcome.HasField("membership") else None
        return membership

    async def request(self, **request: Any) -> c.Response:
        """Sends any request of the protocol and returns the response.

        Parameters
        ----------
        **request
            Exactly one field of evod.v1.Request, with its value.

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

    async def worlds(self) -> tuple[World, ...]:
        """Returns every world, in the order in which the worlds were created."""
        return tuple(World(self, info.name) for info in await self._link.perform(plans.worlds()))

    async def world_infos(self) -> tuple[WorldInfo, ...]:
        """Returns the state of every world at the same moment, with one request, in the order of `worlds`."""
        return tuple(result(info) for info in await self._link.perform(plans.worlds()))

    async def damaged_worlds(self) -> tuple[DamagedWorld, ...]:
        """Returns the worlds that do not run, because the server cannot restore them from their run files. Every method
        of such a world raises `FailedPrecondition` with the reason, except `World.export` and `World.delete`."""
        return tuple(result(world) for world in await self._link.perform(plans.damaged_worlds()))

    async def world(self, name: str | None = None) -> World:
        """Returns the world with this name. Without a name, returns the only world, or "default" if there are several.

        Raises
        ------
        NotFound
            The server has no such world.
        """
        return World(self, await self._link.perform(self._plans.world_name(name)))

    async def create_world(
        self,
        name: str,
        parameters: Experiment = None,
        *,
        seed: int | None = None,
        population: Sequence[numpy.typing.ArrayLike] | None = None,
        speed: float | str | None = None,
    ) -> World:
        """Creates a world, which waits for its first `World.run`.

        Parameters
        ----------
        name
            The name of the new world: 1 to 64 letters, digits, "_" and "-". No other world may have this name.
        parameters
            An experiment file, or a mapping of parameter names to values. Parameters that are not given have their
            default values. A mapping in place of a value is a schedule: {1: 0.2, 30: 0.05} sets each value at the first
            tick of its generation. Before the first generation in the schedule the parameter has its default value.
        seed
            The seed of the run, 0 to 2**64 - 1. By default the seed in the experiment file, or else the server draws a
            random seed.
        population
            The genes of the first generation: one array for each island, with shape (population_size, genes) and
            columns in the order of `WorldInfo.gene_names`. An array may have fewer rows: the server draws the other
            organisms with the seed, as it draws all of them by default.
        speed
            The speed, as for `World.set_speed`. By default real time, or the speed given to `local`.

        Raises
        ------
        InvalidArgument
            Some values are not allowed. `violations` lists all of them. No world was created.
        AlreadyExists
            The server has a world with this name.

        Examples
        --------
        >>> import evod.aio
        >>> async with evod.aio.local() as lab:
        ...     world = await lab.create_world("small", {"population_size": 10}, seed=7)
        ...     info, population = await world.info(), await world.population()
        >>> info.seed, len(population)
        (7, 10)
        """
        values, file_seed = world_values(parameters)
        plan = self._plans.create_world(name, values, file_seed if seed is None else seed, population, speed)
        return World(self, await self._link.perform(plan))

    # ---- the server -----------------------------------------------------------------------------------------------

    async def registry(self) -> Registry:
        """Returns the description of every parameter."""
        return await self._link.perform(self._plans.registry())

    async def describe(self) -> c.Description:
        """Returns the messages, parameters and limits of the server."""
        return (await self._request("describe")).description

    async def metrics(self) -> c.Metrics:
        """Returns the current metrics of the server."""
        return (await self._request("get_metrics")).metrics

    @opens_stream
    async def events(self) -> Events:
        """Subscribes to the events of all worlds that happen from now on."""
        subscription = await self._link.perform(self._plans.subscribe_events(None))
        return Events(self._link, plans.EventStream(self._link.core, subscription))

    async def shut_down(self) -> None:
        """Stops the server. Before it stops, it answers all requests that it has received, and writes all runs to
        disk."""
        await self._request("shut_down")


class World(ParameterAttributes, WorldQueries):
    """A world on a server, returned by `Lab.world` and `Lab.create_world`."""

    def __init__(self, lab: Lab, name: str) -> None:
        super().__init__(lab._link, lab._plans, name)
        self._lab = lab

    @property
    def lab(self) -> Lab:
        """The Lab that returned this world."""
        return self._lab

    def __repr__(self) -> str:
        return f"<world {self.name} at {self._lab.address}>"

    async def _command(self, kind: str, /, **fields: Any) -> WorldInfo:
        info: WorldInfo = result(await self._link.perform(plans.request_world(kind, world=self.name, **fields)))
        return info

    # ---- parameters -----------------------------------------------------------------------------------------------

    async def get_parameters(self) -> Parameters:
        """Returns the current values of all parameters, with the revision, the schedule and the planned changes."""
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
        """Sets parameters: ``world.set(mutation_chance=0.1, selection="tournament")``. If one value is refused, sets
        none. Warns about settings with which nothing can evolve (UserWarning), as `reset` and `Lab.create_world` do.

        Parameters
        ----------
        values, **more
            The new values by parameter name, as a mapping or as keyword arguments. Values out of range are refused
            before a request is sent.
        dry_run
            Check the values and return the parameters as they would be after the change. Do not change anything.
        expected_revision
            The `Parameters.revision` on which the change is based. The server refuses the change if another client has
            changed parameters since that revision.
        at_generation
            Plan the change for the first tick of this generation. `Parameters.change` of the result is the planned
            change.
        at_tick
            Plan the change for the moment after this tick, counted from the beginning of the run.

        Returns
        -------
        Parameters
            All parameters after the change.

        Raises
        ------
        InvalidArgument
            `violations` lists every value that is not allowed.
        Aborted
            Another client has changed parameters since `expected_revision`.
        """
        given = {**(values or {}), **more}
        plan = self._plans.set_parameters(self.name, given, dry_run, expected_revision, at_generation, at_tick)
        return await self._link.perform(plan)

    async def planned_changes(self) -> tuple[PlannedChange, ...]:
        """Returns the planned changes that are not due yet, in the order in which they were planned."""
        return (await self.get_parameters()).planned

    async def cancel(self, change: int | PlannedChange) -> PlannedChange:
        """Cancels a planned change. `change` is the change or its id.

        Raises
        ------
        NotFound
            The server has already applied, dropped or cancelled the change.
        """
        return await self._link.perform(self._plans.cancel_change(self.name, change))

    # ---- items and organisms --------------------------------------------------------------------------------------

    async def place(
        self,
        *,
        food: numpy.typing.ArrayLike = (),
        poison: numpy.typing.ArrayLike = (),
        organisms: Iterable[tuple[float, float, object]] = (),
        island: int = 0,
    ) -> EntityIds:
        """Places food, poison and organisms in the current generation. If one of them is refused, places nothing.

        Placed items exist until they are eaten or removed, or until the generation ends; they do not reappear. Placed
        organisms breed like the others. The next generation has ``population_size`` organisms again.

        Parameters
        ----------
        food, poison
            The positions as pairs (x, y) in px: a list of pairs, or an array of shape (count, 2). They must be inside
            the walls and clear of crates and obstacles.
        organisms
            Triples (x, y, genes). `genes` are numbers in the order of `WorldInfo.gene_names`, or numbers by gene name.
            The place must also be clear of other organisms.
        island
            The index of the island.

        Returns
        -------
        EntityIds
            The ids of the placed items and organisms.

        Raises
        ------
        InvalidArgument
            `violations` lists every position and gene that is not allowed: ``food[2]``, ``organisms[0].body_size``.
        FailedPrecondition
            The generation is over, the world is a replay, or its fitness depends only on the chromosome.

        Examples
        --------
        >>> import evod.aio
        >>> async with evod.aio.local(seed=1) as lab:
        ...     world = await lab.world()
        ...     placed = await world.place(food=[(30, 40), (50.5, 40)])
        ...     removed = await world.remove(food=placed.food, generation=placed.generation)
        >>> removed.food == placed.food
        True
        """
        return await self._link.perform(self._plans.place(self.name, island, food, poison, organisms))

    async def remove(
        self,
        *,
        food: Iterable[int] = (),
        poison: Iterable[int] = (),
        organisms: Iterable[int] = (),
        island: int = 0,
        generation: int | None = None,
    ) -> EntityIds:
        """Removes items and organisms from the current generation. If one id is refused, removes nothing.

        A removed item does not reappear in this generation. A removed organism is dead; its fitness is the time that it
        lived.

        Parameters
        ----------
        food, poison, organisms
            Ids of present items and of living organisms, as in `Snapshot` and `EntityIds`.
        island
            The index of the island.
        generation
            The generation to which the ids belong. By default the current generation.

        Raises
        ------
        InvalidArgument
            `violations` lists every id that is not present.
        Aborted
            `generation` is not the current generation.
        FailedPrecondition
            As for `place`.
        """
        plan = self._plans.remove(self.name, island, generation, food, poison, organisms)
        return await self._link.perform(plan)

    # ---- running --------------------------------------------------------------------------------------------------

    @opens_stream
    async def run(self, generations: int | None = None, *, progress: bool = False) -> Run:
        """Starts the world and returns a `Run`, which yields each generation when it ends.

        The world runs even if the result is not iterated. `Run.wait` waits for the end of the run, or for a pause.

        Parameters
        ----------
        generations
            The number of further generations to run, at least 1. By default the world runs until it is paused.
        progress
            Show the last generation in one line on the terminal or in the notebook, while the result is iterated or
            waited for.

        Examples
        --------
        >>> import evod.aio
        >>> async with evod.aio.local(seed=42) as lab:
        ...     world = await lab.world()
        ...     best = [g.best async for g in world.run(generations=3)]
        >>> len(best)
        3
        """
        return Run(self._link, await self._link.perform(self._plans.run(self.name, generations)), progress)

    @opens_stream
    async def evaluate(
        self,
        function: Callable[[Genes, Life], numpy.typing.ArrayLike | Repaired],
        generations: int | None = None,
        *,
        minimize: bool = False,
        only_new: bool = False,
        target: float | None = None,
        stagnation: int | None = None,
        seconds: float | None = None,
        until: Callable[[Generation], object] | None = None,
        on_generation: Callable[[Generation], object] | None = None,
        progress: bool = False,
        live: bool = False,
        **unknown: object,
    ) -> Evaluation:
        """Runs the world with any fitness function, and returns the ended generations.

        The world must have the parameter ``fitness`` external. It then waits at the end of each generation for the
        fitness of its organisms, for each island. With ``external_bodies`` off, organisms do not live on the islands,
        and evod is a genetic algorithm. The run file contains all numbers, so the run can be repeated and verified
        without the function.

        The call ends with the last generation. With ``live=True`` it returns at once, and a `for` statement over the
        result rates organisms and yields each generation when it has ended. ``with world.evaluate(…, live=True) as
        evaluation:`` keeps the result at hand.

        Parameters
        ----------
        function
            It is called with the genes, of shape (count, genes), and the `Life` of the organisms of one island, and
            returns one number for each organism, -1e100 to 1e100. Larger is better. The arrays are read-only. A
            function that repairs chromosomes returns an `evod.Repaired`. If the world's parameter ``objectives`` is
            above 1, the function returns so many numbers for each organism: an array of shape (count, objectives).
            `Generation.front` contains the best organisms then, and the first objective is the fitness in all other
            results and in the criteria below.
        generations
            The number of further generations, at least 1. By default until the world is paused, or until another
            criterion.
        minimize
            Less is better. All numbers of the result and of the arguments below are in the sign of the function; the
            server stores the negative numbers.
        only_new
            Call the function only with organisms whose genes it has not rated in the generation before: `Life.is_new`.
            For functions that depend on the genes only, in worlds without bodies.
        target
            End with a generation whose best fitness is at least as good.
        stagnation
            End after this number of generations without a better best fitness.
        seconds
            End with the first generation that ends after this time.
        until
            A function of a `Generation`: end when it returns True.
        on_generation
            A function that is called with each `Generation` when it has ended.
        progress
            Show the last generation in one line on the terminal or in the notebook.
        live
            Return before the first generation. Organisms are rated while the result is iterated; leaving the loop ends
            the call. By default the call waits for the end, and the result yields the generations afterwards.

        Returns
        -------
        Evaluation
            The generations of this call, with the reason of its end. A criterion above pauses the world.

        Raises
        ------
        FailedPrecondition
            The world computes its fitness itself.
        InvalidArgument
            The function has returned an array of a wrong shape, or a number that is not allowed, or has written into
            its arrays. The world waits for fitness as before. It does so too if the function raises an exception, or if
            this program ends: any client can go on.

        Examples
        --------
        >>> import evod.aio
        >>> setting = {"fitness": "external", "external_bodies": False, "free_genes": 3}
        >>> async with evod.aio.local() as lab:
        ...     world = await lab.create_world("peak", setting, seed=3)
        ...     result = await world.evaluate(lambda genes, life: ((genes - 0.25) ** 2).sum(axis=1), 200,
        ...                                   minimize=True, target=0.01)
        >>> result.reason, result.best().fitness <= 0.01
        ('target', True)
        """
        refuse_unknown(unknown)
        rules = EndRules(target=target, stagnation=stagnation, seconds=seconds, until=until)
        has_bodies, objectives = await self._link.perform(self._plans.rated_world(self.name))
        rater = Rater(function, has_bodies, minimize=minimize, only_new=only_new, objectives=objectives)
        stream = await self._link.perform(self._plans.run(self.name, generations))
        evaluation = Evaluation(self._link, stream, self, rater, rules, on_generation, progress)
        return evaluation if live else await evaluation.wait()

    def _fitness_plan(self, population: Population, fitness: numpy.typing.NDArray[Any],
                      genes: numpy.typing.NDArray[Any] | None) -> plans.Plan[bool]:
        life = population.life
        return self._plans.set_fitness(self.name, life.generation, life.island, fitness, genes)

    async def run_until_tick(self, tick: int) -> WorldInfo:
        """Starts the world, which pauses after this tick, counted from the beginning of the run. `wait` waits for the
        pause."""
        return await self._command("run_until_tick", tick=tick)

    async def step(self, ticks: int = 1) -> WorldInfo:
        """Runs this number of ticks and returns after the last one.

        Examples
        --------
        >>> import evod.aio
        >>> async with evod.aio.local() as lab:
        ...     world = await lab.world()
        ...     info = await world.step(60)
        >>> info.tick
        60
        """
        info: WorldInfo = result(await self._link.perform(self._plans.step(self.name, ticks)))
        return info

    async def wait(self) -> WorldInfo:
        """Waits until the world stops running, and returns its state."""
        info: WorldInfo = result(await self._link.perform(self._plans.wait(self.name)))
        return info

    async def pause(self) -> WorldInfo:
        """Pauses the world. `resume` continues towards the same goal."""
        return await self._command("pause")

    async def resume(self) -> WorldInfo:
        """Continues after `pause`, until the goal of the last `run` or `run_until_tick` is reached."""
        return await self._command("resume")

    async def set_speed(self, speed: float | str) -> WorldInfo:
        """Sets the speed: simulated seconds per second, 0.001 to 10,000, or "max" for as fast as the machine allows."""
        return await self._command("set_speed", speed=plans.speed_message(speed))

    async def reset(
        self, seed: int | None = None, *, free_genes: Sequence[Mapping[str, object]] | None = None
    ) -> WorldInfo:
        """Starts a new run at generation 1, with the given seed, or by default the same seed. The world waits for
        `run`.

        free_genes is the list of the free genes from now on (`evod.genes.Real` and its neighbours); [] removes the
        list. By default the list stays."""
        listed = None if free_genes is None else plans.gene_list(free_genes)
        return await self._command("reset_world", seed=seed, free_genes=listed)

    async def note(self, text: str, kind: str = "note") -> WorldInfo:
        """Writes a note into the journal of the run; it changes nothing in the world. `notes` returns it.

        Parameters
        ----------
        text
            1 to 4,096 bytes of UTF-8.
        kind
            1 to 32 characters of a-z, 0-9 and "_": "prediction".
        """
        return await self._command("add_note", kind=kind, text=text)

    async def release_lease(self) -> WorldInfo:
        """Ends the lease of the last `run_until_tick` or `step`, so that the world resumes if it was running before."""
        return await self._command("release_lease")

    async def renew_lease(self) -> None:
        """Renews the lease of the last `run_until_tick` or `step` for its full duration."""
        await self._request("renew_lease")

    async def fork(self, name: str, at_generation: int | None = None) -> World:
        """Creates a new world that begins with the state of this world at one moment. This world is not changed.

        Parameters
        ----------
        name
            The name of the new world, which waits for `run`.
        at_generation
            The new world begins at the first tick of this generation. By default it begins with the current state.
        """
        plan = self._plans.derived_world("fork_world", world=self.name, name=name, at_generation=at_generation)
        return World(self._lab, await self._link.perform(plan))

    async def delete(self) -> None:
        """Deletes the world from the server."""
        await self._request("delete_world")

    # ---- links and replays ----------------------------------------------------------------------------------------

    async def link(
        self,
        generation: int | None = None,
        tick: int | None = None,
        *,
        island: int | None = None,
        organism: int | None = None,
        live: bool = False,
        page: str | None = None,
    ) -> str:
        """Returns a link at which a browser shows a moment of this world.

        Parameters
        ----------
        generation, tick
            The moment; the tick is counted from the beginning of the generation. By default the present moment.
        island
            Index of the island that the page shows.
        organism
            The id of an organism that the page selects.
        live
            Whether the link shows the world as it runs, without a moment.
        page
            The address of the page, for example of a proxy. By default the address that the server reports.

        Raises
        ------
        FailedPrecondition
            The server has no page that this machine can reach. `evod --web` serves one.

        Examples
        --------
        >>> import evod.aio
        >>> async with evod.aio.local(seed=1) as lab:
        ...     world = await lab.world()
        ...     await world.link(organism=7, page="https://evod.example.org")
        'https://evod.example.org/#world=default&generation=1&tick=0&island=0&organism=7'
        """
        info = await self._link.perform(plans.world_info(self.name))
        if page is None:
            page = page_link.page_of(self._lab.welcome, self._link.server, self._link.tls)
            page_link.warn_of_other_host(self._lab.welcome, self._link.server)
        return page_link.link_of(page, info, generation, tick, island, organism, live)

    async def show(self, *, width: int | str = "100%", height: int | str = 600) -> PageFrame:
        """Shows the page with this world in a notebook; a replay is shown at its moment.

        Outside of notebooks it prints the link of the page. The server allows its page in a notebook if `local` has
        started it in the notebook, or with the option ``--embed-in ORIGIN`` of evod.

        Parameters
        ----------
        width, height
            The size of the frame, in px or as text with a unit of CSS.

        Raises
        ------
        FailedPrecondition
            The server has no page that this machine can reach.
        """
        info = await self._link.perform(plans.world_info(self.name))
        frame = PageFrame(await self.link(live=not info.replay.replay_of), width, height)
        if not in_notebook():
            print(frame.link)
        return frame

    @opens
    async def open_replay(self, generation: int | None = None, tick: int | None = None) -> Replay:
        """Opens a replay of this world's stored run. The server must record its runs.

        Parameters
        ----------
        generation, tick
            The moment at which the replay begins. If both are given, the tick is counted from the beginning of the
            generation. If only the tick is given, it is counted from the beginning of the run. If neither is given, the
            replay begins at the beginning of the run.
        """
        at = plans.moment_message(generation, tick) if (generation, tick) != (None, None) else None
        plan = self._plans.derived_world("open_replay", world=self.name, at=at)
        return Replay(self._lab, await self._link.perform(plan))


class Replay(World, Closing):
    """A replay of another world's stored run, returned by `World.open_replay`.

    It ends with close(), or when the connection ends.
    """

    async def seek(self, generation: int | None = None, tick: int | None = None) -> WorldInfo:
        """Moves the replay to a moment, given as in `World.open_replay`; by default to the last stored moment."""
        return await self._command("seek", to=plans.moment_message(generation, tick))

    async def close(self) -> None:
        """Removes the replay from the server."""
        await self._link.perform(plans.close_replay(self.name))

