"""Genes as arrays with names."""
from __future__ import annotations

from typing import Any, Iterable, Iterator, Mapping, Sequence, SupportsIndex, TypeVar, overload

import numpy

T = TypeVar("T")

GENE_NAMES = ("normal_speed", "impulse", "body_size", "base_health", "food_radius", "poison_radius")
#: The parts of the change of a gene's mean, as `Generation.selection` and the columns of tables name them.
ACCOUNT_PARTS = ("selection", "transmission", "migration", "change")


class Real(dict[str, Any]):
    """A real number in the list of the free genes: `evod.genes.Real("rate", 0.001, 1, scale="logarithmic")`.

    Parameters
    ----------
    name
        The name of the gene: letters, digits and _.
    min, max
        Its bounds, both included.
    step
        The values are `min`, `min + step`, and so on. By default all values between the bounds.
    scale
        "linear", or "logarithmic" for a gene whose factors matter; its bounds must be above 0.
    mutation_step
        The size of a creep mutation. By default the parameter free_mutation_step, as a share of the range.
    """

    def __init__(self, name: str, min: float = 0, max: float = 1, *, step: float = 0, scale: str = "linear",
                 mutation_step: float = 0) -> None:
        super().__init__(name=name, min=float(min), max=float(max))
        self.update({key: value for key, value, default in (("step", step, 0), ("scale", scale, "linear"),
                                                            ("mutation_step", mutation_step, 0)) if value != default})


class Integer(Real):
    """A whole number in the list of the free genes, within ±2**24: `evod.genes.Integer("layers", 1, 8)`."""

    def __init__(self, name: str, min: int, max: int, *, step: int = 1, mutation_step: float = 0) -> None:
        super().__init__(name, min, max, step=step, mutation_step=mutation_step)


class Choice(dict[str, Any]):
    """One of several values in the list of the free genes: `evod.genes.Choice("material", ["steel", "wood"])`.

    The gene is the index of the choice, from 0. Tables contain the choice."""

    def __init__(self, name: str, choices: Iterable[object]) -> None:
        super().__init__(name=name, choices=[str(choice) for choice in choices])


class Permutation(dict[str, Any]):
    """`count` genes in the list of the free genes that contain 0, 1, … count − 1 in any order, with the names NAME0,
    NAME1, and so on: `evod.genes.Permutation("tour", 32)`. The parameter rearranging mutates them."""

    def __init__(self, name: str, count: int) -> None:
        super().__init__(name=name, permutation=count)


class GeneNames(tuple[str, ...]):
    """The names of the genes of a chromosome."""

    choices: Mapping[str, Sequence[str]]  #: the choices of genes that contain the index of one, by name

    def __new__(cls, names: Iterable[str], choices: Mapping[str, Sequence[str]] | None = None) -> GeneNames:
        made = tuple.__new__(cls, names)
        made.choices = getattr(names, "choices", {}) if choices is None else choices
        return made

    def text(self, name: str, value: Any) -> Any:
        """Returns the choice whose index a gene contains; the value if it is not an index of a choice."""
        choices = self.choices.get(name, ())
        return choices[int(value)] if 0 <= value < len(choices) and value == int(value) else value

    def value(self, name: str, text: Any) -> float:
        """Returns the gene for the text of a choice or for a number. A choice has precedence over an index as text."""
        choices = self.choices.get(name, ())
        return float(choices.index(text) if isinstance(text, str) and text in choices else text)


