"""Plans of classes, and the tables of their worlds. This module does no I/O.

`class` is a keyword of Python, so fields of this name are read with getattr() and passed in a mapping.
"""
from __future__ import annotations

import csv
import dataclasses
import io
import json
from typing import Any, Mapping, Sequence

from evod import plans
from evod.conversion import result
from evod.errors import FailedPrecondition, NotFound, wrong_argument
from evod.lab_plans import LabPlans
from evod.plans import Plan, request
from evod.results import ClassInfo, ClassMember, PersonalCode
from evod.v1 import commands_pb2 as c, world_pb2

_SEEDS = {"same": c.CLASS_SEEDS_SAME, "own": c.CLASS_SEEDS_OWN}
_SUMMARY = ("number", "name", "world", "generations", "best_generation", "best_fitness", "last_mean")


@dataclasses.dataclass(frozen=True)
class Note:
    """A note in the journal of a world."""

    number: int  #: of the entry in the journal
    tick: int  #: the note was added after this tick of the run
    generation: int
    user: str  #: who added it; "" for a client without a token
    kind: str  #: "note", "prediction", …
    text: str


def notes_in(text: str) -> tuple[Note, ...]:
    """Parses the table of notes as JSON lines."""
    fields = [field.name for field in dataclasses.fields(Note)]
    rows = (json.loads(line) for line in text.splitlines())
    return tuple(Note(**{name: row[name] for name in fields}) for row in rows)


def notes(world: str) -> Plan[tuple[Note, ...]]:
    """Returns the notes of a world's run."""
    return notes_in((yield from plans.export(world, "notes", "jsonl", None, None)))


def observe(world: str, expression: str) -> Plan[float | None]:
    """Computes one observation."""
    response = yield from request("observe", world=world, expressions=[expression])
    observation = response.observations.observations[0]
    return observation.value if observation.HasField("value") else None


def class_infos() -> Plan[tuple[ClassInfo, ...]]:
    """Returns the classes of this user."""
    return tuple(result(info) for info in (yield from request("list_classes")).classes.classes)


def class_info(name: str) -> Plan[ClassInfo]:
    """Returns one class."""
    infos = yield from class_infos()
    for info in infos:
        if info.name == name:
            return info
    raise NotFound(f"no class has the name '{name}'; the classes are: {', '.join(i.name for i in infos) or 'none'}")


def create_class(
    of_lab: LabPlans,
    name: str,
    parameters: Mapping[str, object],
    seed: int | None,
    population: Sequence[Any] | None,
    seeds: str,
    ranges: Mapping[str, tuple[float, float]] | None,
    member_worlds_max: int | None,
    lesson: str,
) -> Plan[str]:
    """Creates a class; returns its name."""
    if seeds not in _SEEDS:
        raise wrong_argument("seeds", ", ".join(_SEEDS), seeds)
    yield from request(
        "create_class",
        name=name,
        template=(yield from of_lab.new_world("", parameters, seed, population)),
        seeds=_SEEDS[seeds],
        ranges=ranges_message(ranges),
        member_worlds_max=member_worlds_max,
        lesson=lesson,
    )
    return name


def ranges_message(ranges: Mapping[str, tuple[float, float]] | None) -> c.QuotaRanges | None:
    """Converts narrower ranges to the message to send."""
    if ranges is None:
        return None
    message = c.QuotaRanges()
    for parameter, bounds in ranges.items():
        try:
            low, high = bounds
            message.ranges.add(parameter=parameter, min=low, max=high)
        except (TypeError, ValueError):
            raise wrong_argument(f"ranges[{parameter!r}]", "a pair of numbers, (min, max)", repr(bounds)) from None
    return message


def update(name: str, /, **fields: Any) -> Plan[ClassInfo]:
    """Changes a class; returns its new state."""
    info: ClassInfo = result((yield from request("update_class", **{"class": name}, **fields)).class_info)
    return info


def add_members(name: str, names: Sequence[str]) -> Plan[tuple[PersonalCode, ...]]:
    """Adds members; returns their personal codes."""
    response = yield from request("add_members", **{"class": name}, names=list(names))
    return tuple(result(code) for code in response.personal_codes.codes)


def member_of(info: ClassInfo, member: int | str | ClassMember) -> ClassMember:
    """Returns the member with a name or a number."""
    wanted = member.number if isinstance(member, ClassMember) else member
    for one in info.members:
        if wanted in (one.name, one.number):
            return one
    raise NotFound(f"the class '{info.name}' has no member {wanted!r}")


