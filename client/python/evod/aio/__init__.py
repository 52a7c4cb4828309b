"""evod for asyncio: the same classes and functions as in evod. Functions that wait for an answer are coroutines here.

    async with evod.aio.connect("host:7744", token="…") as lab:
        world = await lab.world("default")
        await world.set(mutation_chance=0.1)
        async for g in world.run(generations=50):
            print(g.best, g.mean)

The result of connect(), local() and similar functions works with `await` and `async with`; that of World.run() and
other streams also with `async for`. The examples in the docstrings are for a notebook or `python3 -m asyncio`, where
`await` is allowed outside of functions.

Threads      call everything on the event loop on which connect() or local() was awaited.
"""
from evod.aio.classrooms import Classroom
from evod.aio.connection import LocalLab, connect, join, local
from evod.aio.evaluation import Evaluation
from evod.aio.experiments import compare, run, run_table, sweep
from evod.aio.lab import Lab, Replay, World
from evod.aio.streams import Events, Run, Snapshots

__all__ = [
    "Classroom", "Evaluation", "Events", "Lab", "LocalLab", "Replay", "Run", "Snapshots", "World", "compare",
    "connect", "join", "local", "run", "run_table", "sweep",
]  # fmt: skip
