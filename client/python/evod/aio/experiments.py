"""Whole experiments in one call: a run, a parameter sweep, a comparison. evod.experiments is generated from this file.

The program evod computes tables of runs, sweeps and comparisons (`evod run`, `evod sweep`, `evod compare`).
"""
from __future__ import annotations

import concurrent.futures
import os
import pathlib
import shutil
import tempfile
from typing import Any, Callable, Mapping, Sequence, Union

import numpy.typing

from evod.aio.connection import local
from evod.aio.link import blocking_call
from evod.comparisons import ComparedWorld, Comparison, Difference, comparison_of
from evod.errors import InvalidArgument, wrong_argument
from evod.executor_sweep import ExecutorSweep, Plan, plan_command
from evod.experiment import Experiment, file_of, json_text, values_of, with_parameters, write_json
from evod.function_runs import FunctionComparison, FunctionSweep, seeds_in, stand_in
from evod.program import Program, find_program, result_in
from evod.progress import progress_bar
from evod.run_file import RunFile
from evod.sweeps import Sweep
from evod.tables import read_csv

# ---- one run
# ----------------------------------------------------------------------------------------------------------


async def run(
    experiment: Experiment = None,
    *,
    seed: int | None = None,
    generations: int | None = None,
    threads: int | None = None,
    program: str | os.PathLike[str] | None = None,
    progress: bool | None = None,
    **parameters: object,
) -> RunFile:
    """Runs an experiment at full speed and returns the complete run.

    Parameters
    ----------
    experiment
        An experiment file, or a mapping of parameter names to values. By default all parameters have their default
        values.
    seed
        Seed of the run, 0 to 2**64 - 1. By default the seed in the experiment file, or a random seed.
    generations
        The number of generations. By default a termination criterion of the experiment ends the run.
    threads
        Number of threads for the simulation. By default one for each processor.
    program
        Path of the program evod. By default the path in the environment variable EVOD, or else the evod found in PATH.
    progress
        Whether to show a progress bar, which needs the package tqdm. By default a bar is shown on terminals and in
        notebooks if tqdm is installed.
    **parameters
        Parameters that replace those of the experiment. A mapping in place of a value is a schedule, as for
        `Lab.create_world`.

    Returns
    -------
    RunFile
        The run: its tables are DataFrames. The file is deleted when it is closed or garbage collected; copy
        `RunFile.path` to keep it.

    Raises
    ------
    InvalidArgument
        An argument or a parameter is not allowed. `violations` lists all of them.

    Examples
    --------
    >>> import evod.aio
    >>> result = await evod.aio.run(seed=42, generations=3, selection="tournament")
    >>> result.generations()[["generation", "fitness_best", "fitness_mean"]].round(1)
       generation  fitness_best  fitness_mean
    0           1         337.6          71.1
    1           2         252.8          90.3
    2           3         322.8          98.6
    """
    whole = with_parameters(experiment, parameters)
    folder = tempfile.mkdtemp(prefix="evod-run-")
    try:
        async with local(seed=seed, experiment=whole, data=folder, threads=threads, program=program) as lab:
            world = await lab.world()
            if generations is None:
                now = await world.get_parameters()
                if not (now.generation_limit or now.stagnation_limit or now.stop_at_target_fitness
                        or now.stop_at_extinction):
                    raise _endless(None)
            with progress_bar("run", generations, progress) as advance:
                async for generation in world.run(generations):
                    if advance:
                        advance(generation.number)
        return RunFile(os.path.join(folder, f"{world.name}.evod"), program=program, temporary=folder)
    except BaseException:
        shutil.rmtree(folder, ignore_errors=True)
        raise


