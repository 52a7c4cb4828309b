"""Parameters: the descriptions in the registry, the values in a world, and the checks of values before they are
sent."""
from __future__ import annotations

import dataclasses
import difflib
import math
import operator
import re
from typing import Any, Iterator, Mapping, Union

import numpy

from evod.errors import InvalidArgument, Violation
from evod.tables import html_table
from evod.v1 import commands_pb2, world_pb2

Value = Union[float, int, bool, str]

_KINDS = {
    world_pb2.PARAMETER_KIND_REAL: "real",
    world_pb2.PARAMETER_KIND_COUNT: "count",
    world_pb2.PARAMETER_KIND_FLAG: "flag",
    world_pb2.PARAMETER_KIND_CHOICE: "choice",
}
_EFFECTS = {
    world_pb2.PARAMETER_EFFECT_NEXT_TICK: "next tick",
    world_pb2.PARAMETER_EFFECT_NEXT_GENERATION: "next generation",
    world_pb2.PARAMETER_EFFECT_RESET: "reset",
}


@dataclasses.dataclass(frozen=True)
class Description:
    """The description of a parameter."""

    name: str
    kind: str  #: "real", "count", "flag" or "choice"
    unit: str  #: "px", "s", "chance", …; "" if the parameter has no unit
    min: float  #: smallest allowed value, for the kinds "real" and "count"
    max: float  #: largest allowed value, for the kinds "real" and "count"
    choices: tuple[str, ...]  #: allowed values, for the kind "choice"
    default: Value
    effect: str  #: when a change takes effect: "next tick", "next generation" or "reset"
    help: str  #: one sentence about its meaning

    @property
    def allowed(self) -> str:
        """The allowed values in words: "0 to 1", "a whole number, 1 to 4096", "true or false", "ring, none"."""
        if self.kind == "real":
            return f"{number_text(self.min)} to {number_text(self.max)}"
        if self.kind == "count":
            return f"a whole number, {int(self.min)} to {int(self.max)}"
        return "true or false" if self.kind == "flag" else ", ".join(self.choices)

    def got(self, value: object) -> str:
        """Formats a refused value for an error message: as the server does if its type is correct, otherwise as Python
        does."""
        kinds = {"real": (int, float, numpy.number), "count": (int, numpy.integer), "choice": (str,)}
        right_kind = isinstance(value, kinds.get(self.kind, ())) and not isinstance(value, (bool, numpy.bool_))
        return text_of(value) if right_kind else repr(value)

    def violation(self, value: object, field: str = "") -> Violation:
        """What is wrong with a refused value, and what to write in its place."""
        hint = ""
        if isinstance(value, str) and self.kind in ("real", "count"):
            if re.fullmatch(r"\s*[+-]?\d+,\d+\s*", value):
                hint = f"; write a decimal point: {value.strip().replace(',', '.')}"
            elif re.fullmatch(r"\s*[+-]?(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?\s*", value):
                hint = "; write it without quotation marks"
        elif isinstance(value, str) and self.kind == "flag" and value.lower() in ("true", "false"):
            hint = f"; write {value.capitalize()} without quotation marks"
        elif isinstance(value, (list, tuple, numpy.ndarray)):
            hint = "; evod.sweep(grid=…) runs a world with each value of a list"
            if self.name.startswith("free_gene_"):
                hint = "; free_genes as a list of evod.genes.Real(…) gives each gene values of its own"
        return Violation(field or self.name, self.allowed + hint, self.got(value))

    def message(self, value: object) -> world_pb2.ParameterValue | None:
        """Converts a value to the message to send; returns None if the value is not allowed."""
        if self.kind == "choice":
            return world_pb2.ParameterValue(choice=value) if isinstance(value, str) and value in self.choices else None
        is_flag = isinstance(value, (bool, numpy.bool_))
        if self.kind == "flag":
            return world_pb2.ParameterValue(flag=bool(value)) if is_flag else None
        if is_flag or isinstance(value, str):
            return None
        number: Any = value
        try:
            if self.kind == "count":
                whole = isinstance(value, (float, numpy.floating)) and float(value).is_integer()
                count = operator.index(int(number) if whole else number)
                return world_pb2.ParameterValue(count=count) if self.min <= count <= self.max else None
            real = float(number)
        except (TypeError, ValueError, OverflowError):
            return None
        return world_pb2.ParameterValue(real=real) if math.isfinite(real) and self.min <= real <= self.max else None


@dataclasses.dataclass(frozen=True)
class Parameter(Description):
    """A parameter of a world: its description and its value."""

    value: Value  #: the current value
    pending: Value | None  #: the value that takes effect at the next generation or reset; None if none is pending


@dataclasses.dataclass(frozen=True)
class Actor:
    """The cause of an event or a command. Clients with the role viewer receive only `kind` and `user`."""

    kind: str  #: "client", "schedule", "goal" or "server"
    user: str  #: the user to whom the client's token belongs; "" without a token
    client: str  #: the name of the client program
    address: str  #: the client's address: "127.0.0.1:51234"

    @classmethod
    def of(cls, message: world_pb2.Actor) -> Actor:
        """Converts the message of the protocol."""
        kind = world_pb2.ActorKind.Name(message.kind).removeprefix("ACTOR_KIND_").lower()
        return cls(kind=kind, user=message.user, client=message.client, address=message.address)


