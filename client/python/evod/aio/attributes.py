"""The asynchronous counterpart of evod.attributes. It has no attributes, because an attribute cannot be awaited."""
from __future__ import annotations


class ParameterAttributes:
    """The empty base class of evod.aio.World. In place of evod.World.parameters use get_parameters() and set()."""