class Genes(numpy.ndarray[Any, numpy.dtype[Any]]):
    """An array of genes, shape (genes,) or (count, genes), that can also be indexed with the name of a gene.

    A chromosome has the six genes of the body, `evod.GENE_NAMES`; the weights of a network and free genes may follow.
    Without bodies, it consists of the free genes if there are any.

    Rows of a Genes array are Genes arrays. Results of calculations are arrays without names.

    Examples
    --------
    >>> import evod
    >>> with evod.local(seed=1) as lab:
    ...     genes = lab.world().population().genes
    >>> genes.shape, genes["body_size"].shape
    ((50, 6), (50,))
    >>> bool(genes[0]["body_size"] == genes["body_size"][0])
    True
    >>> genes[0].to_dict().keys() == set(evod.GENE_NAMES)
    True
    """

    names: GeneNames | None  #: the names of the last axis; None for the results of calculations

    def __new__(cls, values: Any, names: Iterable[str] = GENE_NAMES) -> Genes:
        genes = numpy.asarray(values).view(cls)
        genes.names = GeneNames(names)
        if genes.shape[-1:] != (len(genes.names),):
            raise ValueError(f"values: got the shape {genes.shape}, allowed (…, {len(genes.names)}): one column for "
                             "each name")
        return genes

    def __array_finalize__(self, template: Any) -> None:
        self.names = None

    def __array_ufunc__(self, ufunc: Any, method: str, *inputs: Any, **options: Any) -> Any:
        targets = options.get("out", ())
        if targets:
            options["out"] = tuple(_plain(array) for array in targets)
        result = getattr(ufunc, method)(*(_plain(array) for array in inputs), **options)
        return targets[0] if len(targets) == 1 else result

    def __getitem__(self, key: Any) -> Any:
        plain = _plain(self)
        if isinstance(key, str):
            if self.names is None or key not in self.names:
                raise KeyError(f"there is no gene {key!r}; the genes are: {', '.join(self.names or ()) or 'not named'}")
            return plain[..., self.names.index(key)]
        found = plain[key]
        is_index = isinstance(key, (slice, int, numpy.integer))
        selects_rows = is_index or isinstance(key, (list, numpy.ndarray)) and numpy.ndim(key) == 1
        return Genes(found, self.names) if self.names is not None and self.ndim > 1 and selects_rows else found

    def __reduce__(self) -> Any:
        return (numpy.asarray(_plain(self)).__reduce__() if self.names is None else (Genes, (_plain(self), self.names)))

    def copy(self, order: Any = "C") -> Genes:
        """Returns a copy with the same names, which may be changed."""
        made = super().copy(order)
        made.names = self.names
        return made

    def to_dict(self) -> dict[str, Any]:
        """Returns the values by name: numbers, or arrays of shape (count,)."""
        return {name: self[name] for name in self.names or ()}

    def to_texts(self) -> dict[str, Any]:
        """Returns the values by name as tables contain them: like `to_dict`, but with the text of each choice."""
        names = self.names or GeneNames(())
        return {name: names.text(name, values) if numpy.ndim(values) == 0
                else numpy.array([names.text(name, value) for value in values], object)
                if name in names.choices else values for name, values in self.to_dict().items()}

    def __repr__(self) -> str:
        if self.names is None or self.ndim != 1:
            return repr(_plain(self)).replace("array", "Genes", 1)
        return f"<genes {self.text()}>"

    def text(self) -> str:
        """Returns the genes of one organism: "rate 0.25, material steel"."""
        return ", ".join(f"{name} {value if isinstance(value, str) else format(value, '.4g')}"
                         for name, value in self.to_texts().items())

    __str__ = __repr__


def _plain(array: Any) -> Any:
    return array.view(numpy.ndarray) if isinstance(array, Genes) else array


class ByGene(Sequence[T]):
    """A sequence with one element for each gene, in the order of `names`, that can also be indexed with a name.

    The elements are made when the first one is read, because a generation of many genes has many numbers.
    """

    names: GeneNames  #: the names of the genes

    def __init__(self, items: Iterable[T], names: Iterable[str] = GENE_NAMES) -> None:
        self.names = GeneNames(names)
        self._unread: Iterable[T] | None = items
        self._items: tuple[T, ...] = ()

    def _read(self) -> tuple[T, ...]:
        unread = self._unread
        if unread is not None:
            self._items, self._unread = tuple(unread), None
        return self._items

    def __len__(self) -> int:
        return len(self._read())

    def __iter__(self) -> Iterator[T]:
        return iter(self._read())

    def __eq__(self, other: object) -> bool:
        return self._read() == (other._read() if isinstance(other, ByGene) else other)

    def __hash__(self) -> int:
        return hash(self._read())

    def __repr__(self) -> str:
        return repr(self._read())

    def __reduce__(self) -> Any:
        return ByGene, (self._read(), self.names)

    @overload
    def __getitem__(self, key: SupportsIndex | str) -> T: ...
    @overload
    def __getitem__(self, key: slice) -> tuple[T, ...]: ...
    def __getitem__(self, key: Any) -> Any:
        if isinstance(key, str):
            if key not in self.names:
                raise KeyError(f"there is no gene {key!r}; the genes are: {', '.join(self.names)}")
            return self._read()[self.names.index(key)]
        return self._read()[key]