def change_member(name: str, member: int | str | ClassMember, /, **fields: Any) -> Plan[tuple[PersonalCode, ...]]:
    """Changes one member."""
    number = member_of((yield from class_info(name)), member).number
    response = yield from request("change_member", **{"class": name}, number=number, **fields)
    return tuple(result(code) for code in response.personal_codes.codes)


def for_each(name: str, action: str, message: Any) -> Plan[dict[str, str]]:
    """Applies an action to every world; returns the refusals by world."""
    response = yield from request("for_each_world", **{"class": name, action: message})
    return {one.world: one.status.message for one in response.world_results.results if one.HasField("status")}


def set_parameters(of_lab: LabPlans, name: str, values: Mapping[str, object]) -> Plan[dict[str, str]]:
    """Sets parameters in every world."""
    registry = yield from of_lab.registry()
    return (yield from for_each(name, "set_parameters", c.SetParameters(parameters=registry.assignments(values))))


def resume(name: str) -> Plan[dict[str, str]]:
    """Ends the freeze of a class, or continues its paused worlds."""
    if (yield from class_info(name)).frozen:
        yield from update(name, frozen=False)
        return {}
    return (yield from for_each(name, "resume", c.Resume()))


# ---- results -------------------------------------------------------------------------------------------------------


def compare(name: str) -> Plan[list[dict[str, Any]]]:
    """Returns one row for each member, generation and island."""
    rows = []
    for member in (yield from class_info(name)).members:
        for row in (yield from _history(member)):
            statistics = {field.name: getattr(row, field.name) for field in row.DESCRIPTOR.fields
                          if field.message_type is None}
            rows.append({"number": member.number, "name": member.name, "world": member.world, **statistics})
    return rows


def _history(member: ClassMember) -> Plan[list[world_pb2.GenerationStatistics]]:
    """Returns the statistics of the world with which a member began; none if the member has not joined yet, or has
    deleted the world."""
    rows: list[world_pb2.GenerationStatistics] = []
    first = None
    while True:
        try:
            answer = (yield from request("get_history", world=member.world, first_generation=first)).history
        except NotFound:
            return rows
        rows += answer.generations
        if not answer.HasField("next_generation"):
            return rows
        first = answer.next_generation


def run_file(world: str) -> Plan[bytes]:
    """Returns the bytes of a copy of the run file of a world."""
    return (yield from plans.exported(world=world, table=c.RUN_TABLE_FILE))


@dataclasses.dataclass
class Collected:
    """What `Classroom.collect` writes into a folder, apart from the run files."""

    worlds: tuple[str, ...]  #: whose run files to write
    notes: str  #: notes.csv
    students: str  #: students.csv


def collect(name: str) -> Plan[Collected]:
    """Returns the tables of a class, and the names of its worlds."""
    info = yield from class_info(name)
    worlds = [world for world in (yield from plans.worlds()) if getattr(world, "class") == name]
    of_user = {member.user: member for member in info.members}
    all_notes = []
    for world in worlds:
        member = of_user.get(world.owner)
        for note in (yield from notes(world.name)):
            who = (member.number, member.name) if member else ("", "")
            all_notes.append((*who, world.name, *dataclasses.astuple(note)))
    students = []
    for member in info.members:
        own = [world for world in worlds if world.owner == member.user]
        try:
            results = summary_of((yield from _history(member)))
        except FailedPrecondition:  # the world is damaged
            results = summary_of(())
        written = sum(row[0] == member.number for row in all_notes)
        students.append((member.number, member.name, member.world, *results, _flag(member.joined),
                         _flag(member.removed), len(own), written))
    heading = ("number", "name", "world", "entry", "tick", "generation", "user", "kind", "text")
    return Collected(tuple(world.name for world in worlds), _csv(heading, all_notes),
                     _csv((*_SUMMARY, "joined", "removed", "worlds", "notes"), students))


def summary_of(rows: Sequence[world_pb2.GenerationStatistics]) -> tuple[object, object, object, object]:
    """The last ended generation, the generation of the best fitness, this fitness, and the last mean."""
    if not rows:
        return 0, "", "", ""
    best = max(rows, key=lambda row: row.fitness_best)
    last = [row for row in rows if row.generation == rows[-1].generation]
    organisms = sum(row.organism_count for row in last)
    mean = sum(row.fitness_mean * row.organism_count for row in last) / organisms if organisms else 0.0
    return rows[-1].generation, best.generation, best.fitness_best, mean


def _flag(value: bool) -> str:
    return "true" if value else "false"


def _csv(heading: Sequence[str], rows: Sequence[Sequence[object]]) -> str:
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(heading)
    writer.writerows(rows)
    return text.getvalue()


