"""Everything that a Lab and its worlds have, asked of either face once: what one of them answers at once, the other one's
user waits for."""
import inspect


def asked_kinds(lab):
    """The kinds of all that is asked from now on; they are added as it is asked."""
    core, kinds = lab._link.core, set()
    request = core.request

    def ask(message, **how):
        kinds.add(message.WhichOneof("kind"))
        return request(message, **how)

    core.request = ask
    return kinds


def wait_for(plain):
    """The end of a walk that never has to wait, as all is answered at once."""
    try:
        plain.send(None)
    except StopIteration:
        return
    raise AssertionError("the plain face makes its caller wait")


async def there(answer):
    return await answer if inspect.isawaitable(answer) else answer


async def first(stream, what=lambda x: True):
    """The first that is as wanted."""
    if hasattr(stream, "__anext__"):
        async for item in stream:
            if what(item):
                return item
    else:
        for item in stream:
            if what(item):
                return item


async def walk_all(lab):
    """Of a server that keeps its runs, and has one world."""
    assert (await there(lab.describe())).limits.worlds_max == 64
    assert len(await there(lab.registry())) > 50
    assert any(family.name == "evod_worlds" for family in (await there(lab.metrics())).families)
    default = await there(lab.world())
    everything = await there(lab.events())

    world = await there(lab.create_world("walk", {"population_size": 10, "generation_s": 2}, seed=3, speed="max"))
    assert (await there(world.info())).seed == 3
    assert [info.name for info in await there(lab.worlds())] == ["default", "walk"]
    assert (await first(everything)).HasField("world_created")
    events = await there(world.events())
    await there(world.set(mutation_chance=0.5))
    assert (await there(world.get_parameters())).mutation_chance == 0.5
    assert (await first(events)).parameters_changed.changed[0].name == "mutation_chance"
    await there(events.close())
    planned = await there(world.set(mutation_step=9.0, at_generation=50))
    assert planned.change.id == 1 and planned.change.generation == 50 and planned.change.values == {"mutation_step": 9.0}
    assert planned.planned == (planned.change,)
    later = (await there(world.set(food_health=9.0, at_tick=10**6))).change
    assert later.tick == 10**6 and later.generation is None
    assert await there(world.planned_changes()) == (planned.change, later)
    assert await there(world.cancel(planned.change)) == planned.change
    assert await there(world.cancel(later.id)) == later

    # Pictures, whole and in tiles.
    assert len((await there(world.snapshot())).organisms) == 10
    snapshots = await there(world.snapshots(120, region=(0, 0, 10, 10)))
    assert len((await first(snapshots)).tiles) == 1
    await there(snapshots.set_view(detail="dots"))
    dotted = await first(snapshots, lambda snapshot: snapshot.tiles[0].dots is not None)
    assert sum(len(tile.dots["organisms"].T) for tile in dotted.tiles) == 10
    await there(snapshots.request_keyframe())
    await first(snapshots)
    await there(snapshots.close())

    # Running.
    run = await there(world.run(generations=3))
    assert (await there(run.wait())).number == 3
    assert [g.number for g in await there(world.history())] == [1, 2, 3]
    assert (await there(world.wait())).generation == 3
    before = (await there(world.info())).tick
    assert (await there(world.step(5))).tick == before + 5
    await there(world.run())
    assert (await there(world.run_until_tick(before + 50))).leased
    await there(world.renew_lease())
    await there(world.release_lease())
    await there(world.pause())
    await there(world.resume())
    await there(world.set_speed(2.0))
    await there(world.pause())

    # Looking.
    assert len((await there(world.statistics())).live) == 1
    assert (await there(world.organism(3))).id == 3
    assert (await there(world.population())).genes.shape == (10, 6)
    assert (await there(world.breeding(generation=2))).descendant_count == 10
    assert (await there(world.motion())).tick_s > 0
    assert (await there(world.export("generations"))).startswith("generation,island,")
    assert len(await there(world.table("organisms"))) >= 40
    past = await there(world.open_replay(2))
    assert (await there(past.info())).generation == 2
    assert (await there(past.seek(1, 7))).generation_tick == 7
    await there(past.close())
    fork = await there(world.fork("fork", 2))
    assert (await there(fork.info())).generation == 2
    assert (await there(fork.reset(seed=9))).seed == 9
    await there(fork.delete())
    await there(default.export("organisms"))
    # A table of more than one part.
    await there(default.set(population_size=1000, scale_with_population=True))
    await there(default.set_speed("max"))
    run = await there(default.run(generations=3))
    assert (await there(run.wait())).number == 3
    assert (await there(default.export("organisms", "jsonl"))).count("\n") == 50 + 2 * 1000
    await there(lab.shut_down())
