"""Reads run files as pandas tables and numpy arrays, without a server (docs/RUN_FILE.md).

RunFile has more than 30 members: each table of the file is one of them, and a script finds it by its name.
"""
from __future__ import annotations

import json
import os
import pathlib
import shutil
import sqlite3
import urllib.parse
import weakref
from typing import Any, Iterator, Mapping, Sequence

import google.protobuf.json_format
import google.protobuf.message
import numpy
import numpy.typing

from evod import plotting
from evod.errors import DamagedData, FileNotFound, NotFound
from evod.program import Program, find_program
from evod.genes import ACCOUNT_PARTS, GENE_NAMES, GeneNames, Genes
from evod.tables import html_table, pandas, read_csv
from evod.v1 import commands_pb2

_CAUSES = ("alive", "starved", "poisoned")
_SENT_BY_SERVER = 2  # in the column sender of the journal


def open_run(path: str | os.PathLike[str], *, program: str | os.PathLike[str] | None = None) -> RunFile:
    """Opens a run file, NAME.evod, for reading only. A server may write to it at the same time.

    Parameters
    ----------
    path
        The run file.
    program
        Path of the program evod, which `RunFile.lineage` runs. By default the program that `evod.local` starts.

    Raises
    ------
    FileNotFound
        The file does not exist.
    DamagedData
        The file is not a run file, or is damaged.

    Examples
    --------
    >>> import evod, tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     with evod.local(seed=42, data=folder) as lab:
    ...         last = lab.world().run(generations=3).wait()
    ...     with evod.open_run(folder + "/default.evod") as run:
    ...         run.seed, len(run.generations()), len(run.organisms())
    (42, 3, 150)
    """
    return RunFile(path, program=program)


def _remove(folder: str, process: int) -> None:
    """Deletes a folder, but not in a process that was forked from the one that uses it."""
    if os.getpid() == process:
        shutil.rmtree(folder, ignore_errors=True)


