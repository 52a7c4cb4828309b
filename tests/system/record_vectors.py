"""Records the test vectors of snapshots, proto/vectors: frames that a real server sends, and what they decode to.

    record_vectors.py EVOD MESSAGES [--check]

EVOD is the program, MESSAGES the folder of the message classes: build/release/bin/evod build/release/tests/system. With
--check it writes nothing, and fails where the files differ from what the server sends now. docs/PROTOCOL.md, "Test
vectors", describes the files.

The script computes what a frame decodes to without a decoder of deltas or tiles. For each subscription another one
with CODEC_PLAIN receives the same ticks; tiles, dots and densities are counted from its snapshots. Where a world is
paused, the plain organisms are compared with the server's answers to GetOrganism, which involve no codec. At the end
the decoder of docs/PROTOCOL.md must agree with everything.

Each scenario starts a server, and is repeated until two recordings are equal byte for byte: on a busy machine the
server may drop a snapshot, or send one more.
"""
import collections
import json
import math
import pathlib
import struct
import sys
import zlib

import numpy

ROOT = pathlib.Path(__file__).resolve().parents[2]
FOLDER = ROOT / "proto/vectors"
CHECK = sys.argv[3:] == ["--check"]
if len(sys.argv) != 3 + CHECK:
    sys.exit("usage: record_vectors.py EVOD MESSAGES [--check]")
sys.argv[3:] = [str(ROOT / "docs/PROTOCOL.md")]  # as plain_client reads them

import plain_client as plain  # noqa: E402
from delta_decoder import KINDS, Decoder, TilesDecoder  # noqa: E402
from plain_client import c, stream_pb2, w  # noqa: E402

WORLD = "vectors"
RATE_HZ = 2  # low, so that snapshots follow commands and the end of a run, and hardly ever come in between
RECORDINGS_MAX = 10
HAVE_IDS = ("organisms", "food", "poison")
PLAIN, DELTA = stream_pb2.CODEC_PLAIN, stream_pb2.CODEC_DELTA
FULL, DOTS, DENSITY = stream_pb2.DETAIL_FULL, stream_pb2.DETAIL_DOTS, stream_pb2.DETAIL_DENSITY


