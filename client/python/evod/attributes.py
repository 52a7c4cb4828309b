"""The parameters of a World as attributes. Only the synchronous World has them, because an attribute cannot be
awaited."""
from __future__ import annotations

from typing import Any, Iterator, Mapping, Protocol

from evod.errors import Error
from evod.parameters import Parameter, Parameters, Registry, Value
from evod.results import WorldInfo
from evod.tables import html_table


class _Lab(Protocol):
    def registry(self) -> Registry: ...


class _World(Protocol):
    @property
    def lab(self) -> _Lab: ...

    def info(self) -> WorldInfo: ...

    def get_parameters(self) -> Parameters: ...

    def set(self, values: Mapping[str, object] | None = None, /) -> Parameters: ...


class ParameterAttributes:
    """The base class of World. It provides the property `parameters`, and the representation of a world in
    notebooks."""

    def _repr_html_(self: _World) -> str:
        try:
            return self.info()._repr_html_()
        except Error as error:  # the world was deleted, or the server does not answer
            return html_table((), (("world", self), ("error", error)))

    @property
    def parameters(self: _World) -> LiveParameters:
        """The current parameters as attributes. Assigning a value to an attribute sets the parameter on the server.

        Every access sends a request to the server. Use `get_parameters` to read several parameters at the same moment,
        and `set` to set several of them together.

        Examples
        --------
        >>> import evod
        >>> with evod.local() as lab:
        ...     world = lab.world()
        ...     world.parameters.mutation_chance = 0.3
        ...     world.parameters.mutation_chance, world.parameters["mutation_chance"].allowed
        (0.3, '0 to 1')
        """
        return LiveParameters(self)


class _ReadName(str):
    """The name of a parameter from a loop over `of`, with what the request of the loop has read about it."""

    of: LiveParameters | None = None
    parameter: Parameter

    def __reduce__(self) -> Any:
        return str, (str(self),)


class LiveParameters(Mapping[str, Any]):
    """The current parameters of a world, returned by `World.parameters`.

    The attributes are the values. Indexing with the name of a parameter returns a `Parameter` object. A loop, and
    `dict(world.parameters)`, reads all parameters with one request.
    """

    def __init__(self, world: _World) -> None:
        object.__setattr__(self, "_world", world)

    _world: _World

    def __getattr__(self, name: str) -> Value:
        if name.startswith("_"):
            raise AttributeError(name)
        return self._world.get_parameters().__getattr__(name)

    def __setattr__(self, name: str, value: object) -> None:
        self._world.set({name: value})

    def __getitem__(self, name: str) -> Any:
        if isinstance(name, _ReadName) and name.of is self:
            name.of = None  # the next access sends a request
            return name.parameter
        return self._world.get_parameters()[name]

    def __iter__(self) -> Iterator[str]:
        for text, parameter in self._world.get_parameters().items():
            name = _ReadName(text)
            name.of, name.parameter = self, parameter
            yield name

    def __len__(self) -> int:
        return len(self._world.lab.registry())

    def __dir__(self) -> list[str]:
        return [*super().__dir__(), *self._world.lab.registry()]

    def __repr__(self) -> str:
        return f"<parameters of {self._world!r}>"

    def _repr_html_(self) -> str:
        return self._world.get_parameters()._repr_html_()