@dataclasses.dataclass(frozen=True)
class PlannedChange:
    """A planned change of parameters. When it is due, the server checks it again and applies it completely or drops
    it."""

    id: int  #: 0 for a dry run
    generation: int | None  #: the change is due at the first tick of this generation; None if `tick` is set
    #: the change is due after this tick, counted from the beginning of the run; None if `generation` is set
    tick: int | None
    values: Mapping[str, Value]  #: by parameter name
    by: Actor  #: the client that planned it

    @classmethod
    def of(cls, message: world_pb2.PlannedChange) -> PlannedChange:
        """Converts the message of the protocol."""
        return cls(
            id=message.id,
            generation=message.generation if message.HasField("generation") else None,
            tick=message.tick if message.HasField("tick") else None,
            values={assignment.name: value_of(assignment.value) for assignment in message.parameters},
            by=Actor.of(message.by),
        )


class Registry(Mapping[str, Description]):
    """The descriptions of all parameters, by name.

    Examples
    --------
    >>> import evod
    >>> with evod.local() as lab:
    ...     registry = lab.registry()
    >>> registry["mutation_chance"].allowed, registry["mutation_chance"].default
    ('0 to 1', 0.15)
    """

    def __init__(self, descriptions: Mapping[str, Description]) -> None:
        self._descriptions = dict(descriptions)

    @classmethod
    def of(cls, message: commands_pb2.Description) -> Registry:
        """Converts the message of the protocol."""
        return cls({parameter.name: _description(parameter) for parameter in message.parameters})

    def __getitem__(self, name: str) -> Description:
        return self._descriptions[name]

    def __iter__(self) -> Iterator[str]:
        return iter(self._descriptions)

    def __len__(self) -> int:
        return len(self._descriptions)

    def assignments(self, values: Mapping[str, object]) -> list[world_pb2.ParameterAssignment]:
        """Converts a mapping of names to values into the messages to send.

        Raises one InvalidArgument that lists every value that is not allowed, in the same words as the server.
        """
        made, violations = [], []
        for name, value in values.items():
            description = self._descriptions.get(name)
            if description is None:
                hint = _HINTS.get(name) or self._allowed_instead_of(name)
                violations.append(Violation(name, hint, "an unknown name"))
            elif (message := description.message(value)) is None:
                violations.append(description.violation(value))
            else:
                made.append(world_pb2.ParameterAssignment(name=name, value=message))
        if violations:
            raise InvalidArgument("invalid parameter values", violations)
        return made

    def planned(
        self, values: Mapping[str, object]
    ) -> tuple[list[world_pb2.ParameterAssignment], list[world_pb2.ScheduledValue]]:
        """Converts a mapping of names to values, or to schedules of values by generation, into the messages to send.

        Returns the values for generation 1 and the values for later generations. Raises one InvalidArgument that lists
        every value that is not allowed.
        """
        first: dict[str, object] = {}
        later, violations = [], []
        for name, value in values.items():
            if not isinstance(value, Mapping) or name not in self._descriptions:
                first[name] = value
                continue
            description = self._descriptions[name]
            if description.effect == "reset":
                allowed = "one value: it can change only at a reset"
                violations.append(Violation(name, allowed, repr(value)))
                continue
            for generation, of_generation in value.items():
                try:
                    number = int(generation) if isinstance(generation, str) else operator.index(generation)
                except (TypeError, ValueError):
                    number = 0
                if not 1 <= number < 2**64:
                    allowed = "generations from 1 on; there is no period, so list each generation: " \
                              "{generation: value for generation in range(1, 100, 5)}"
                    violations.append(Violation(name, allowed, repr(generation)))
                elif number == 1:
                    first[name] = of_generation
                elif (message := description.message(of_generation)) is None:
                    violations.append(description.violation(of_generation, f"{name} at generation {number}"))
                else:
                    later.append(world_pb2.ScheduledValue(name=name, generation=number, value=message))
        try:
            assignments = self.assignments(first)
        except InvalidArgument as error:
            raise InvalidArgument(error.message, [*error.violations, *violations]) from None
        if violations:
            raise InvalidArgument("invalid parameter values", violations)
        return assignments, later

    def _allowed_instead_of(self, name: str) -> str:
        similar = difflib.get_close_matches(name, self._descriptions, n=3)
        return "a parameter of the registry" + (f"; did you mean {', '.join(similar)}" if similar else "")

    def __repr__(self) -> str:
        return f"<registry of {len(self)} parameters>"

    def _repr_html_(self) -> str:
        return html_table(("name", "default", "allowed", "unit", "takes effect", "meaning"), (
            (d.name, text_of(d.default), d.allowed, d.unit, d.effect, d.help) for d in self.values()
        ))