class Recorder(plain.Client):
    """A client that creates one world, steps it, and keeps the frames of each subscription in order."""

    def __init__(self, server, seed, headings=False, species=False, **parameters):
        self.bodies = collections.defaultdict(list)  # by subscription
        self.newest = {}  # by (subscription, island): the last snapshot, and how many there have been
        self.cases = {}  # by name: the subscription
        self.reference = {}  # by (run_id, island, tick): the snapshot of CODEC_PLAIN
        self.run_ids = []
        self.damaged = {}  # by case: which frame, from 0
        super().__init__(server, key="vectors")
        self.islands = parameters.get("island_count", 1)
        self.call(create_world=c.CreateWorld(name=WORLD, seed=seed, parameters=plain.assignments(**parameters)))
        self.plain = self.subscribe(None, codec=PLAIN, headings=headings, species=species)

    def frame(self):
        channel, body = super().frame()
        if channel == 2:
            snapshot = stream_pb2.SnapshotFrame.FromString(body)
            name = snapshot.subscription_id, snapshot.island
            self.bodies[snapshot.subscription_id].append(body)
            self.newest[name] = snapshot, self.newest.get(name, (None, 0))[1] + 1
            if snapshot.codec == PLAIN:
                self.reference[snapshot.run_id, snapshot.island, snapshot.tick] = snapshot
            if snapshot.run_id and snapshot.run_id not in self.run_ids:
                self.run_ids.append(snapshot.run_id)
        return channel, body

    def counts(self):
        return {name: count for name, (_, count) in self.newest.items()}

    def wait(self, before, names, condition=lambda snapshot: True):
        """Waits until each of `names` has a snapshot since `before` that fulfils the condition."""
        while not all(name in self.newest and self.newest[name][1] > before.get(name, 0) and
                      condition(self.newest[name][0]) for name in names):
            self.step()

    def names(self, *subscriptions):
        return [(subscription, island) for subscription in subscriptions or [self.plain, *self.cases.values()]
                for island in range(self.islands)]

    def subscribe(self, case, **fields):
        before = self.counts()
        subscription = self.call(subscribe_snapshots=c.SubscribeSnapshots(
            world=WORLD, rate_hz=RATE_HZ, **fields)).subscription.subscription_id
        if case:
            self.cases[case] = subscription
        self.wait(before, self.names(subscription))
        return subscription

    def command(self, condition=lambda snapshot: True, **request):
        """Sends a command for the world and waits for the snapshots after it."""
        before = self.counts()
        self.call(**request)
        self.wait(before, self.names(), condition)

    def run_to(self, *ticks):
        for tick in ticks:
            self.command(lambda snapshot: (snapshot.tick, snapshot.state) == (tick, w.RUN_STATE_PAUSED),
                         run_until_tick=c.RunUntilTick(world=WORLD, tick=tick))
            for island in range(self.islands):
                self.compare_organisms(self.newest[self.plain, island][0])

    def compare_organisms(self, snapshot):
        """Compares a plain snapshot with the responses about each organism, while the world is paused."""
        organisms = {}
        for organism, *steps in zip(*entities_of(snapshot)["organisms"].values()):
            organisms[organism] = steps
        born = self.call(get_population=c.GetPopulation(world=WORLD, island=snapshot.island)).population.organism_count
        for organism in range(born):
            info = self.call(get_organism=c.GetOrganism(world=WORLD, island=snapshot.island,
                                                        organism=organism)).organism
            steps = [math.floor(value * 16 + 0.5) for value in (info.x_px, info.y_px, info.radius_px, info.health)]
            if snapshot.plain.organisms.heading:
                steps.append(heading_in_steps(info.heading))
            if snapshot.plain.organisms.species:
                steps.append(info.species)
            shown = info.alive and info.radius_px > 0  # otherwise it has no body
            if shown != (organism in organisms) or shown and steps != organisms[organism]:
                raise AssertionError(f"organism {organism}: {steps}, {info}; in columns {organisms.get(organism)}")

    def speed(self, real_time_factor):
        self.command(set_speed=c.SetSpeed(world=WORLD, speed=w.Speed(real_time_factor=real_time_factor)))

    def keyframe(self, case):
        before = self.counts()
        self.call(request_keyframe=c.RequestKeyframe(subscription_id=self.cases[case]))
        self.wait(before, self.names(self.cases[case]))

    def view(self, case, **view):
        before = self.counts()
        self.call(set_view=c.SetView(subscription_id=self.cases[case], view=c.View(**view)))
        self.wait(before, self.names(self.cases[case]))

    def reset(self, seed):
        run_id = self.newest[self.plain, 0][0].run_id
        self.command(lambda snapshot: snapshot.tick == 0 and snapshot.run_id not in (b"", run_id),
                     reset_world=c.ResetWorld(world=WORLD, seed=seed))


# ---- scenarios
# --------------------------------------------------------------------------------------------------------


def region(left_px, top_px, width_px, height_px):
    return c.Region(left_px=left_px, top_px=top_px, width_px=width_px, height_px=height_px)


SMALL = {"population_size": 12, "food_count": 8, "poison_count": 6, "crate_count": 2, "obstacle_count": 2,
         "obstacle_size_px": 50, "crate_mass_kg": 0.1, "island_width_px": 500.0, "island_height_px": 400.0,
         "respawn_s": 0.2}


def whole(recorder, name):
    """The same snapshots by every codec, as they are and compressed."""
    recorder.cases[f"{name}_plain"] = recorder.plain
    recorder.subscribe(f"{name}_deltas", codec=DELTA)
    recorder.subscribe(f"{name}_deltas_zstd", codec=DELTA, compression=stream_pb2.COMPRESSION_ZSTD)


