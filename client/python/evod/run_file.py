"""Run files as tables, without a server (docs/RUN_FILE.md)."""
from __future__ import annotations

import json
import os
import pathlib
import sqlite3
import subprocess
import urllib.parse
from typing import Any, Iterator, Mapping

import google.protobuf.json_format
import google.protobuf.message
import numpy
import numpy.typing

from evod import plotting
from evod.errors import DamagedData, Error
from evod.generations import ACCOUNT_PARTS
from evod.program import program_of
from evod.tables import GENE_NAMES, frame_of, pandas
from evod.v1 import commands_pb2

_CAUSES = ("alive", "starved", "poisoned")


def open_run(path: str | os.PathLike[str], *, program: str | os.PathLike[str] | None = None) -> RunFile:
    """Opens a run file, NAME.evod, also one that a server writes to. Nothing in it is changed.

    program   the program evod, for what it alone can tell: lineage(). Otherwise as of local().

    >>> import evod, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with evod.local(seed=42, data=folder) as lab:
    ...         last = lab.world().run(generations=3).wait()
    ...     with evod.open_run(folder + "/default.evod") as run:
    ...         run.seed, len(run.generations()), len(run.organisms())
    (42, 3, 150)
    """
    return RunFile(path, program=program)


class RunFile:
    """What a run file tells. Tables have the columns of `evod export`."""

    def __init__(self, path: str | os.PathLike[str], *, program: str | os.PathLike[str] | None = None) -> None:
        self.path = pathlib.Path(path)
        self._program = program
        if not self.path.is_file():
            raise Error(f"there is no run file {self.path}")
        # SQLite makes what it needs beside a file that was left in order; in a folder that cannot be written to it is told
        # that nobody else writes.
        address = f"file:{urllib.parse.quote(str(self.path.resolve()))}?mode=ro"
        if not os.access(self.path.resolve().parent, os.W_OK):
            address += "&immutable=1"
        self._database = sqlite3.connect(address, uri=True, check_same_thread=False)
        self._database.execute("PRAGMA trusted_schema = OFF")
        foreign: tuple[Any, ...] | None = None
        try:
            # A view in the place of a table could run without end.
            foreign = next(self._rows("SELECT type, name FROM sqlite_schema WHERE type NOT IN ('table', 'index')"), None)
            if foreign:
                raise DamagedData("")  # named below
            self.about: Mapping[str, str] = {key: value for key, value in self._rows("SELECT key, value FROM run")}
            self.name, self.run_id = self.about["name"], self.about["run_id"]
            self.seed = int(self.about["seed"])
        except (DamagedData, KeyError, ValueError):
            self._database.close()
            why = f"not as evod wrote it: it has the {foreign[0]} {foreign[1]!r}" if foreign else "no run file"
            raise DamagedData(f"{self.path} is {why}") from None

    def __repr__(self) -> str:
        return f"<run of {self.name} in {self.path}, seed {self.seed}, {self.last_generation} generations begun>"

    def __enter__(self) -> RunFile:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        self._database.close()

    # ---- what it began with ----------------------------------------------------------------------------------------

    @property
    def parameters(self) -> dict[str, Any]:
        """What the run began with."""
        return self._parameters_of(self.about["parameters"])

    @property
    def first_generation(self) -> int:
        return int(self.about["first_generation"])

    @property
    def last_generation(self) -> int:
        """The last one that has begun; it may have ended, and may not."""
        ((last,),) = self._rows("SELECT max(generation) FROM generation")
        return int(last or 0)

    @property
    def held(self) -> list[int]:
        """Generations whose organisms are in the file; large files hold fewer of the older ones."""
        return [row[0] for row in self._rows("SELECT DISTINCT generation FROM population ORDER BY generation")]

    def parameters_of(self, generation: int) -> dict[str, Any]:
        """Those that held when a generation began."""
        found = list(
            self._rows(
                "SELECT active FROM parameters JOIN generation ON parameters.number = generation.parameters "
                "WHERE generation.generation = ?",
                generation,
            )
        )
        if not found:
            raise self._no_such(generation)
        return self._parameters_of(found[0][0])

    # ---- tables ----------------------------------------------------------------------------------------------------

    def generations(self) -> Any:
        """The statistics: a row for each generation that has ended, and island."""
        accounts = [f"{gene}_{part}" for gene in GENE_NAMES for part in ACCOUNT_PARTS]
        if list(self._rows("SELECT 1 FROM sqlite_schema WHERE name = 'selection_account'")):
            columns, join = accounts, "LEFT JOIN selection_account USING (generation, island)"
        else:  # an older file
            columns, join = [f"NULL AS {name}" for name in accounts], ""
        cursor = self._execute(
            f"SELECT statistics.*, {', '.join(columns)} FROM statistics {join} ORDER BY generation, island"
        )
        names = [column[0] for column in cursor.description]
        table = pandas().DataFrame(self._fetch(cursor), columns=names).drop(columns="checksum")
        return table.astype({name: float for name in accounts})

    def organisms(self) -> Any:
        """Parents, genes and fate of each organism of the generations that are held."""
        simulated_s = {
            (generation, island): seconds
            for generation, island, seconds in self._rows("SELECT generation, island, simulated_s FROM statistics")
        }
        tick_s = {
            generation: float(self._parameters_of(active)["tick_s"])
            for generation, active in self._rows(
                "SELECT generation, active FROM generation JOIN parameters ON parameters.number = generation.parameters"
            )
        }
        rows = self._rows(
            "SELECT generation, island, organism_count, elite_count, survivor_count, chromosomes, parents, fitness, "
            "lived_ticks, cause FROM population LEFT JOIN outcome USING (generation, island) ORDER BY generation, island"
        )
        parts = []
        for generation, island, count, elite, survivors, genes, parents, fitness, lived_ticks, cause in rows:
            begun = _organisms(count, elite, survivors, genes, parents)
            lived: Mapping[str, Any]
            if fitness is None:
                lived = {"fitness": numpy.nan, "lived_s": numpy.nan, "cause": numpy.full(count, None)}
            else:
                causes = _array(cause, "u1", count)
                ticks = _array(lived_ticks, "<u4", count)
                to_the_end = simulated_s.get((generation, island), numpy.nan)
                lived = {
                    "fitness": _array(fitness, "<f8", count),
                    "lived_s": numpy.where(causes == 0, to_the_end, ticks * tick_s[generation]),
                    "cause": numpy.array((*_CAUSES, "unknown"), object)[numpy.minimum(causes, len(_CAUSES))],
                }
            place = {"generation": generation, "island": island, "organism": numpy.arange(count)}
            parts.append(pandas().DataFrame({**place, **begun, **lived}))
        return pandas().concat(parts, ignore_index=True)

    def population(self, generation: int | None = None) -> Any:
        """The genes of one generation, otherwise of the last that has begun; another world can begin with them."""
        parts = []
        for island, genes in enumerate(self.genes(generation)):
            columns = dict(zip(GENE_NAMES, genes.T))
            parts.append(pandas().DataFrame({"island": island, "organism": numpy.arange(len(genes)), **columns}))
        return pandas().concat(parts, ignore_index=True)

    def genes(self, generation: int | None = None) -> list[numpy.typing.NDArray[numpy.float32]]:
        """The same as arrays: of each island one of shape (population_size, 6).

        >>> import evod, tempfile
        >>> with tempfile.TemporaryDirectory() as folder:
        ...     with evod.local(data=folder) as lab:
        ...         last = lab.world().run(generations=1).wait()
        ...     with evod.open_run(folder + "/default.evod") as run:
        ...         run.genes(1)[0].shape
        (50, 6)
        """
        number = self.last_generation if generation is None else generation
        rows = self._rows(
            "SELECT organism_count, chromosomes FROM population WHERE generation = ? ORDER BY island", number
        )
        islands = [_array(genes, "<f4", count * len(GENE_NAMES)).reshape(count, -1) for count, genes in rows]
        if not islands:
            raise self._no_such(number)
        return islands

    def events(self) -> Any:
        """The journal: the commands that were applied, each request as JSON."""
        rows = []
        for number, tick, client, data in self._rows("SELECT number, tick, client, request FROM journal ORDER BY number"):
            try:
                request = commands_pb2.Request.FromString(data)
            except google.protobuf.message.DecodeError:
                raise DamagedData(f"{self.path} is damaged: entry {number} of its journal is no request") from None
            request.ClearField("client_key")
            request.ClearField("request_id")
            told = google.protobuf.json_format.MessageToJson(request, preserving_proto_field_name=True, indent=None)
            kind = request.WhichOneof("kind") or "unknown"
            rows.append((number, tick, client, kind, told))
        names = ("number", "tick", "client", "kind", "request")
        return pandas().DataFrame(rows, columns=names)

    def lineage(self, of: tuple[int, int, int] | None = None) -> Any:
        """Who came of whom, over islands too; of: one organism (generation, island, id) and its ancestors, newest first.

        The program evod works it out, as migrants and generations that are not held are not told in the file.
        """
        which = [] if of is None else ["--of", ":".join(map(str, of))]
        command = [program_of(self._program), "export", str(self.path), "--what", "lineage", *which]
        done = subprocess.run(command, capture_output=True, text=True, errors="replace")
        if done.returncode != 0:
            raise Error(done.stderr.strip().removeprefix("evod: ") or "evod export failed")
        return frame_of(done.stdout)

    # ---- pictures --------------------------------------------------------------------------------------------------

    def plot_fitness(self, ax: Any = None) -> Any:
        """Draws the best and the mean fitness of each generation with matplotlib; returns the axes."""
        return plotting.plot_fitness(self.generations(), ax)

    def plot_genes(self, ax: Any = None) -> Any:
        """Draws the mean and the spread of each gene."""
        return plotting.plot_genes(self.generations(), GENE_NAMES, ax)

    def plot_selection(self, gene: str, ax: Any = None) -> Any:
        """Draws what moved the mean of a gene: selection, transmission, migration, and its change, which they make together."""
        return plotting.plot_selection(self.generations(), GENE_NAMES, gene, ax)

    def plot_lineage(self, of: tuple[int, int, int] | None = None, ax: Any = None) -> Any:
        """Draws who came of whom; of: one organism (generation, island, id) and its ancestors."""
        return plotting.plot_lineage(self.lineage(of), ax)

    # ---- within ----------------------------------------------------------------------------------------------------

    def _rows(self, query: str, *values: object) -> Iterator[tuple[Any, ...]]:
        return iter(self._fetch(self._execute(query, *values)))

    def _execute(self, query: str, *values: object) -> sqlite3.Cursor:
        try:
            return self._database.execute(query, values)
        except sqlite3.DatabaseError as error:
            raise DamagedData(f"{self.path} cannot be read: {error}") from None

    def _fetch(self, cursor: sqlite3.Cursor) -> list[tuple[Any, ...]]:
        try:
            return cursor.fetchall()
        except sqlite3.DatabaseError as error:
            raise DamagedData(f"{self.path} cannot be read: {error}") from None

    def _parameters_of(self, text: str) -> dict[str, Any]:
        try:
            parameters = json.loads(text)
        except ValueError:
            raise DamagedData(f"{self.path} is damaged: its parameters cannot be read") from None
        return {name: value for name, value in parameters.items() if name not in ("seed", "description")}

    def _no_such(self, generation: int) -> Error:
        held = self.held
        if self.first_generation <= generation <= self.last_generation:
            return Error(
                f"{self.path} does not hold the organisms of generation {generation} any more: `evod export` simulates it again"
            )
        told = f"{held[0]} to {held[-1]}" if held else "none"
        return Error(f"{self.path} does not tell of generation {generation}: there are {told}")


def _array(data: bytes, kind: str, count: int) -> numpy.typing.NDArray[Any]:
    if len(data) != count * numpy.dtype(kind).itemsize:
        raise DamagedData(f"the run file is damaged: {len(data)} bytes for {count} numbers")
    return numpy.frombuffer(data, kind)


def _organisms(count: int, elite: int, survivors: int, genes: bytes, parents: bytes) -> dict[str, Any]:
    """How they began."""
    chromosomes = _array(genes, "<f4", count * len(GENE_NAMES)).reshape(count, -1)
    if parents:
        first, second = _array(parents, "<u4", 2 * count).reshape(count, 2).T.astype(float)
        ids = numpy.arange(count)
        origin = numpy.where(ids < elite, "elite", numpy.where(ids < survivors, "survivor", "child")).astype(object)
    else:
        first = second = numpy.full(count, numpy.nan)
        origin = numpy.full(count, "initial", object)
    return {"parent_first": first, "parent_second": second, "origin": origin, **dict(zip(GENE_NAMES, chromosomes.T))}
