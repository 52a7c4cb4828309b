"""Classes: worlds of students under one teacher. evod.classrooms is generated from this file.

Threads      call everything on the event loop on which connect() or local() ran.
"""
from __future__ import annotations

import os
import pathlib
from typing import Any, Mapping, Sequence

import numpy.typing

from evod import class_plans, plans
from evod.aio.link import Link, blocking_call
from evod.experiment import Experiment, world_values
from evod.lab_plans import LabPlans
from evod.results import ClassInfo, ClassMember, PersonalCode
from evod.v1 import commands_pb2 as c


class Classrooms:
    """The base class of Lab. It provides the methods of teachers."""

    _link: Link
    _plans: LabPlans

    async def classes(self) -> tuple[Classroom, ...]:
        """Returns the classes of this user, ordered by name; for a controller or an admin, all classes."""
        return tuple(Classroom(self._link, self._plans, info.name)
                     for info in await self._link.perform(class_plans.class_infos()))

    async def classroom(self, name: str) -> Classroom:
        """Returns the class with this name.

        Raises
        ------
        NotFound
            This user has no such class.
        """
        return Classroom(self._link, self._plans, (await self._link.perform(class_plans.class_info(name))).name)

    async def create_class(
        self,
        name: str,
        parameters: Experiment = None,
        *,
        seed: int | None = None,
        population: Sequence[numpy.typing.ArrayLike] | None = None,
        seeds: str = "same",
        ranges: Mapping[str, tuple[float, float]] | None = None,
        member_worlds_max: int | None = None,
        lesson: str = "",
    ) -> Classroom:
        """Creates a class. Students can join with its code at once: `Classroom.info`.

        Parameters
        ----------
        name
            1 to 24 characters of a-z, 0-9 and "-", beginning with a letter.
        parameters, seed, population
            The world of each member, as for `Lab.create_world`.
        seeds
            "same": all worlds begin alike; "own": each member has another seed, which follows from `seed` and the
            member's number.
        ranges
            Narrower ranges of parameters in these worlds, as (min, max) by name. By default those that the server has
            for classes.
        member_worlds_max
            The largest number of worlds of one member, 1 to 8; by default 3.
        lesson
            The name of the lesson that the page of each member opens.

        Raises
        ------
        InvalidArgument
            `violations` lists every value that is not allowed.
        AlreadyExists
            The server has a class with this name.
        PermissionDenied
            The role of this client is lower than teacher.

        Examples
        --------
        >>> import evod.aio
        >>> async with evod.aio.local() as lab:
        ...     bio2 = await lab.create_class("bio2", {"population_size": 20}, seed=1,
        ...                                   ranges={"population_size": (1, 50)})
        ...     codes = await bio2.add_members(["Ada", "Bo"])
        ...     members = await bio2.members()
        >>> [member.world for member in members], len(codes[0].code)
        (['bio2_ada', 'bio2_bo'], 10)
        """
        values, file_seed = world_values(parameters)
        plan = class_plans.create_class(self._plans, name, values, file_seed if seed is None else seed, population,
                                        seeds, ranges, member_worlds_max, lesson)
        return Classroom(self._link, self._plans, await self._link.perform(plan))


