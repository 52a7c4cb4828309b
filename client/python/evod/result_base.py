"""The base classes of results.py."""
from __future__ import annotations

import enum
from typing import Any

from evod.tables import html_table


class State(enum.IntEnum):
    """A state with the numbers of the protocol. A state that this package does not know is named UNKNOWN_N."""

    @classmethod
    def _missing_(cls, value: object) -> Any:
        if not isinstance(value, int):
            return None
        state = int.__new__(cls, value)
        state._name_, state._value_ = f"UNKNOWN_{value}", value
        return state

    def __str__(self) -> str:
        return self.name.lower()


class Result:
    """Notebooks show a result as a table of its fields."""

    def _repr_html_(self) -> str:
        return html_table((), ((name, str(value)) for name, value in vars(self).items()))
