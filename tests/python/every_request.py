"""Calls every function of a Lab and its worlds once, for evod and for evod.aio.

One coroutine serves both: it awaits only what can be awaited. With evod it never suspends."""
import inspect

from evod.v1 import commands_pb2 as c


def record_kinds(lab):
    """A set to which the kind of every later request is added."""
    core, kinds = lab._link.core, set()
    request = core.request

    def record(message, **options):
        kinds.add(message.WhichOneof("kind"))
        return request(message, **options)

    core.request = record
    return kinds


def finish(coroutine):
    """Runs a coroutine that never suspends."""
    try:
        coroutine.send(None)
    except StopIteration:
        return
    raise AssertionError("a synchronous function returned an awaitable")


async def result(answer):
    """The answer, awaited if it is of evod.aio."""
    return await answer if inspect.isawaitable(answer) else answer


async def first(stream, condition=lambda item: True):
    """The first item for which the condition holds."""
    if hasattr(stream, "__anext__"):
        async for item in stream:
            if condition(item):
                return item
    else:
        for item in stream:
            if condition(item):
                return item


async def send_requests_of_classes(lab, world):
    """Notes in the world, and a class that is deleted again."""
    await result(world.note("a remark"))
    assert [note.text for note in await result(world.notes())] == ["a remark"]
    bio2 = await result(lab.create_class("bio2", {"population_size": 10}))
    assert [code.name for code in await result(bio2.add_members(["Ada"]))] == ["Ada"]
    assert len(await result(bio2.new_personal_code("Ada"))) == 10
    assert len(await result(bio2.open())) == 6
    assert [room.name for room in await result(lab.classes())] == ["bio2"]
    assert await result(bio2.set_speed("max")) == {}
    await result(lab.request(make_qr_codes=c.MakeQrCodes(texts=["http://lab:7745/#join=KTRMXB"])))
    await result(bio2.delete())


async def send_every_request(lab):
    """The server must keep its runs and have one world."""
    assert (await result(lab.describe())).limits.worlds_max == 256
    assert len(await result(lab.registry())) > 50
    assert any(family.name == "evod_worlds" for family in (await result(lab.metrics())).families)
    default = await result(lab.world())
    everything = await result(lab.events())

    world = await result(lab.create_world("walk", {"population_size": 10, "generation_s": 2}, seed=3, speed="max"))
    assert (await result(world.info())).seed == 3
    assert [info.name for info in await result(lab.worlds())] == ["default", "walk"]
    assert (await first(everything)).HasField("world_created")
    events = await result(world.events())
    await result(world.set(mutation_chance=0.5))
    assert (await result(world.get_parameters())).mutation_chance == 0.5
    assert (await first(events)).parameters_changed.changed[0].name == "mutation_chance"
    await result(events.close())
    planned = await result(world.set(mutation_step=9.0, at_generation=50))
    assert planned.change.id == 1 and planned.change.generation == 50
    assert planned.change.values == {"mutation_step": 9.0}
    assert planned.planned == (planned.change,)
    later = (await result(world.set(food_health=9.0, at_tick=10**6))).change
    assert later.tick == 10**6 and later.generation is None
    assert await result(world.planned_changes()) == (planned.change, later)
    assert await result(world.cancel(planned.change)) == planned.change
    assert await result(world.cancel(later.id)) == later

    # Items and organisms that are placed and removed.
    placed = await result(world.place(food=[(30, 40), (50.5, 40)], poison=[(30, 80)]))
    assert len(placed.food) == 2 and len(placed.poison) == 1 and placed.organisms == () and placed.generation == 1
    removed = await result(world.remove(food=placed.food, poison=placed.poison, generation=1))
    assert removed == placed

    # Fitness from this client.
    setting = {"fitness": "external", "external_bodies": False, "population_size": 10}
    rated = await result(lab.create_world("rated", setting))
    assert [g.number for g in await result(rated.evaluate(lambda genes, life: genes[:, 0], generations=2))] == [1, 2]
    assert (await result(rated.info())).awaited_fitness is None
    await result(rated.delete())

    # Snapshots, whole and in tiles.
    assert len((await result(world.snapshot())).organisms) == 10
    snapshots = await result(world.snapshots(120, region=(0, 0, 10, 10)))
    assert len((await first(snapshots)).tiles) == 1
    await result(snapshots.set_view(detail="dots"))
    dotted = await first(snapshots, lambda snapshot: snapshot.tiles[0].dots is not None)
    assert sum(len(tile.dots["organisms"].T) for tile in dotted.tiles) == 10
    await result(snapshots.request_keyframe())
    await first(snapshots)
    await result(snapshots.close())

    # Running.
    run = await result(world.run(generations=3))
    assert (await result(run.wait())).number == 3
    assert [g.number for g in await result(world.history())] == [1, 2, 3]
    assert (await result(world.wait())).generation == 3
    before = (await result(world.info())).tick
    assert (await result(world.step(5))).tick == before + 5
    await result(world.run())
    assert (await result(world.run_until_tick(before + 50))).leased
    await result(world.renew_lease())
    await result(world.release_lease())
    await result(world.pause())
    await result(world.resume())
    await result(world.set_speed(2.0))
    await result(world.pause())

    await send_requests_of_classes(lab, world)

    # Queries.
    assert await result(world.observe("mean(fitness_best)")) is not None
    assert len((await result(world.statistics())).live) == 1
    assert (await result(world.organism(3))).id == 3
    assert (await result(world.population())).genes.shape == (10, 6)
    assert (await result(world.breeding(generation=2))).descendant_count == 10
    assert (await result(world.motion())).tick_s > 0
    assert (await result(world.export("generations"))).startswith("generation,island,")
    assert len(await result(world.table("organisms"))) >= 40
    replay = await result(world.open_replay(2))
    assert (await result(replay.info())).generation == 2
    assert (await result(replay.seek(1, 7))).generation_tick == 7
    await result(replay.close())
    fork = await result(world.fork("fork", 2))
    assert (await result(fork.info())).generation == 2
    assert (await result(fork.reset(seed=9))).seed == 9
    await result(fork.delete())
    await result(default.export("organisms"))
    # A table that is exported in several parts.
    await result(default.set(population_size=1000, scale_with_population=True))
    await result(default.set_speed("max"))
    run = await result(default.run(generations=3))
    assert (await result(run.wait())).number == 3
    assert (await result(default.export("organisms", "jsonl"))).count("\n") == 50 + 2 * 1000
    await result(lab.shut_down())