def life(server):
    """Single ticks, many ticks at once, none; items that are eaten and come back; deaths; a keyframe on the way."""
    with Recorder(server, 3, **SMALL, health_loss_per_s=50.0) as recorder:
        whole(recorder, "life")
        recorder.run_to(1, 2, 2)
        recorder.speed(20.0)
        recorder.run_to(15, 40)
        recorder.keyframe("life_deltas")
        recorder.keyframe("life_deltas_zstd")
        recorder.run_to(41, 110, 190)
        return recorder


def births(server):
    """A generation ends and all organisms of the next are born; then the world is reset."""
    with Recorder(server, 5, **SMALL, generation_s=0.5) as recorder:
        whole(recorder, "births")
        recorder.speed(20.0)
        recorder.run_to(29, 30, 31)
        recorder.reset(7)
        recorder.run_to(1, 2)
        return recorder


def empty(server):
    """Empty islands: with a fitness of genes alone organisms have no bodies."""
    with Recorder(server, 1, fitness="gene_sum", population_size=4, food_count=0, poison_count=0) as recorder:
        whole(recorder, "empty")
        for detail in FULL, DOTS, DENSITY:
            recorder.subscribe("empty_" + stream_pb2.Detail.Name(detail).lower(), codec=DELTA,
                               view=c.View(detail=detail))
        recorder.run_to(1, 2)
        return recorder


def islands(server):
    """Two islands in one subscription; on one of them all organisms die."""
    with Recorder(server, 11, island_count=2, population_size=2, food_count=3, poison_count=6, poison_harm=1000.0,
                  island_width_px=300.0, island_height_px=300.0, health_loss_per_s=60.0) as recorder:
        whole(recorder, "islands")
        recorder.speed(20.0)
        recorder.run_to(90, 110, 121)
        return recorder


def wide(server):
    """An island whose positions and displacements take 4 bytes."""
    with Recorder(server, 13, population_size=16, food_count=3, poison_count=3, crate_count=1, island_width_px=200000.0,
                  island_height_px=200000.0, generation_s=1000.0, health_loss_per_s=0.0, damping=1.0,
                  max_speed_px_s=100000.0, normal_speed_max=10000.0, initial_gene_max=10000.0) as recorder:
        whole(recorder, "wide")
        recorder.run_to(1, 2)
        recorder.speed(10000.0)
        recorder.run_to(150, 300, 500, 800)
        return recorder


def crowd(server):
    """Enough organisms that bodies are compressed, and that columns have exceptions."""
    with Recorder(server, 17, population_size=90, food_count=40, poison_count=100, crate_count=5, obstacle_count=3,
                  island_width_px=1000.0, island_height_px=1000.0) as recorder:
        whole(recorder, "crowd")
        recorder.subscribe("crowd_tiles_zstd", codec=DELTA, compression=stream_pb2.COMPRESSION_ZSTD,
                           view=c.View(region=region(0, 0, 500, 500)))
        recorder.speed(20.0)
        recorder.run_to(2, 30)
        return recorder


TILED = {"population_size": 16, "food_count": 12, "poison_count": 8, "crate_count": 5, "obstacle_count": 2,
         "crate_mass_kg": 0.1, "island_width_px": 1300.0, "island_height_px": 900.0}


def tiles(server):
    """All tiles, and a region that moves; organisms, crates and food enter and leave tiles."""
    with Recorder(server, 23, **TILED) as recorder:
        recorder.subscribe("tiles_all", codec=DELTA, view=c.View())
        moving = "tiles_of_a_region"
        recorder.subscribe(moving, codec=DELTA, view=c.View(region=region(0, 0, 600, 100)))
        recorder.run_to(1, 2)
        recorder.view(moving, region=region(520, 0, 600, 100))
        recorder.speed(20.0)
        recorder.run_to(30, 60)
        recorder.view(moving, region=region(-700, 0, 600, 100))
        recorder.run_to(61)
        recorder.view(moving, region=region(1200, 800, 600, 600))
        recorder.run_to(62, 100)
        recorder.keyframe("tiles_all")
        recorder.run_to(101)
        return recorder