class RunFile:
    """An open run file, returned by `open_run` and `evod.run`. Its tables have the same columns as those of `evod
    export`.

    All methods raise DamagedData if the file is damaged.
    """

    def __init__(
        self, path: str | os.PathLike[str], *, program: str | os.PathLike[str] | None = None,
                 temporary: str | None = None
    ) -> None:
        self.path = pathlib.Path(path)
        self._program = program
        # Deletes the folder `temporary`, if there is one, when the file is closed or garbage collected.
        self._clean_up = weakref.finalize(self, _remove, temporary, os.getpid()) if temporary is not None else None
        if not self.path.is_file():
            raise FileNotFound(f"there is no run file {self.path}")
        # SQLite creates its shared memory file next to the run file, which fails in a read-only folder. No server can
        # write to a run file in such a folder, so the option `immutable` lets SQLite read without the shared memory
        # file.
        address = f"file:{urllib.parse.quote(str(self.path.resolve()))}?mode=ro"
        if not os.access(self.path.resolve().parent, os.W_OK):
            address += "&immutable=1"
        self._database = sqlite3.connect(address, uri=True, check_same_thread=False)
        self._database.execute("PRAGMA trusted_schema = OFF")
        foreign: tuple[Any, ...] | None = None
        try:
            # A damaged or malicious file could contain a view in place of a table, with a query that never ends.
            foreign = next(self._rows("SELECT type, name FROM sqlite_schema WHERE type NOT IN ('table', 'index')"),
                           None)
            if foreign:
                raise DamagedData("")  # the handler below adds the name of the file
            self.about: Mapping[str, str] = {key: value for key, value in self._rows("SELECT key, value FROM run")}
            self.name, self.run_id = self.about["name"], self.about["run_id"]
            self.seed = int(self.about["seed"])
        except (DamagedData, KeyError, ValueError):
            self._database.close()
            why = f"not as evod wrote it: it contains the {foreign[0]} {foreign[1]!r}" if foreign else "not a run file"
            raise DamagedData(f"{self.path} is {why}") from None

    def __repr__(self) -> str:
        return f"<run of {self.name} in {self.path}, seed {self.seed}, {self.last_generation} generations begun>"

    def _repr_html_(self) -> str:
        fields = {"seed": self.seed, "run_id": self.run_id, "generations begun": self.last_generation,
                  "file": self.path}
        return html_table((), fields.items(), f"run of {self.name}")

    def __enter__(self) -> RunFile:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def close(self) -> None:
        """Closes the file. The file of `evod.run` is then deleted."""
        self._database.close()
        if self._clean_up is not None:
            self._clean_up()

    # ---- the run --------------------------------------------------------------------------------------------------

    @property
    def parameters(self) -> dict[str, Any]:
        """The parameters at the beginning of the run, by name."""
        return self._parameters_of(self.about["parameters"])

    @property
    def gene_names(self) -> GeneNames:
        """The names of the genes, in the order of all arrays."""
        names = self.about.get("gene_names", ",".join(GENE_NAMES)).split(",")
        listed = self.parameters.get("free_genes")
        return GeneNames(names, {gene["name"]: gene["choices"] for gene in listed if "choices" in gene}
                         if isinstance(listed, list) else {})

    @property
    def first_generation(self) -> int:
        """The first generation in the file: 1, or the generation at which the run was forked."""
        return int(self.about["first_generation"])

    @property
    def last_generation(self) -> int:
        """The last generation that has begun. It may not have ended yet."""
        ((last,),) = self._rows("SELECT max(generation) FROM generation")
        return int(last or 0)

    @property
    def retained_generations(self) -> list[int]:
        """The generations whose organisms are in the file. The retention rule of the run has purged all other
        generations."""
        return [row[0] for row in self._rows("SELECT DISTINCT generation FROM population ORDER BY generation")]

    def parameters_of(self, generation: int) -> dict[str, Any]:
        """The parameters at the beginning of a generation, by name."""
        found = list(
            self._rows(
                "SELECT active FROM parameters JOIN generation ON parameters.number = generation.parameters "
                "WHERE generation.generation = ?",
                generation,
            )
        )
        if not found:
            raise self._missing(generation)
        return self._parameters_of(found[0][0])

    # ---- tables ----------------------------------------------------------------------------------------------------

    def generations(self) -> Any:
        """Returns the statistics of all ended generations as a DataFrame, with one row per generation and island."""
        body_accounts = [f"{gene}_{part}" for gene in GENE_NAMES for part in ACCOUNT_PARTS]
        if list(self._rows("SELECT 1 FROM sqlite_schema WHERE name = 'selection_account'")):
            columns, join = body_accounts, "LEFT JOIN selection_account USING (generation, island)"
        else:  # the file has format 3 or older
            columns, join = [f"NULL AS {name}" for name in body_accounts], ""
        cursor = self._execute(
            f"SELECT statistics.*, {', '.join(columns)} FROM statistics {join} ORDER BY generation, island"
        )
        names = [column[0] for column in cursor.description]
        table = pandas().DataFrame(self._fetch(cursor), columns=names).drop(columns="checksum")
        table = table.astype({name: float for name in body_accounts})
        return self._with_more_genes(table) if self.gene_names != GENE_NAMES else table

    def organisms(self) -> Any:
        """Returns all organisms of the retained generations as a DataFrame: origin, parents, genes, fitness and
        fate."""
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
            "lived_ticks, cause FROM population LEFT JOIN outcome USING (generation, island) ORDER BY generation, "
            "island"
        )
        parts = []
        for generation, island, count, elite, survivors, genes, parents, fitness, lived_ticks, cause in rows:
            begun = _organisms(count, elite, survivors, genes, parents, self.gene_names)
            lived: Mapping[str, Any]
            if fitness is None:
                lived = {"fitness": numpy.nan, "lived_s": numpy.nan, "cause": numpy.full(count, None)}
            else:
                causes = _array(cause, "u1", count)
                ticks = _array(lived_ticks, "<u4", count)
                whole_s = simulated_s.get((generation, island), numpy.nan)
                lived = {
                    "fitness": _array(fitness, "<f8", count),
                    "lived_s": numpy.where(causes == 0, whole_s, ticks * tick_s[generation]),
                    "cause": numpy.array((*_CAUSES, "unknown"), object)[numpy.minimum(causes, len(_CAUSES))],
                }
            identity = {"generation": generation, "island": island, "organism": numpy.arange(count)}
            parts.append(pandas().DataFrame({**identity, **begun, **lived}))
        return pandas().concat(parts, ignore_index=True).astype({"parent_first": "Int64", "parent_second": "Int64"})

    def population(self, generation: int | None = None) -> Any:
        """Returns the genes of a generation as a DataFrame; by default, of the last generation that has begun."""
        parts = []
        for island, genes in enumerate(self.genes(generation)):
            columns = {"island": island, "organism": numpy.arange(len(genes)), **genes.to_texts()}
            parts.append(pandas().DataFrame(columns))
        return pandas().concat(parts, ignore_index=True)

    def genes(self, generation: int | None = None) -> list[Genes]:
        """Returns the genes of a generation as arrays, for the argument `population` of `Lab.create_world`.

        Returns
        -------
        list of Genes
            One array for each island, with shape (population_size, genes) and columns in the order of `gene_names`.

        Examples
        --------
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
        names = self.gene_names
        islands = [Genes(_array(genes, "<f4", count * len(names)).reshape(count, -1), names) for count, genes in rows]
        if not islands:
            raise self._missing(number)
        return islands

    def events(self) -> Any:
        """Returns the journal as a DataFrame: the applied commands, with each request as JSON."""
        rows = []
        columns = "number, tick, sender, user, program, address, request"
        for *sent, data in self._rows(f"SELECT {columns} FROM journal ORDER BY number"):
            number, tick, sender, *who = sent
            try:
                request = commands_pb2.Request.FromString(data)
            except google.protobuf.message.DecodeError:
                raise DamagedData(f"{self.path} is damaged: entry {number} of its journal cannot be read") from None
            request.ClearField("client_key")
            request.ClearField("request_id")
            text = google.protobuf.json_format.MessageToJson(request, preserving_proto_field_name=True, indent=None)
            kind = request.WhichOneof("kind") or "unknown"
            rows.append((number, tick, "server" if sender == _SENT_BY_SERVER else "client", *who, kind, text))
        names = ("number", "tick", "sender", "user", "program", "address", "kind", "request")
        return pandas().DataFrame(rows, columns=names)

    def notes(self) -> Any:
        """Returns the notes in the journal as a DataFrame: number, tick, generation, sender, user, kind and text.

        Runs the program evod.
        """
        return read_csv(Program([find_program(self._program), "export", str(self.path), "--what", "notes"]).run())

    def lineage(self, of: tuple[int, int, int] | None = None) -> Any:
        """Returns the parents of every organism on all islands as a DataFrame, the newest generation first.

        Runs the program evod, which replays the run, because the file does not contain migrants and purged generations.

        Parameters
        ----------
        of
            An organism as (generation, island, id). If it is given, the table contains only the ancestors of this
            organism.
        """
        which = [] if of is None else ["--of", ":".join(map(str, of))]
        command = [find_program(self._program), "export", str(self.path), "--what", "lineage", *which]
        return read_csv(Program(command).run())

    # ---- plots ----------------------------------------------------------------------------------------------------

    def plot_fitness(self, ax: Any = None) -> Any:
        """Plots the best and the mean fitness of each generation with matplotlib; returns the axes."""
        return plotting.plot_fitness(self.generations(), ax)

    def plot_genes(self, ax: Any = None) -> Any:
        """Plots the mean and the standard deviation of each gene; returns the axes."""
        return plotting.plot_genes(self.generations(), self.gene_names, ax)

    def plot_selection(self, gene: str, ax: Any = None) -> Any:
        """Plots how selection, transmission and migration changed the mean of a gene in each generation; returns the
        axes."""
        return plotting.plot_selection(self.generations(), self.gene_names, gene, ax)

    def plot_lineage(self, of: tuple[int, int, int] | None = None, ax: Any = None) -> Any:
        """Plots the table that `lineage` returns for the same argument `of`; returns the axes."""
        return plotting.plot_lineage(self.lineage(of), ax)

    # ---- private --------------------------------------------------------------------------------------------------

    def _with_more_genes(self, table: Any) -> Any:
        """Adds the statistics of the genes beyond those of the body. Removes those of the body if the run has none."""
        has_body_genes = self.gene_names[: len(GENE_NAMES)] == GENE_NAMES
        names = self.gene_names[len(GENE_NAMES) :] if has_body_genes else self.gene_names
        rows = self._rows(
            "SELECT more_genes.statistics, account FROM more_genes JOIN statistics USING (generation, island) "
            "ORDER BY generation, island"
        )
        statistics, accounts = [], []
        for of_island, account in rows:
            statistics.append(_array(of_island, "<f8", 4 * len(names)))
            accounts.append(_array(account, "<f8", 4 * len(names)) if account
                            else numpy.full(4 * len(names), numpy.nan))
        parts = {"statistics": (statistics, ("mean", "deviation", "min", "max")), "account": (accounts, ACCOUNT_PARTS)}
        more = {
            part: pandas().DataFrame(
                numpy.array(values).reshape(-1, 4 * len(names)),
                columns=[f"{gene}_{column}" for gene in names for column in columns],
            )
            for part, (values, columns) in parts.items()
        }
        first_account = table.columns.get_loc(f"{GENE_NAMES[0]}_{ACCOUNT_PARTS[0]}")
        of_body = (table.iloc[:, :first_account], table.iloc[:, first_account:])
        if not has_body_genes:
            of_body = (table.iloc[:, : table.columns.get_loc(f"{GENE_NAMES[0]}_mean")], table.iloc[:, :0])
        return pandas().concat((of_body[0], more["statistics"], of_body[1], more["account"]), axis=1)

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

    def _missing(self, generation: int) -> NotFound:
        retained = self.retained_generations
        if self.first_generation <= generation <= self.last_generation:
            return NotFound(
                f"{self.path} no longer contains the organisms of generation {generation}: `evod export` simulates it "
                "again"
            )
        allowed = f"{retained[0]} to {retained[-1]}" if retained else "none"
        return NotFound(f"generation: got {generation}, allowed in {self.path}: {allowed}")


def _array(data: bytes, kind: str, count: int) -> numpy.typing.NDArray[Any]:
    if len(data) != count * numpy.dtype(kind).itemsize:
        raise DamagedData(f"the run file is damaged: {len(data)} bytes for {count} numbers")
    return numpy.frombuffer(data, kind)


def _organisms(
    count: int, elite: int, survivors: int, genes: bytes, parents: bytes, gene_names: GeneNames
) -> dict[str, Any]:
    """Returns those columns of a population that are known when its generation begins."""
    chromosomes = _array(genes, "<f4", count * len(gene_names)).reshape(count, -1)
    if parents:
        first, second = _array(parents, "<u4", 2 * count).reshape(count, 2).T.astype(float)
        ids = numpy.arange(count)
        origin = numpy.where(ids < elite, "elite", numpy.where(ids < survivors, "survivor", "child")).astype(object)
    else:
        first = second = numpy.full(count, numpy.nan)
        origin = numpy.full(count, "initial", object)
    columns = Genes(chromosomes, gene_names).to_texts()
    return {"parent_first": first, "parent_second": second, "origin": origin, **columns}
