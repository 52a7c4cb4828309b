"""What a World's parameters are as attributes: nothing here, as an attribute cannot be awaited."""
from __future__ import annotations


class ParameterAttributes:
    """The base class of World. It adds `parameters` to evod.World; here use World.get_parameters() and World.set()."""
