// Changed bodies: the decoder of the page agrees with that of C++ for every line of proto/vectors/mutations.txt.
import assert from "node:assert/strict";
import { test } from "node:test";
import { core, kinds, read_vectors, vectors_file } from "./support.mjs";

const counts = ["organism_count", "food_count", "poison_count", "crate_count", "obstacle_count"];

function little_endian(...numbers) {
  return new Uint8Array(new Uint32Array(numbers).buffer);
}

function words_of(number) {
  return [Number(BigInt(number) & 0xffffffffn), Number(BigInt(number) >> 32n)];
}

/** Returns the SnapshotFrame or SnapshotTile with one change. */
function changed(message, change, where, value) {
  const body = message.body ?? new Uint8Array(0);
  const with_bytes = (...bytes) => {
    const copy = body.slice();
    copy.set(bytes, where);
    return { ...message, body: copy };
  };
  switch (change) {
    case "byte": return with_bytes(value);
    case "word": return with_bytes(...little_endian(value));
    case "cut": return { ...message, body: body.slice(0, where) };
    case "add": return { ...message, body: new Uint8Array([...body, value]) };
    case "count": return { ...message, [counts[where]]: value };
    default: throw new Error(`unknown change ${change}`);
  }
}

/** Returns the message with the checksum of its body. before: the checksum of the bytes before the fields. */
function with_checksum(message, position_bytes, before) {
  const fields = little_endian(...words_of(message.sequence ?? 0), ...words_of(message.base_sequence ?? 0),
                               ...counts.map((count) => message[count] ?? 0), position_bytes);
  return { ...message, checksum: core.crc32(message.body ?? new Uint8Array(0), core.crc32(fields, before)) };
}

function mutated(frame, tile, ...change) {
  if (tile < 0) {
    return with_checksum(changed(frame, ...change), frame.position_bytes, 0);
  }
  const tiles = frame.tiles.slice(), message = changed(tiles[tile], ...change);
  const detail = ["DETAIL_FULL", "DETAIL_DOTS", "DETAIL_DENSITY"].indexOf(message.detail) + 1;
  tiles[tile] = with_checksum(message, frame.position_bytes, core.crc32(little_endian(frame.tile_px, message.tile ?? 0, detail)));
  return { ...frame, tiles };
}

/** As checksum_of_content() in tests/unit/codec/vectors_test.cpp. */
function checksum_of_content(snapshot) {
  let crc = 0;
  const append = (column) => {
    crc = core.crc32(new Uint8Array(Uint32Array.from(column, (value) => value >>> 0).buffer), crc);
  };
  for (const kind of kinds) {
    const of = snapshot[kind];
    append([of.x.length]);
    for (const name of ["id", "x", "y", "radius", "health", "half_width", "half_height", "heading", "species"]) {
      if (of[name]) {
        append(of[name]);
      }
    }
  }
  for (const { density } of snapshot.coarse.filter((tile) => tile.density !== null)) {
    append(density.organisms);
    append(density.food);
    append(density.poison);
  }
  return crc.toString(16).padStart(8, "0");
}

test("changed bodies have the verdict of the C++ decoder", () => {
  const vectors = read_vectors(), lines = vectors_file("mutations.txt").toString().trimEnd().split("\n");
  assert.equal(lines.length, 1000);
  let chain = [], chain_of = 0; // the frames from the last keyframe up to line chain_of
  for (const text of lines) {
    const [line, tile, change, where, value, verdict] = text.split(" ");
    const vector = vectors[line - 1], { frame } = vector;
    if (chain_of !== line) {
      const before = vectors.slice(0, line - 1).filter((one) => one.case === vector.case && one.frame.island === frame.island &&
                                                                 !("refused" in one.decoded));
      chain = before.slice(Math.max(0, before.findLastIndex((one) => core.is_keyframe(one.frame)))).map((one) => one.frame);
      chain_of = line;
    }
    const decoder = new core.SnapshotDecoder();
    chain.forEach((one) => decoder.decode(one));
    let got = "damaged";
    try {
      got = checksum_of_content(decoder.decode(mutated(frame, Number(tile), change, Number(where), Number(value))));
    } catch (error) {
      assert.ok(error instanceof core.DamagedData, `${text}: ${error.stack}`);
      // After damage there is no base: all deltas are refused.
      if (!core.is_keyframe(frame)) {
        assert.throws(() => decoder.decode(frame), core.DamagedData, text);
      }
    }
    assert.equal(got, verdict, text);
  }
});