class Classroom:
    """A class on a server, returned by `Lab.classroom` and `Lab.create_class`.

    Methods that change all worlds do so between two ticks: no world advances in between. They return the refusals by
    the name of the world; an empty mapping means that every world was changed. A member is given by name, by number,
    or as the `ClassMember`.
    """

    def __init__(self, link: Link, of_lab: LabPlans, name: str) -> None:
        self._link, self._plans, self._name = link, of_lab, name

    def __repr__(self) -> str:
        return f"<class {self.name}>"

    @property
    def name(self) -> str:
        """The name of the class."""
        return self._name

    async def info(self) -> ClassInfo:
        """Returns the state of the class: its code, whether it is frozen, its ranges, its members."""
        return await self._link.perform(class_plans.class_info(self.name))

    async def members(self) -> tuple[ClassMember, ...]:
        """Returns the members in the order in which they joined."""
        return (await self.info()).members

    # ---- joining --------------------------------------------------------------------------------------------------

    async def open(self, *, new_code: bool = False) -> str:
        """Lets students join for 20 minutes; returns the code. With `new_code` the code is replaced."""
        return (await self._update(open=True, new_code=new_code)).code

    async def lock(self) -> None:
        """Ends the code, so that no student can join. Members stay."""
        await self._update(open=False)

    async def add_members(self, names: Sequence[str]) -> tuple[PersonalCode, ...]:
        """Adds members from a list of names, all or none; for "" the server makes a name up.

        Returns
        -------
        tuple of PersonalCode
            The codes with which the members join on any device: `evod.join`. They cannot be read again.

        Raises
        ------
        InvalidArgument
            `violations` lists every name that is not allowed: ``names[2]``.
        ResourceExhausted
            The class is full.
        """
        return await self._link.perform(class_plans.add_members(self.name, names))

    async def new_personal_code(self, member: int | str | ClassMember) -> str:
        """Returns a new personal code of a member, whose token and earlier code no longer work."""
        plan = class_plans.change_member(self.name, member, new_personal_code=True)
        return (await self._link.perform(plan))[0].code

    async def kick(self, member: int | str | ClassMember) -> None:
        """Removes a member, whose sessions end; the world stays."""
        await self._link.perform(class_plans.change_member(self.name, member, removed=True))

    async def readmit(self, member: int | str | ClassMember) -> None:
        """Lets a removed member in again."""
        await self._link.perform(class_plans.change_member(self.name, member, removed=False))

    async def rename(self, member: int | str | ClassMember, name: str) -> None:
        """Changes the name of a member; the user and the world keep theirs."""
        await self._link.perform(class_plans.change_member(self.name, member, name=name))

    # ---- all worlds -----------------------------------------------------------------------------------------------

    async def freeze(self) -> None:
        """Stops all worlds at once. Until `resume`, members cannot change their worlds."""
        await self._update(frozen=True)

    async def resume(self) -> dict[str, str]:
        """Lets the worlds go on after `freeze`, or after `pause`."""
        return await self._link.perform(class_plans.resume(self.name))

    async def set(self, values: Mapping[str, object] | None = None, /, **more: object) -> dict[str, str]:
        """Sets parameters in all worlds: ``bio2.set(mutation_chance=0.1)``.

        Raises
        ------
        InvalidArgument
            `violations` lists every value that is not allowed.
        """
        given = {**(values or {}), **more}
        return await self._link.perform(class_plans.set_parameters(self._plans, self.name, given))

    async def run(self, generations: int | None = None) -> dict[str, str]:
        """Runs a number of generations in all worlds; by default until they are paused. Does not wait for them."""
        message = plans.build(c.Run, "run.", generations=generations)
        return await self._link.perform(class_plans.for_each(self.name, "run", message))

    async def pause(self) -> dict[str, str]:
        """Pauses all worlds. Members can let their worlds go on."""
        return await self._link.perform(class_plans.for_each(self.name, "pause", c.Pause()))

    async def set_speed(self, speed: float | str) -> dict[str, str]:
        """Sets the speed of all worlds: simulated seconds per second, 0.001 to 10,000, or "max"."""
        message = c.SetSpeed(speed=plans.speed_message(speed))
        return await self._link.perform(class_plans.for_each(self.name, "set_speed", message))

    async def reset(self, seed: int | None = None) -> dict[str, str]:
        """Starts the first world of each member again at generation 1, by default with the same seed."""
        message = plans.build(c.ResetWorld, "reset_world.", seed=seed)
        return await self._link.perform(class_plans.for_each(self.name, "reset_world", message))

    async def update(
        self,
        *,
        ranges: Mapping[str, tuple[float, float]] | None = None,
        member_worlds_max: int | None = None,
        lesson: str | None = None,
    ) -> ClassInfo:
        """Changes what is given, as for `Lab.create_class`. Values outside of new ranges that worlds have stay."""
        return await self._update(ranges=class_plans.ranges_message(ranges), member_worlds_max=member_worlds_max,
                                  lesson=lesson)

    async def _update(self, **fields: Any) -> ClassInfo:
        return await self._link.perform(class_plans.update(self.name, **fields))

    # ---- results --------------------------------------------------------------------------------------------------

    async def compare(self) -> list[dict[str, Any]]:
        """Returns a row for each member, generation and island, with all statistics but those of genes:
        ``pandas.DataFrame(bio2.compare())``. Fitness is in seconds unless the parameter ``fitness`` says otherwise."""
        return await self._link.perform(class_plans.compare(self.name))

    async def collect(self, folder: str | os.PathLike[str]) -> list[pathlib.Path]:
        """Writes the run file of each world, notes.csv with all notes, and students.csv with one row per member.

        Parameters
        ----------
        folder
            It is created if it does not exist. Each file appears when it is complete, and replaces one of its name.

        Returns
        -------
        list of pathlib.Path
            The written files.
        """
        path = pathlib.Path(folder)
        await blocking_call(path.mkdir, parents=True, exist_ok=True)
        collected = await self._link.perform(class_plans.collect(self.name))
        written = []
        for world in collected.worlds:
            data = await self._link.perform(class_plans.run_file(world))
            written.append(await blocking_call(_write, path / f"{world}.evod", data))
        for name, text in (("notes.csv", collected.notes), ("students.csv", collected.students)):
            written.append(await blocking_call(_write, path / name, text.encode()))
        return written

    async def delete(self) -> None:
        """Deletes the class and its worlds. Its members can no longer connect. The run files stay on the server."""
        await self._link.perform(plans.request("delete_class", **{"class": self.name}))


def _write(path: pathlib.Path, data: bytes) -> pathlib.Path:
    part = path.with_name(path.name + ".part")
    part.write_bytes(data)
    part.replace(path)
    return path
