"""evod.aio: the same functions as evod, and the same reliability."""
import asyncio
import inspect
import tempfile
import unittest

import evod
import evod.aio
from evod.v1 import commands_pb2 as c
from every_request import record_kinds, send_every_request


def public(thing):
    """The public names of a class."""
    return {name for name in dir(thing) if not name.startswith("_")}


class Modules(unittest.TestCase):
    def test_both_modules_have_the_same_functions(self):
        self.assertEqual(set(evod.aio.__all__) - set(evod.__all__), set())
        for name in evod.aio.__all__:
            ours, theirs = getattr(evod.aio, name), getattr(evod, name)
            if not isinstance(ours, type):
                self.assertEqual(inspect.signature(ours), inspect.signature(theirs), name)
                continue
            self.assertEqual(public(theirs) - public(ours) - {"parameters"}, set())  # an attribute cannot be awaited
            for member in public(ours):
                one, other = getattr(ours, member), getattr(theirs, member)
                if callable(one):
                    self.assertEqual(inspect.signature(one), inspect.signature(other), f"{name}.{member}")


class Asynchronous(unittest.IsolatedAsyncioTestCase):
    async def test_every_kind_of_request_can_be_sent(self):
        with tempfile.TemporaryDirectory() as data:
            async with evod.aio.local(seed=1, data=data) as lab:
                kinds = record_kinds(lab)
                await send_every_request(lab)
        self.assertEqual(kinds, set(field.name for field in c.Request.DESCRIPTOR.oneofs_by_name["kind"].fields))

    async def test_many_coroutines_share_a_connection(self):
        async with evod.aio.local(seed=42) as lab:
            world = await lab.world()

            async def ticks():
                return [(await anext(snapshots)).tick for _ in range(20)]

            async with world.snapshots(120) as snapshots, world.run() as run:
                seen, ended, *organisms = await asyncio.gather(
                    ticks(), self.first_of(run, 20), *(world.organism(i % 50) for i in range(200)))
            self.assertEqual(seen, sorted(seen))
            self.assertEqual(ended, list(range(1, 21)))
            self.assertEqual([organism.id for organism in organisms], [i % 50 for i in range(200)])

    async def test_more_requests_than_the_limit_are_queued(self):
        async with evod.aio.local() as lab:
            world = await lab.world()

            async def set_values():
                return [(await world.set(food_health=value)).revision for value in range(5)]

            revisions = await asyncio.gather(*(set_values() for _ in range(50)))
            self.assertEqual(len({revision for each in revisions for revision in each}), 50 * 5)

    async def first_of(self, run, count):
        return [(await anext(run)).number for _ in range(count)]

    async def test_a_cancelled_wait_leaves_the_others(self):
        async with evod.aio.local() as lab:
            world = await lab.world()
            async with world.events() as events:
                with self.assertRaises(TimeoutError):
                    async with asyncio.timeout(0.05):
                        await anext(events)
                await world.pause()
                self.assertEqual((await anext(events)).WhichOneof("kind"), "run_control_changed")

    async def test_a_bug_in_the_client_fails_waiting_calls(self):
        async with evod.aio.local() as lab:
            events = await lab.events()
            lab._link.core._take_event = lambda event: 1 // 0
            with self.assertRaisesRegex(evod.Error, "the client has a fault: ZeroDivisionError"):
                await lab.create_world("any")
                await anext(events)

    async def test_a_missing_server_is_reported(self):
        with self.assertRaisesRegex(evod.NoConnection, "no server at 127.0.0.1:1: start one with `evod`"):
            await evod.aio.connect("127.0.0.1:1")

    async def test_closing_fails_waiting_calls(self):
        async with evod.aio.local() as server:
            lab = await evod.aio.connect(server.address)
            events = await lab.events()
            waiting = asyncio.create_task(anext(events))
            await asyncio.sleep(0)
            await lab.close()
            with self.assertRaisesRegex(evod.NoConnection, "closed here"):
                await waiting


if __name__ == "__main__":
    unittest.main()
