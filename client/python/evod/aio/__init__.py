"""evod for asyncio: the classes and functions of evod, with coroutines in place of functions that wait for an answer.

    async with evod.aio.connect("host:7744", token="…") as lab:
        world = await lab.world("default")
        await world.set(mutation_chance=0.1)
        async for g in world.run(generations=50):
            print(g.best, g.mean)

Functions that open something, such as connect() and World.run(), work with `await`, `async with` and `async for`. The
examples in the docstrings are for a notebook or `python3 -m asyncio`, where `await` is allowed outside of functions.

Threads      all calls on the event loop that connect() or local() was awaited on.
"""
from evod.aio.lab import Events, Lab, LocalLab, Replay, Run, Snapshots, World, connect, local

__all__ = ["Events", "Lab", "LocalLab", "Replay", "Run", "Snapshots", "World", "connect", "local"]