class Parameters(Mapping[str, Parameter]):
    """The parameters of a world at one moment.

    The attributes are the values. Indexing with the name of a parameter returns a `Parameter` object.

    Examples
    --------
    >>> import evod
    >>> with evod.local() as lab:
    ...     parameters = lab.world().get_parameters()
    >>> parameters.population_size
    50
    >>> parameters["population_size"].help
    'Organisms on each island.'
    """

    def __init__(
        self, registry: Registry, message: world_pb2.ParameterSet, change: PlannedChange | None = None
    ) -> None:
        self._registry = registry
        self._states = {state.name: state for state in message.parameters if state.name in registry}
        self._revision = message.revision
        self._planned = tuple(PlannedChange.of(change) for change in message.planned)
        self._change = change
        self._schedule: dict[int, dict[str, Value]] = {}
        for scheduled in message.schedule:
            self._schedule.setdefault(scheduled.generation, {})[scheduled.name] = value_of(scheduled.value)

    @property
    def schedule(self) -> Mapping[int, Mapping[str, Value]]:
        """The schedule of the experiment. It maps each later generation to the values that take effect at its first
        tick.

        Only the result of get_parameters() contains the schedule.
        """
        return self._schedule

    @property
    def planned(self) -> tuple[PlannedChange, ...]:
        """The planned changes that are not due yet, in the order of their ids.

        Only the results of get_parameters(), and of set() with at_generation or at_tick, contain planned changes.
        """
        return self._planned

    @property
    def change(self) -> PlannedChange | None:
        """The change that this call of World.set() planned; None without at_generation and at_tick."""
        return self._change

    @property
    def revision(self) -> int:
        """A number that increases with every accepted change."""
        return self._revision

    def __getitem__(self, name: str) -> Parameter:
        state = self._states[name]
        return Parameter(
            **vars(self._registry[name]),
            value=value_of(state.value),
            pending=value_of(state.pending) if state.HasField("pending") else None,
        )

    def __iter__(self) -> Iterator[str]:
        return iter(self._states)

    def __len__(self) -> int:
        return len(self._states)

    def __getattr__(self, name: str) -> Value:
        if name.startswith("_"):
            raise AttributeError(name)
        if name not in self._states:
            raise AttributeError(_unknown_name(name, self._states))
        return value_of(self._states[name].value)

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._states]

    def __repr__(self) -> str:
        return f"<{len(self)} parameters, revision {self.revision}>"

    def _repr_html_(self) -> str:
        return html_table(("name", "value", "pending", "allowed", "unit", "takes effect", "meaning"), (
            (p.name, text_of(p.value), "" if p.pending is None else text_of(p.pending), p.allowed, p.unit, p.effect,
             p.help)
            for p in self.values()
        ))


def value_of(message: world_pb2.ParameterValue) -> Value:
    """Converts a message to a Python value."""
    value: Value = getattr(message, message.WhichOneof("kind") or "real")
    return value


def text_of(value: object) -> str:
    """Formats a value in the same way as the server."""
    if isinstance(value, (bool, numpy.bool_)):
        return "true" if value else "false"
    if isinstance(value, (float, numpy.floating)):
        return number_text(float(value))
    return str(value)


def number_text(number: float) -> str:
    """Formats a number with as few digits as possible, so that parsing the text returns exactly the same number.

    >>> number_text(1.0), number_text(0.001), number_text(5e5)
    ('1', '0.001', '5e+05')
    """
    if not math.isfinite(number):
        return str(number)
    fixed = numpy.format_float_positional(number, trim="-")
    scientific = numpy.format_float_scientific(number, trim="-", exp_digits=2)
    return fixed if len(fixed) <= len(scientific) else scientific


def _description(message: world_pb2.ParameterDescription) -> Description:
    return Description(
        name=message.name,
        kind=_KINDS.get(message.kind, ""),
        unit=message.unit,
        min=message.min,
        max=message.max,
        choices=tuple(message.choices),
        default=value_of(message.default_value),
        effect=_EFFECTS.get(message.effect, ""),
        help=message.help,
    )


_MINIMIZE = "minimize=True as an argument of world.evaluate"
#: Names that other optimisers have, and what evod has in their place.
_HINTS = {
    **dict.fromkeys(("minimize", "minimise", "maximize", "maximise", "minimization"), _MINIMIZE),
    **dict.fromkeys(("pop_size", "sol_per_pop"), "population_size"),
    **dict.fromkeys(("generations", "num_generations", "ngen"), "generation_limit, or generations=N of world.run and "
                    "world.evaluate"),
    **dict.fromkeys(("num_genes", "n_var", "dimensions"), "free_genes"),
    **dict.fromkeys(("bounds", "gene_space"), "free_gene_min and free_gene_max"),
    "fitness_function": "fitness external, and the function as an argument of world.evaluate",
    "mutation_rate": "mutation_chance",
    "crossover_rate": "crossover_chance",
    "elitism": "elite_count",
}


def _unknown_name(name: str, known: Mapping[str, object]) -> str:
    similar = difflib.get_close_matches(name, known, n=3)
    return f"there is no parameter '{name}'" + (f"; did you mean {', '.join(similar)}" if similar else "")
