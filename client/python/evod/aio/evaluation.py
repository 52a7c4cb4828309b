"""The run of a world that a function rates. evod.evaluation is generated from this file.

Threads      call everything on the event loop on which connect() or local() ran. The fitness function runs on another
             thread.
"""
from __future__ import annotations

from typing import Any, AsyncIterator, Callable, Protocol, TypeVar

import numpy
import numpy.typing

from evod.aio.link import Link, blocking_call, call_back
from evod.errors import FailedPrecondition
from evod.generations import Generation, History, Population
from evod.objectives import Front
from evod.plans import GenerationStream, Plan
from evod.progress import ProgressLine
from evod.rating import EndRules, Rater
from evod.results import WorldInfo

T = TypeVar("T")


class _Rated(Protocol):
    """A world whose organisms a client rates."""

    @property
    def name(self) -> str: ...

    def _fitness_plan(self, population: Population, fitness: numpy.typing.NDArray[Any],
                      genes: numpy.typing.NDArray[Any] | None) -> Plan[bool]: ...

    async def pause(self) -> WorldInfo: ...


class Evaluation(History):
    """The generations of `World.evaluate`: a `History` with the reason of its end.

    While it runs, iterating it rates organisms until the next generation has ended, and yields this generation.
    """

    #: Why it has ended. "generations": all have been rated. "target", "stagnation", "seconds", "until": that argument.
    #: "pause": the world was paused. "generation_limit", "target_fitness", … : a termination criterion of the world.
    #: "break": a loop over it was left. "": it runs.
    reason: str = ""

    def __init__(self, link: Link, stream: GenerationStream, world: _Rated, rater: Rater, rules: EndRules,
                 on_generation: Callable[[Generation], object] | None, progress: bool) -> None:
        super().__init__()
        self._link, self._stream, self._world, self._rater, self._rules = link, stream, world, rater, rules
        self._on_generation = on_generation
        self._line = ProgressLine(stream.goal) if progress else None
        self._solutions = rater.hall_of_fame

    @property
    def evaluation_count(self) -> int:
        """The number of organisms that this call has rated."""
        return self._rater.evaluation_count

    def __repr__(self) -> str:
        return f"{super().__repr__()[:-1]}: {self.evaluation_count} evaluations, {self.reason or 'running'}>"

    def front(self) -> Front:
        """Returns the best organisms of the last generation, of a world with several objectives.

        Raises
        ------
        FailedPrecondition
            No generation has ended, or the world has one objective.
        """
        front = self[-1].front if len(self) else None
        if front is None:
            raise FailedPrecondition("no generation with several objectives has ended: create the world with "
                                     "objectives=2")
        return front

    def hypervolume(self, reference: numpy.typing.ArrayLike) -> numpy.typing.NDArray[numpy.float64]:
        """Returns the hypervolume of the front of each generation, of shape (generations,): `evod.hypervolume`."""
        return numpy.array([g.front.hypervolume(reference) for g in self[:] if g.front is not None])

    async def __aiter__(self) -> AsyncIterator[Generation]:
        index = 0
        try:
            while index < len(self) or await self._advance():
                yield self[index]
                index += 1
        finally:
            await self.close()

    async def wait(self: T) -> T:
        """Rates organisms until the end, and returns this object."""
        async for _ in self:  # type: ignore[attr-defined]
            pass
        return self

    async def close(self) -> None:
        """Rates nothing more. The world waits for the fitness of its generation, if it has not been paused."""
        if self._line is not None:
            self._line.end()
        if self._stream.is_open:
            self.reason = self.reason or "break"
            await self._link.apply(self._stream.close)

    async def __aenter__(self: T) -> T:
        return self

    async def __aexit__(self, *_: object) -> None:
        await self.close()

    async def _advance(self) -> bool:
        """Rates organisms until another generation has ended, and adds it. Returns False at the end."""
        if self.reason:
            return False
        step = await self._link.perform(self._stream.rated_step(None))
        while isinstance(step, Population):
            fitness, genes = await blocking_call(self._rater.rate, step)
            step = await self._link.perform(self._stream.rated_step(self._world._fitness_plan(step, fitness, genes)))
        if step is None:
            self.reason = self._stream.reason
            return False
        generation = self._rater.completed(step)
        self.append(generation)
        if self._line is not None:
            self._line.show(generation)
        if self._on_generation is not None:
            await call_back(self._on_generation, generation)
        self.reason = self._rules.reason(generation)
        if self.reason:
            await self._world.pause()
        return True
