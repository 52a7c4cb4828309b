"""A process that evaluates a function in worlds of its own: `python3 -m evod.function_worker`, started by
function_runs.py.

It reads pickled tasks from its input and writes pickled answers to its output, until its input ends.
"""
from __future__ import annotations

import os
import pickle
import random
import sys
import traceback
from typing import Any, BinaryIO

import numpy

from evod.connection import LocalLab, local
from evod.errors import Error
from evod.shipping import Task


def _columns(lab: LocalLab, function: Any, task: Task) -> dict[str, Any]:
    """The columns of the history of a run."""
    # A function that draws random numbers from the global generators gets the same ones in each process.
    random.seed(task.seed)
    numpy.random.seed(task.seed % 2**32)
    world = lab.create_world("run", task.parameters, seed=task.seed)
    try:
        return world.evaluate(function, task.generations, minimize=task.minimize).columns()
    finally:
        world.delete()


def serve(tasks: BinaryIO, answers: BinaryIO) -> None:
    """Answers tasks until the end of the input: (columns, None), or (None, what went wrong)."""
    program, shipped = pickle.load(tasks)
    function = pickle.loads(shipped)
    with local(threads=1, program=program) as lab:
        while True:
            try:
                task = pickle.load(tasks)
            except EOFError:
                return
            answer: tuple[Any, str | None]
            try:
                answer = _columns(lab, function, task), None
            except Error as error:
                answer = None, str(error)
            except Exception as error:
                frames = traceback.extract_tb(error.__traceback__)
                answer = None, (f"the function raised {type(error).__name__}: {error} (line {frames[-1].lineno} of "
                                f"{frames[-1].filename}, in {frames[-1].name})")
            pickle.dump(answer, answers)
            answers.flush()


if __name__ == "__main__":
    output = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what the function prints goes to standard error
    serve(sys.stdin.buffer, output)
