"""Converts messages of the protocol to the dataclasses and enums of results.py."""
from __future__ import annotations

import dataclasses
import functools
from typing import Any, Callable, Iterator, Mapping, Sequence

import google.protobuf.descriptor
import google.protobuf.message
import numpy

from evod.genes import GENE_NAMES, ByGene, Genes
from evod.parameters import value_of
from evod.results import CLASSES, STATES


def _genes(values: Sequence[float], names: Sequence[str]) -> Genes:
    return Genes(numpy.array(values or [numpy.nan] * len(names), numpy.float32), names)


def _activations(values: Sequence[float]) -> Any:
    return numpy.array(values, numpy.float32)


class _Results:
    """The results of messages, each converted when it is read."""

    def __init__(self, messages: Sequence[Any]) -> None:
        self._messages = messages

    def __iter__(self) -> Iterator[Any]:
        return map(result, self._messages)


_OF_GENES: Mapping[str, Callable[[Any, Sequence[str]], Any]] = {
    "GenerationStatistics.genes": lambda genes, names: ByGene(_Results(genes), names),
    "OrganismInfo.genes": _genes,
    "Descendant.genes": _genes,
    "Descendant.first_genes": _genes,
    "Descendant.second_genes": _genes,
}
_SPECIAL: Mapping[str, Callable[[Any], Any]] = {
    "Speed": lambda speed: "max" if speed.max else speed.real_time_factor,
    "Brain.inputs": _activations,
    "Brain.hidden": _activations,
    "Brain.outputs": _activations,
    "ClassInfo.ranges": lambda quota: {range.parameter: (range.min, range.max) for range in quota.ranges},
    "Breeding.parameters": lambda assigned: {assignment.name: value_of(assignment.value) for assignment in assigned},
}


def result(message: google.protobuf.message.Message, gene_names: Sequence[str] = GENE_NAMES) -> Any:
    """Converts a message of the protocol to the dataclass of the same name. `gene_names` are those of the message's
    world."""
    make, fields = _converters(message.DESCRIPTOR)
    return make(*(convert(message, gene_names) for convert in fields))


_Converter = Callable[[google.protobuf.message.Message, Sequence[str]], Any]


@functools.lru_cache(maxsize=None)
def _converters(message: google.protobuf.descriptor.Descriptor) -> tuple[type[Any], tuple[_Converter, ...]]:
    result_class = CLASSES[message.name]
    fields = dataclasses.fields(result_class)
    return result_class, tuple(_converter(message.fields_by_name[field.name.removesuffix("_")]) for field in fields)


def _from_second(descendant: Any, names: Sequence[str]) -> int:
    words = (descendant.from_second, *descendant.more_from_second)
    return sum(word << 32 * index for index, word in enumerate(words))


def _of_message(name: str) -> _Converter:
    if name not in _SPECIAL:
        return result
    special = _SPECIAL[name]
    return lambda message, names: special(message)


def _converter(field: google.protobuf.descriptor.FieldDescriptor) -> _Converter:
    name = field.name
    full_name = f"{field.containing_type.name}.{name}"
    if full_name == "Descendant.from_second":
        return _from_second
    if full_name in _OF_GENES:
        convert_genes = _OF_GENES[full_name]
        return lambda message, names: convert_genes(getattr(message, name), names)
    # Newer versions of protobuf have is_repeated in place of label.
    is_repeated = field.is_repeated if hasattr(field, "is_repeated") else field.label == field.LABEL_REPEATED
    is_optional = field.has_presence and not is_repeated
    convert = _SPECIAL.get(full_name)
    if field.enum_type is not None:
        state = STATES[field.enum_type.name]
        if is_repeated:
            convert = lambda numbers: tuple(state(number) for number in numbers)
        else:
            convert = lambda number: state(number) if number else None
    elif convert is None and field.message_type is not None:
        of_item: _Converter = _of_message(field.message_type.name)
        if is_repeated:
            return lambda message, names: tuple(of_item(item, names) for item in getattr(message, name))
        if is_optional:
            return lambda message, names: of_item(getattr(message, name), names) if message.HasField(name) else None
        return lambda message, names: of_item(getattr(message, name), names)
    elif convert is None and is_repeated:
        convert = tuple
    if is_optional:
        present = convert
        return lambda message, names: (
            (present(getattr(message, name)) if present else getattr(message, name)) if message.HasField(name) else None
        )
    if convert is None:
        return lambda message, names: getattr(message, name)
    always = convert
    return lambda message, names: always(getattr(message, name))