def details(server):
    """The same tiles in less and less detail, and in full detail again."""
    with Recorder(server, 19, **TILED) as recorder:
        case = "details"
        recorder.subscribe(case, codec=DELTA, view=c.View())
        recorder.speed(20.0)
        recorder.run_to(5)
        for detail in DOTS, DENSITY, DOTS, FULL:
            recorder.view(case, detail=detail)
            recorder.run_to(recorder.newest[recorder.plain, 0][0].tick + 10)
        return recorder


def coarse(server):
    """Dots and densities of many entities, uncompressed and compressed."""
    with Recorder(server, 29, population_size=60, food_count=350, poison_count=20, crate_count=2, obstacle_count=2,
                  island_width_px=1100.0, island_height_px=500.0, body_size_max=60.0) as recorder:
        for detail in DOTS, DENSITY:
            name = stream_pb2.Detail.Name(detail).lower()
            recorder.subscribe(f"coarse_{name}", codec=DELTA, view=c.View(detail=detail))
            recorder.subscribe(f"coarse_{name}_zstd", codec=DELTA, view=c.View(detail=detail),
                               compression=stream_pb2.COMPRESSION_ZSTD)
        recorder.run_to(1)
        return recorder


def corner(server):
    """The last tiles of an island so large that tiles are 1,024 px wide: at the walls, and positions of 4 bytes."""
    with Recorder(server, 31, population_size=250, food_count=600, poison_count=500, crate_count=300,
                  obstacle_count=200, island_width_px=20000.0, island_height_px=14000.0) as recorder:
        for detail in FULL, DOTS, DENSITY:
            name = stream_pb2.Detail.Name(detail).lower()
            recorder.subscribe(f"corner_{name}", codec=DELTA,
                               view=c.View(detail=detail, region=region(18000, 12500, 2000, 1500)))
        recorder.run_to(1, 2)
        return recorder


def damage(server):
    """One frame of each case is damaged: deltas are refused from there to the next keyframe."""
    with Recorder(server, 37, **SMALL) as recorder:
        recorder.subscribe("damage_deltas", codec=DELTA)
        recorder.subscribe("damage_tiles", codec=DELTA, view=c.View())
        recorder.damaged = dict.fromkeys(recorder.cases, 2)
        recorder.run_to(1, 2, 3)
        recorder.keyframe("damage_deltas")
        recorder.keyframe("damage_tiles")
        recorder.run_to(4)
        return recorder


def headings(server):
    """Organisms with headings turn and die, and others are born; the last organism of a tile dies, so it has no
    headings."""
    with Recorder(server, 41, headings=True, **{**TILED, "population_size": 6}, controller="network", brain_hidden=2,
                  damping=0.9, force_per_unit=10.0, health_loss_per_s=60.0) as recorder:
        recorder.cases["headings_plain"] = recorder.plain
        recorder.subscribe("headings_deltas", codec=DELTA, headings=True)
        recorder.subscribe("headings_tiles", codec=DELTA, headings=True, view=c.View())
        recorder.run_to(1, 2)
        recorder.speed(20.0)
        recorder.run_to(30, 80, 90, 100, 110, 120)
        return recorder


def species(server):
    """Prey and predators, which eat them; children of both are born, and an interval ends."""
    with Recorder(server, 43, species=True, **{**TILED, "population_size": 14, "food_count": 60}, predator_count=5,
                  reproduction="births", births="asexual", predator_births="asexual", birth_health=90.0,
                  predator_birth_health=90.0, generation_s=1.5) as recorder:
        recorder.cases["species_plain"] = recorder.plain
        recorder.subscribe("species_deltas", codec=DELTA, species=True)
        recorder.subscribe("species_tiles", codec=DELTA, species=True, view=c.View())
        recorder.run_to(1, 2)
        recorder.speed(20.0)
        recorder.run_to(30, 60, 89, 90, 91, 120)
        return recorder


SCENARIOS = [life, births, empty, islands, wide, crowd, tiles, details, coarse, corner, damage, headings, species]


# ---- what frames decode to
# --------------------------------------------------------------------------------------------


