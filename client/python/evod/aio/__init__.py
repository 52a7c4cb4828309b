"""The asyncio face: the same words as the plain one's, and what they answer is awaited.

    async with evod.aio.connect("host:7744", token="…") as lab:
        world = await lab.world("default")
        await world.set(mutation_chance=0.1)
        async for g in world.run(generations=50):
            print(g.best, g.mean)

Threads      all on the event loop that it was connected on.
"""
from evod.aio.lab import Events, Snapshots, Lab, LocalLab, Replay, Run, World, connect, local

__all__ = ["Events", "Snapshots", "Lab", "LocalLab", "Replay", "Run", "World", "connect", "local"]
