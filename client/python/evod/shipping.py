"""What worker processes get: tasks and functions, also lambdas, functions of the main program and inner functions.

pickle sends a function as the name of its module, which another process imports. It cannot import the main program
without running it again, so such functions are sent as their code, with the variables that they use.
"""
from __future__ import annotations

import builtins
import dataclasses
import dis
import importlib
import io
import marshal
import pickle
import sys
import types
from typing import Any, Callable, Iterator, Mapping

from evod.errors import wrong_argument


@dataclasses.dataclass(frozen=True)
class Task:
    """One run: a world with a seed, and how long it is evaluated."""

    parameters: Mapping[str, object]
    seed: int
    generations: int | None
    minimize: bool


def ship(function: Callable[..., object]) -> bytes:
    """Returns a function as bytes for `pickle.loads` in a process with the same version of Python.

    Raises InvalidArgument if the function uses something that cannot be sent, such as an open file or a Lab.
    """
    if not callable(function):
        raise wrong_argument("function", "a function of genes and life", repr(function))
    data = io.BytesIO()
    try:
        _Pickler(data, pickle.HIGHEST_PROTOCOL).dump(function)
    except (TypeError, AttributeError, ValueError, RecursionError, pickle.PicklingError) as error:
        allowed = "a function that uses only modules, functions, numbers, texts, arrays and their containers"
        raise wrong_argument("function", allowed, f"{getattr(function, '__name__', function)}: {error}",
                             "the function cannot be sent to other processes") from None
    return data.getvalue()


class _Pickler(pickle.Pickler):
    def reducer_override(self, item: Any) -> Any:
        if isinstance(item, types.ModuleType):
            return importlib.import_module, (item.__name__,)
        if isinstance(item, type) and item.__module__ == "__main__":
            name = item.__qualname__
            raise pickle.PicklingError(f"it uses the class {name} of the main program; put it into a module")
        if isinstance(item, types.CellType):
            return _cell, (item.cell_contents,)
        if not isinstance(item, types.FunctionType) or _can_be_imported(item):
            return NotImplemented
        used = {name: item.__globals__[name] for name in _globals_of(item.__code__) if name in item.__globals__}
        state = {"globals": used, "defaults": item.__defaults__, "keywords": item.__kwdefaults__}
        made_from = marshal.dumps(item.__code__), item.__name__, item.__closure__
        return _function, made_from, state, None, None, _complete


def _can_be_imported(function: types.FunctionType) -> bool:
    found: Any = sys.modules.get(function.__module__) if function.__module__ != "__main__" else None
    for name in function.__qualname__.split("."):
        found = getattr(found, name, None)
    return found is function


def _globals_of(code: types.CodeType) -> Iterator[str]:
    """The names of the global variables that the code and the functions in it use."""
    for instruction in dis.get_instructions(code):
        if instruction.opname in ("LOAD_GLOBAL", "LOAD_NAME"):
            yield str(instruction.argval)
    for part in code.co_consts:
        if isinstance(part, types.CodeType):
            yield from _globals_of(part)


def _function(code: bytes, name: str, closure: tuple[types.CellType, ...] | None) -> types.FunctionType:
    """A function without its variables: _complete adds them, because they may contain the function itself."""
    return types.FunctionType(marshal.loads(code), {"__builtins__": builtins, "__name__": "evod function"}, name, None,
                              closure)


def _cell(contents: object) -> types.CellType:
    """A variable of a function in a function."""
    return types.CellType(contents)


def _complete(function: types.FunctionType, state: dict[str, Any]) -> None:
    function.__globals__.update(state["globals"])
    function.__defaults__, function.__kwdefaults__ = state["defaults"], state["keywords"]