def entities_of(snapshot):
    """{kind: {column: whole numbers}} of a snapshot of CODEC_PLAIN."""
    assert snapshot.codec == PLAIN
    entities = {kind: {name: (column if name == "id" else numpy.rint(column * 16)).astype(int).tolist()
                       for name, column in columns.items()}
                for kind, columns in plain.columns(snapshot).items()}
    if snapshot.plain.organisms.heading:
        entities["organisms"]["heading"] = [heading_in_steps(heading) for heading in snapshot.plain.organisms.heading]
    if snapshot.plain.organisms.species:
        entities["organisms"]["species"] = list(snapshot.plain.organisms.species)
    return entities


def heading_in_steps(radians):
    return math.floor(radians * 256 / (2 * math.pi) + 0.5) % 256


def in_tile(entities, snapshot, tile):
    """The entities of one tile, boxes with ids; and the tile's corner in 1/16 px."""
    side = snapshot.tile_px * 16
    across, down = (max(1, math.ceil(length / snapshot.tile_px)) for length in (snapshot.width_px, snapshot.height_px))
    left, top = tile % across * side, tile // across * side
    there = {}
    for kind, columns in entities.items():
        columns = {"id": list(range(len(columns["x"]))), **columns}
        rows = [i for i, (x, y) in enumerate(zip(columns["x"], columns["y"]))
                if min(y // side, down - 1) * across + min(x // side, across - 1) == tile]
        there[kind] = {name: [column[i] for i in rows] for name, column in columns.items()}
    return there, left, top


def present(entities):
    """Without kinds that have no entities."""
    return {kind: columns for kind, columns in entities.items() if columns["x"]}


def expected_tile(entities, snapshot, tile):
    there, left, top = in_tile(entities, snapshot, tile.tile)
    side = snapshot.tile_px * 16
    content = {"tile": tile.tile, "detail": stream_pb2.Detail.Name(tile.detail)}
    if tile.detail == FULL:
        return {**content, **present(there)}
    if tile.detail == DOTS:
        return {**content, **present({kind: {"x": [min((x - left) * 256 // side, 255) for x in columns["x"]],
                                          "y": [min((y - top) * 256 // side, 255) for y in columns["y"]]}
                                   for kind, columns in there.items()})}
    cells = tile.body[0] if tile.compression != stream_pb2.COMPRESSION_ZSTD else plain.zstd_content(tile.body)[0]
    density = {kind: [[0] * cells for _ in range(cells)] for kind in HAVE_IDS}
    for kind, rows in density.items():
        for x, y in zip(there[kind]["x"], there[kind]["y"]):
            rows[min((y - top) * cells // side, cells - 1)][min((x - left) * cells // side, cells - 1)] += 1
    return {**content, "cells": cells, **density}


def expected(snapshot, reference):
    """What a frame decodes to. reference: the snapshot of CODEC_PLAIN of the same run, island and tick."""
    assert snapshot.state_hash == reference.state_hash
    content = {"world": reference.world, "run_id": reference.run_id.hex(), "island": reference.island,
            "island_count": reference.island_count, "tick": reference.tick, "generation": reference.generation,
            "generation_tick": reference.generation_tick, "width_px": reference.width_px,
            "height_px": reference.height_px, "item_radius_px": reference.item_radius_px}
    entities = entities_of(reference)
    if snapshot.tile_px == 0:
        return {**content, **present(entities)}
    return {**content, "tile_px": snapshot.tile_px,
            "tiles": [expected_tile(entities, snapshot, tile) for tile in snapshot.tiles]}


def is_keyframe(snapshot):
    return snapshot.base_sequence == 0 and all(tile.base_sequence == 0 for tile in snapshot.tiles)


def with_one_bit_wrong(body, snapshot):
    part = max([snapshot.body, *(tile.body for tile in snapshot.tiles)], key=len)
    assert body.count(part) == 1
    at = body.index(part) + len(part) // 2
    return body[:at] + bytes([body[at] ^ 1]) + body[at + 1:]


def vectors_of(recorder):
    """[(frame, head of its line, decoded content)] of all cases."""
    fixed = {run_id: bytes([number]) * 16 for number, run_id in enumerate(recorder.run_ids, 1)}
    vectors = []
    for case, subscription in recorder.cases.items():
        run_id = {}  # by island: of its last keyframe
        waits = False  # for a keyframe
        for number, body in enumerate(recorder.bodies[subscription]):
            snapshot = stream_pb2.SnapshotFrame.FromString(body)
            run_id[snapshot.island] = snapshot.run_id or run_id[snapshot.island]
            reference = recorder.reference[run_id[snapshot.island], snapshot.island, snapshot.tick]
            decoded = expected(snapshot, reference)
            decoded["run_id"] = fixed[run_id[snapshot.island]].hex()
            if snapshot.run_id:
                assert body.count(snapshot.run_id) == 1
                body = body.replace(snapshot.run_id, fixed[snapshot.run_id])
            damaged = recorder.damaged.get(case) == number
            if damaged:
                body = with_one_bit_wrong(body, snapshot)
            waits = damaged or waits and not is_keyframe(snapshot)
            frame = b"EV\x01\x02" + struct.pack("<I", len(body)) + body
            head = {"case": case, "codec": stream_pb2.Codec.Name(snapshot.codec), "frame_bytes": len(frame),
                    "frame_crc32": zlib.crc32(frame)}
            vectors.append((frame, head, {"refused": True} if waits else decoded))
    return vectors


def record(scenario):
    """Vectors of which two successive recordings are equal."""
    before = None
    for _ in range(RECORDINGS_MAX):
        server = plain.Server("--seed", "1")
        try:
            vectors = vectors_of(scenario(server))
        finally:
            server.end()
        if vectors == before:
            return vectors
        before = vectors
    raise AssertionError(f"{scenario.__name__}: no two successive recordings are equal: is the machine busy?")


def assert_decoded(vectors):
    """Checks that the decoder of docs/PROTOCOL.md gives the same."""
    decoders = {}
    for frame, head, decoded in vectors:
        snapshot = stream_pb2.SnapshotFrame.FromString(frame[8:])
        if snapshot.codec == PLAIN:
            continue
        of = TilesDecoder if snapshot.tile_px else Decoder
        decoder = decoders.setdefault((head["case"], snapshot.island), of(plain.zstd_content))
        try:
            seen = decoder.decode(snapshot)
        except ValueError:
            assert decoded == {"refused": True}, head
            continue
        parts = [(decoded, seen)]
        if snapshot.tile_px:
            assert list(seen) == [tile["tile"] for tile in decoded["tiles"]], head
            parts = [(tile, seen[tile["tile"]]) for tile in decoded["tiles"]]
        for content, entities in parts:
            for kind, columns in entities.items():
                if content.get("detail") == "DETAIL_DENSITY":
                    assert columns.tolist() == content[kind], (head, kind)
                    continue
                assert len(columns["x"]) == len(content.get(kind, {"x": []})["x"]), (head, kind)
                for column, numbers in content.get(kind, {}).items():
                    assert columns[column].tolist() == numbers, (head, kind, column)


def main():
    vectors = [vector for scenario in SCENARIOS for vector in record(scenario)]
    assert_decoded(vectors)
    lines, line_of = [], {}  # by what is decoded: the number of its first line
    for _, head, decoded in vectors:
        text = json.dumps(decoded, separators=(",", ":"))
        same = line_of.setdefault(text, len(lines) + 1)
        content = decoded if same > len(lines) or len(decoded) == 1 else {"same_as_line": same}
        lines.append(json.dumps({**head, **content}, separators=(",", ":")) + "\n")
    files = {"snapshots.frames": b"".join(frame for frame, _, _ in vectors), "snapshots.jsonl": "".join(lines).encode()}
    for name, content in files.items():
        path = FOLDER / name
        if not CHECK:
            FOLDER.mkdir(exist_ok=True)
            path.write_bytes(content)
        elif path.read_bytes() != content:
            sys.exit(f"{path} is not what the server sends now")
    print(f"{len(vectors)} frames, " + ", ".join(f"{name} {len(content)} bytes" for name, content in files.items()))


if __name__ == "__main__":
    main()