async def run_table(
    experiment: Experiment = None,
    *,
    seed: int | None = None,
    generations: int | None = None,
    threads: int = 1,
    program: str | os.PathLike[str] | None = None,
    **parameters: object,
) -> Any:
    """Runs an experiment without a server and returns its statistics (`evod run --csv`).

    This function is made for tasks: it can be pickled, uses one thread by default, and does not hold Python's global
    interpreter lock during the run. So any executor can call it, on this machine or on others: those of
    concurrent.futures, Dask or mpi4py, for example. `evod.run` returns all tables of a run.

    Parameters
    ----------
    experiment
        An experiment file, or a mapping of parameter names to values. By default all parameters have their default
        values.
    seed
        Seed of the run, 0 to 2**64 - 1. By default the seed in the experiment file, or a random seed.
    generations
        The number of generations. By default a termination criterion of the experiment ends the run.
    threads
        Number of threads for the simulation. The result does not depend on it.
    program, **parameters
        The same as for `evod.run`.

    Returns
    -------
    DataFrame
        One row per generation and island, with the columns of `evod run --csv`.

    Raises
    ------
    InvalidArgument
        An argument or a parameter is not allowed. `violations` lists all of them.

    Examples
    --------
    >>> import evod.aio
    >>> table = await evod.aio.run_table(seed=42, generations=3, selection="tournament")
    >>> table[["generation", "fitness_best", "fitness_mean"]].round(1)
       generation  fitness_best  fitness_mean
    0           1         337.6          71.1
    1           2         252.8          90.3
    2           3         322.8          98.6
    """
    whole = with_parameters(experiment, parameters)
    values = values_of(whole)
    if generations == 0 or generations is None and not any(values.get(name) for name in _TERMINATION):
        raise _endless(generations)
    with tempfile.TemporaryDirectory(prefix="evod-run-") as folder:
        path = whole if isinstance(whole, str) else write_json(os.path.join(folder, "experiment.json"), whole)
        csv = pathlib.Path(folder) / "run.csv"
        command = [find_program(program), "run", path, "--csv", str(csv), "--threads", str(threads)]
        command += [*_option("seed", seed), *_option("generations", generations)]
        await _output_of(Program(command, hidden=f"{folder}/experiment.json: ", accepted=_RUN_ENDED))
        return read_csv(csv.read_text(encoding="utf-8"))


# the statuses of `evod run` if the run ended by itself: by a limit or a target, stagnation, extinction
_RUN_ENDED = (0, 3, 4)
_TERMINATION = ("generation_limit", "stagnation_limit", "stop_at_target_fitness", "stop_at_extinction")


def _endless(generations: int | None) -> InvalidArgument:
    allowed = "a number, or a termination criterion in the experiment, such as generation_limit"
    return wrong_argument("generations", allowed, generations)


# ---- a sweep
# ----------------------------------------------------------------------------------------------------------


