"""Experiments as arguments: the path of an experiment file, or a mapping of parameter names to values."""
from __future__ import annotations

import json
import os
from typing import Any, Mapping, Union

import numpy

from evod import input_file
from evod.errors import FileNotFound, InvalidArgument, wrong_argument

Experiment = Union[str, "os.PathLike[str]", Mapping[str, object], None]


def with_parameters(experiment: Experiment, parameters: Mapping[str, object]) -> str | dict[str, object]:
    """Returns the experiment with other values for some parameters. A file without such values is returned as its
    path."""
    if experiment is not None and not isinstance(experiment, Mapping) and not parameters:
        return file_of(experiment)
    return {**values_of(experiment), **parameters}


def world_values(experiment: Experiment) -> tuple[dict[str, object], int | None]:
    """Returns the parameters of an experiment, and the seed in its file; None if it has none."""
    values = values_of(experiment)
    if experiment is None or isinstance(experiment, Mapping):
        return values, None
    values.pop("description", None)
    seed: Any = values.pop("seed", None)
    return values, seed


def file_of(experiment: str | os.PathLike[str]) -> str:
    """Returns the path of an experiment file. Raises FileNotFound if there is none."""
    if not isinstance(experiment, (str, os.PathLike)):
        allowed = "the path of an experiment file, or a mapping of parameter names to values"
        raise wrong_argument("experiment", allowed, repr(experiment))
    path = os.fspath(experiment)
    if not os.path.exists(path):
        raise FileNotFound(f"experiment: there is no file {path}")
    return path


def values_of(experiment: Experiment) -> dict[str, object]:
    """Returns the values of an experiment. A file may also contain a seed and a description."""
    if experiment is None or isinstance(experiment, Mapping):
        return dict(experiment or {})
    path = file_of(experiment)
    try:
        values = json.loads(input_file.read_input(path, "an experiment file", input_file.EXPERIMENT_BYTES_MAX)[0])
    except (OSError, ValueError) as error:
        raise InvalidArgument(f"experiment: {path}: {getattr(error, 'strerror', None) or error}") from None
    if not isinstance(values, dict):
        raise InvalidArgument(f"experiment: {path} contains no JSON object")
    return values


def write_json(path: str, values: Mapping[str, object]) -> str:
    """Writes a file with `json_text`; returns its path."""
    with open(path, "w", encoding="utf-8") as file:
        file.write(json_text(values))
    return path


def json_text(values: Mapping[str, object]) -> str:
    """Returns the text of a file that the program evod reads. NumPy numbers and arrays become JSON."""
    return json.dumps(dict(values), default=_json_value)


def _json_value(value: object) -> Any:
    if isinstance(value, (numpy.generic, numpy.ndarray)):
        return value.tolist()
    if isinstance(value, os.PathLike):
        return os.fspath(value)
    if isinstance(value, range):
        return list(value)
    raise wrong_argument("experiment", "numbers, text, true and false", repr(value))
