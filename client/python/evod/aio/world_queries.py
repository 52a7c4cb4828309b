"""What a client reads of a world: its state, history, organisms and tables, and plots of them. evod.world_queries is
generated from this file.

Threads      call everything on the event loop on which connect() or local() ran.
"""
from __future__ import annotations

from typing import Any

from evod import class_plans, plans, plotting, tables
from evod.aio.awaitable import opens_stream
from evod.aio.link import Link
from evod.aio.streams import Events, Snapshots
from evod.class_plans import Note
from evod.conversion import result
from evod.errors import FailedPrecondition
from evod.generations import History, Population, Solution
from evod.lab_plans import LabPlans
from evod.results import Breeding, Motion, OrganismInfo, RunState, Statistics, WorldInfo
from evod.snapshots import Snapshot
from evod.v1 import commands_pb2 as c


class WorldQueries:
    """The base class of World. It provides the methods that read the world."""

    def __init__(self, link: Link, of_lab: LabPlans, name: str) -> None:
        self._link, self._plans, self._name = link, of_lab, name

    @property
    def name(self) -> str:
        """The name of the world on its server."""
        return self._name

    async def _request(self, kind: str, /, **fields: Any) -> c.Response:
        return await self._link.perform(plans.request(kind, world=self.name, **fields))

    async def info(self) -> WorldInfo:
        """Returns the current tick, generation, run state, speed, seed and gene names."""
        info: WorldInfo = result(await self._link.perform(plans.world_info(self.name)))
        return info

    async def snapshot(self, island: int = 0, *, genes: bool = False) -> Snapshot:
        """Returns the current state of an island.

        Parameters
        ----------
        island
            Index of the island.
        genes
            Whether ``snapshot.organisms.genes`` contains the genes.
        """
        return await self._link.perform(self._plans.snapshot(self.name, island, genes))

    @opens_stream
    async def snapshots(
        self,
        rate_hz: float = 30.0,
        *,
        island: int | None = None,
        genes: bool = False,
        region: tuple[float, float, float, float] | None = None,
        detail: str | None = None,
        bytes_per_s_max: int | None = None,
    ) -> Snapshots:
        """Subscribes to snapshots. A slow reader receives fewer snapshots, never stale ones.

        With `region`, `detail` or `bytes_per_s_max` each snapshot consists of tiles: see `Snapshot.tiles`.

        Parameters
        ----------
        rate_hz
            The largest number of snapshots per second for each island. The server may lower it: see
            `Snapshots.rate_hz`.
        island
            The index of the island to observe. By default snapshots of all islands arrive in turn.
        genes
            Whether ``snapshot.organisms.genes`` contains the genes. They are requested once per generation and island.
            If the generation has ended before, they are read from the run file.
        region
            A rectangle, as (left, top, width, height) in px. Snapshots contain only the tiles that overlap it.
        detail
            The highest level of detail: "full", "dots" or "density".
        bytes_per_s_max
            The largest number of bytes per second that the server sends. To stay below it, the server lowers the level
            of detail.

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
        return Snapshots(self._link, plans.SnapshotStream(self._link.core, subscription, genes))

    @opens_stream
    async def events(self) -> Events:
        """Subscribes to the events of this world that happen from now on."""
        subscription = await self._link.perform(self._plans.subscribe_events(self.name))
        return Events(self._link, plans.EventStream(self._link.core, subscription))

    async def statistics(self) -> Statistics:
        """Returns the live statistics of each island, and the statistics of the last generation that has ended."""
        answer = (await self._request("get_statistics")).statistics
        statistics: Statistics = result(answer, plans.gene_names_of(answer.world))
        return statistics

    async def history(
        self, first: int | None = None, last: int | None = None, *, island: int | None = None, minimize: bool = False
    ) -> History:
        """Returns the ended generations whose statistics the server still stores.

        Parameters
        ----------
        first, last
            The first and the last generation to return; the first generation of a run is 1. By default all generations.
        island
            The index of an island. If it is given, the result contains only the statistics of this island.
        minimize
            Show the numbers in the sign of a function that `World.evaluate` minimizes.
        """
        ended = await self._link.perform(plans.history(self.name, first, last, island))
        history = History(g.negated() for g in ended) if minimize else ended
        if history:
            began, end = history[0].number, history[-1].number
            history._solutions = lambda k: self.hall_of_fame(k, began, end, island=island, minimize=minimize)
        return history

    async def best(self, *, minimize: bool = False) -> Solution:
        """Returns the best organism of all ended generations: its genes, fitness, generation and island.

        Its ancestors are in ``world.table("lineage", of=best.of)``. The arguments are as for `hall_of_fame`.

        Raises
        ------
        FailedPrecondition
            No generation has ended.

        Examples
        --------
        >>> import evod.aio
        >>> async with evod.aio.local(seed=42) as lab:
        ...     world = await lab.world()
        ...     last = await (await world.run(generations=2)).wait()
        ...     best = await world.best()
        ...     ancestors = await world.table("lineage", of=best.of)
        >>> best.of, len(ancestors)
        ((1, 0, 1), 1)
        """
        found = await self.hall_of_fame(1, minimize=minimize)
        if not found:
            raise FailedPrecondition("no generation has ended yet")
        return found[0]

    async def hall_of_fame(
        self,
        k: int = 10,
        first: int | None = None,
        last: int | None = None,
        *,
        island: int | None = None,
        minimize: bool = False,
    ) -> list[Solution]:
        """Returns the k best organisms of the ended generations, best first; of organisms with equal genes the first.

        They are read from the run file, for more than one organism from its whole table of organisms.

        Parameters
        ----------
        k
            The number of organisms.
        first, last, island, minimize
            As for `history`.
        """
        return await self._link.perform(self._plans.hall_of_fame(self.name, k, first, last, island, minimize))

    async def organism(self, organism: int, island: int = 0) -> OrganismInfo:
        """Returns the genes, position, health, parents, next choice and neural network of the organism with this id.

        Raises
        ------
        NotFound
            The current generation contains no organism with this id.
        """
        answer = (await self._request("get_organism", island=island, organism=organism)).organism
        info: OrganismInfo = result(answer, await self._link.perform(plans.gene_names(self.name, len(answer.genes))))
        return info

    async def population(self, island: int = 0) -> Population:
        """Returns the genes, parents and choices of all organisms in the current generation as arrays.

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
    ) -> Breeding:
        """Returns a record of how a generation was bred: contenders, picks, pairs, crossover points and mutations.

        Parameters
        ----------
        island
            Index of the island.
        generation
            The generation of the parents. By default the last generation that has bred.
        first_contender, first_pick, first_descendant
            For each list, the index of the first row to return. Use them if a population does not fit into one answer.
        """
        response = await self._request(
            "get_breeding",
            island=island,
            generation=generation,
            first_contender=first_contender,
            first_pick=first_pick,
            first_descendant=first_descendant,
        )
        answer = response.breeding
        gene_count = len(answer.descendants[0].genes) if answer.descendants else None
        breeding: Breeding = result(answer, await self._link.perform(plans.gene_names(self.name, gene_count)))
        return breeding

    async def motion(self, island: int = 0) -> Motion:
        """Returns the total energy and momentum of the bodies on an island, and how much they overlap."""
        motion: Motion = result((await self._request("get_motion", island=island)).motion)
        return motion

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
            "generations", "organisms", "lineage", "population", "events" or "notes".
        format
            "csv" or "jsonl".
        generation
            For "population": the generation to export. By default the last generation that has begun.
        of
            For "lineage": an organism as (generation, island, id). The table then contains only the ancestors of this
            organism.
        """
        return await self._link.perform(plans.export(self.name, table, format, generation, of))

    async def table(self, table: str, *, generation: int | None = None, of: tuple[int, int, int] | None = None) -> Any:
        """Returns the table of `export` as a pandas DataFrame."""
        text = await self.export(table, generation=generation, of=of)
        has_genes = table in ("organisms", "population")
        choices = (await self._link.perform(plans.gene_names(self.name, None))).choices if has_genes else ()
        return tables.read_csv(text, choices)

    async def notes(self) -> tuple[Note, ...]:
        """Returns the notes of the run in the order in which they were added: see `World.note`."""
        return await self._link.perform(class_plans.notes(self.name))

    async def observe(self, expression: str) -> float | None:
        """Computes a number from the statistics of the run: ``world.observe("mean(fitness_mean, 1, 10)")``.

        Parameters
        ----------
        expression
            In the language of docs/LESSONS.md, at most 256 bytes.

        Returns
        -------
        float or None
            In the unit of the statistic. None: the run has no such value yet, for example too few generations.

        Raises
        ------
        InvalidArgument
            The expression is not one of the language.
        """
        return await self._link.perform(class_plans.observe(self.name, expression))

    # ---- plots ----------------------------------------------------------------------------------------------------

    async def plot(self, island: int = 0, ax: Any = None) -> Any:
        """Plots the current state of an island with matplotlib.

        Parameters
        ----------
        island
            Index of the island.
        ax
            The axes to draw into. By default new axes are created.

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
        """Plots the fitness of all ended generations; returns the axes."""
        return plotting.plot_fitness((await self.history()).columns(), ax)

    async def plot_genes(self, ax: Any = None) -> Any:
        """Plots the mean and the standard deviation of each gene in all ended generations; returns the axes."""
        history = await self.history()
        return plotting.plot_genes(history.columns(), history.gene_names, ax)

    async def plot_selection(self, gene: str, ax: Any = None) -> Any:
        """Plots how selection, transmission and migration changed the mean of a gene in each generation; returns the
        axes."""
        history = await self.history()
        return plotting.plot_selection(history.columns(), history.gene_names, gene, ax)

    async def animate(self, count: int = 100, rate_hz: float = 20.0, island: int = 0) -> Any:
        """Records snapshots of an island and returns them as a matplotlib animation. Notebooks can play it.

        Parameters
        ----------
        count
            The number of snapshots. The recording ends earlier if the world does not run.
        rate_hz
            The number of snapshots per second, both in the recording and in the animation.
        island
            Index of the island.
        """
        recorded: list[Snapshot] = []
        async with self.snapshots(rate_hz, island=island) as snapshots:
            async for snapshot in snapshots:
                recorded.append(snapshot)
                if len(recorded) >= count or snapshot.state != RunState.RUNNING:
                    break
        return plotting.animate(recorded, 1000 / rate_hz)