async def sweep(
    experiment: Experiment = None,
    *,
    grid: Mapping[str, object] | None = None,
    list: Sequence[Mapping[str, object]] | None = None,
    latin_hypercube: Mapping[str, object] | None = None,
    replicates: int | None = None,
    seed: int | None = None,
    seeds: Sequence[int] | None = None,
    generations: int | None = None,
    jobs: int | None = None,
    executor: concurrent.futures.Executor | None = None,
    function: Callable[..., numpy.typing.ArrayLike] | None = None,
    minimize: bool = False,
    out: str | os.PathLike[str] | None = None,
    program: str | os.PathLike[str] | None = None,
    progress: bool | None = None,
    **parameters: object,
) -> Sweep:
    """Runs an experiment many times with different parameters and seeds, on all cores or with an executor (`evod
    sweep`).

    Exactly one of `grid`, `list` and `latin_hypercube` is given. They have the form of the fields of a sweep file
    (docs/CLUSTER.md).

    Parameters
    ----------
    experiment
        An experiment file, or a mapping of parameter names to values. By default all parameters have their default
        values.
    grid
        The values of each parameter: a sequence, or ``{"from": A, "to": B, "steps": N}``. Every combination is a cell.
    list
        A sequence of mappings of parameter names to values, one mapping for each cell.
    latin_hypercube
        ``{"samples": N, "parameters": {…}}``: N cells that cover the ranges of the parameters evenly.
    replicates
        The number of runs per cell, by default 1. Replicate r has the same seed in every cell.
    seed
        The seed of the whole sweep. By default the seed of the experiment, or 1.
    seeds
        The seed of each replicate. By default they are derived from `seed`.
    generations
        The number of generations of each run. By default a termination criterion of the experiment ends each run.
    jobs
        The number of simultaneous runs. By default one for each processor.
    executor
        An executor of concurrent.futures, or of a package with the same interface, such as
        ``distributed.Client(…).get_executor()`` or ``mpi4py.futures.MPIPoolExecutor()``. Each run is a task, which
        executes `evod sweep --run` with one thread. The workers need this package and the same build of evod, but no
        shared folder. The result is the same as without an executor, byte for byte. By default one process `evod sweep`
        executes all runs.
    function
        A fitness function, as for `World.evaluate`. The worlds have no bodies, unless ``external_bodies`` is True. Each
        run is executed in a worker process, `jobs` at a time. Lambdas and functions of the main program are allowed,
        and the main program is not imported again. The seeds are those of a sweep without a function. The global random
        generators of Python and NumPy are seeded with the seed of the run, so the result does not depend on `jobs`.
    minimize
        Less is better for the function. The result has the sign of the function.
    out
        The folder for the results, in which the same call resumes an interrupted sweep. By default a temporary folder.
    program, progress, **parameters
        The same as for `evod.run`.

    Raises
    ------
    InvalidArgument
        An argument or a parameter is not allowed. `violations` lists all of them.
    ProgramFailed
        A run failed, or a worker of the executor was lost. The message names the cell and the replicate. The other runs
        are cancelled; those in progress on this machine are stopped. The same call with `out` resumes the sweep.

    Examples
    --------
    >>> import evod.aio
    >>> methods = {"selection": ["random", "tournament"]}
    >>> result = await evod.aio.sweep(grid=methods, replicates=2, seed=1, generations=20)
    >>> result
    <sweep of selection: 2 cells of 2 replicates, seed 1>
    >>> result.last.groupby("selection").fitness_mean.mean().round(1).to_dict()
    {'random': 73.8, 'tournament': 145.6}
    >>> import concurrent.futures
    >>> with concurrent.futures.ThreadPoolExecutor(2) as threads:
    ...     same = await evod.aio.sweep(grid=methods, replicates=2, seed=1, generations=20, executor=threads)
    >>> same.csv == result.csv
    True
    """
    if executor is not None and not isinstance(executor, concurrent.futures.Executor):
        allowed = "an executor of concurrent.futures or with its interface, such as client.get_executor() of Dask"
        raise wrong_argument("executor", allowed, repr(executor))
    if executor is not None and jobs is not None:
        raise wrong_argument("jobs", "no value if an executor is given: it determines how many runs execute at a time",
                             jobs)
    if function is not None and (executor is not None or out is not None):
        allowed = "no value if a function is given: worker processes of this machine execute it"
        raise wrong_argument("out" if executor is None else "executor", allowed, out if executor is None else executor)
    given = {"grid": grid, "list": list, "latin_hypercube": latin_hypercube, "seed": seed, "generations": generations,
             "seeds": seeds, "replicates": 1 if replicates is None and seeds is None else replicates}
    whole = with_parameters(experiment, parameters)
    design: dict[str, object] = {name: value for name, value in given.items() if value is not None}
    planned = os.path.abspath(whole) if isinstance(whole, str) else whole
    design |= {"experiment": planned if function is None else stand_in(values_of(whole))}
    with tempfile.TemporaryDirectory(prefix="evod-sweep-") as folder:
        path = write_json(os.path.join(folder, "sweep.json"), design)
        results = pathlib.Path(folder if out is None else out)
        plan = Plan.of(result_in(await _output_of(plan_command(program, path))))
        with progress_bar("sweep", 1.0, progress) as advance:
            if function is not None:
                made = FunctionSweep(function, plan, values_of(whole), generations, minimize=minimize, jobs=jobs,
                                     program=program, on_progress=advance)  # fmt: skip
                text = await _output_of(made)
                return Sweep(len(plan.cells), len(plan.seeds), plan.seed, plan.seeds, plan.parameters, text, minimize)
            if executor is None:
                command = [find_program(program), "sweep", path, "--json", "--out", str(results),
                           *_option("jobs", jobs)]
                await _output_of(Program(command, hidden=f"{path}: ", on_progress=advance))
            else:
                text = (pathlib.Path(whole).read_text(encoding="utf-8-sig") if isinstance(whole, str)
                        else json_text(whole))
                runs = ExecutorSweep(executor, plan, path=path, design=design, experiment=text, results=results,
                                     program=program, on_progress=advance)  # fmt: skip
                await _output_of(runs)
        text = (results / "runs.csv").read_text(encoding="utf-8")
    return Sweep(len(plan.cells), len(plan.seeds), plan.seed, plan.seeds, plan.parameters, text)


# ---- a comparison
# -------------------------------------------------------------------------------------------------------


async def compare(
    *experiments: Experiment,
    names: Sequence[str] | None = None,
    controls: bool | None = None,
    replicates: int = 20,
    seed: int | None = None,
    generations: int | None = None,
    jobs: int | None = None,
    function: Callable[..., numpy.typing.ArrayLike] | None = None,
    minimize: bool = False,
    program: str | os.PathLike[str] | None = None,
    progress: bool | None = None,
    **parameters: object,
) -> Comparison:
    """Compares a world with its controls, or with other worlds, using the same seeds (`evod compare`).

    Parameters
    ----------
    *experiments
        Experiment files, or mappings of parameter names to values. A single one, or none for the default world, is
        compared with its controls: random selection, no mutation, harmless poison and shuffled fitness. Of several, the
        first is compared with each of the others.
    names
        The names of the worlds in the results. By default the names of the files without their extension, and
        "experiment_1", "experiment_2", … for mappings.
    controls
        Whether to compare with the controls. By default True for at most one experiment.
    replicates
        The number of runs of each world, each with its own seed.
    seed
        The seed from which the seeds of all runs are derived. By default the seed of the first file, or a random one.
    generations
        The number of generations of each run. By default the generation_limit of the first experiment, or 60.
    jobs
        The number of simultaneous runs. By default one for each processor.
    function, minimize
        As for `sweep`: a function rates all worlds.
    program, progress, **parameters
        The same as for `evod.run`. The parameters replace those of all experiments.

    Raises
    ------
    InvalidArgument
        An argument or a parameter is not allowed. `violations` lists all of them.

    Examples
    --------
    >>> import evod.aio
    >>> methods = ["tournament", "roulette"]
    >>> result = await evod.aio.compare(*({"selection": method} for method in methods), names=methods, replicates=3,
    ...                                 generations=5, seed=1)
    >>> [world.name for world in result.worlds], result.differences[0].other
    (['tournament', 'roulette'], 'roulette')
    >>> len(result.fitness)
    30
    """
    given = experiments or (None,)
    if names is not None and len(names) != len(given):
        raise wrong_argument("names", f"{len(given)} names, one for each experiment", names)
    with tempfile.TemporaryDirectory(prefix="evod-compare-") as folder:
        paths, arms = [], []
        for number, experiment in enumerate(given):
            if isinstance(experiment, (str, os.PathLike)):
                if names is None and not parameters and function is None:
                    paths.append(file_of(experiment))
                    continue
                default = pathlib.Path(experiment).stem
            else:
                default = "default" if experiment is None else f"experiment_{number + 1}"
            name = default if names is None else names[number]
            if not name or "/" in name:
                raise wrong_argument("names", "names that are not empty and contain no /", repr(name))
            values = {**values_of(experiment), **parameters}
            path = os.path.join(folder, f"{name}.json")
            if os.path.exists(path):  # two experiments may have the same name
                path = os.path.join(tempfile.mkdtemp(dir=folder), f"{name}.json")
            arms.append(values)
            paths.append(write_json(path, values if function is None else stand_in(values)))
        csv = os.path.join(folder, "fitness.csv")
        command = [find_program(program), "compare", *paths, "--json", "--replicates", str(replicates), "--csv", csv]
        command += ["--controls"] if controls or controls is None and len(given) == 1 else []
        if function is not None:
            # The program evod checks the worlds, and returns the controls and the seeds.
            command += [*_option("seed", seed), "--generations", "2"]
            printed = result_in(await _output_of(Program(command, hidden=f"{folder}/")))
            seeds = seeds_in(pathlib.Path(csv).read_text(encoding="utf-8"))
            length = generations or int(str(arms[0].get("generation_limit") or 60))
            with progress_bar("comparison", 1.0, progress) as advance:
                trials = FunctionComparison(function, printed["worlds"], arms, seeds, length, minimize=minimize,
                                            jobs=jobs, program=program, on_progress=advance)  # fmt: skip
                return comparison_of(await _output_of(trials), printed, seeds, length)
        command += [*_option("seed", seed), *_option("generations", generations), *_option("jobs", jobs)]
        with progress_bar("comparison", 1.0, progress) as advance:
            result = result_in(await _output_of(Program(command, hidden=f"{folder}/", on_progress=advance)))
        return Comparison(
            tuple(ComparedWorld(**world) for world in result["worlds"]),
            tuple(Difference(**difference) for difference in result["differences"]),
            " ".join(result["conclusions"].split()),
            result["report"],
            pathlib.Path(csv).read_text(encoding="utf-8"),
        )


async def _output_of(program: Union[Program, ExecutorSweep, FunctionSweep, FunctionComparison]) -> str:
    try:
        return await blocking_call(program.run)
    except BaseException:  # a cancelled task does not stop its thread
        program.stop()
        raise


def _option(name: str, value: object) -> Sequence[str]:
    return () if value is None else (f"--{name}", str(value))
