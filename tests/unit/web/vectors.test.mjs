// The test vectors of docs/PROTOCOL.md: every frame of proto/vectors decodes exactly to the content of its line.
import assert from "node:assert/strict";
import { test } from "node:test";
import { core, kinds, read_vectors } from "./support.mjs";

const vectors = read_vectors();

/** The columns of each kind that has entities. */
function entities_of(snapshot, with_ids) {
  const entities = {};
  for (const kind of kinds) {
    const columns = Object.entries(snapshot[kind]).filter(([name, column]) => column !== null && (name !== "id" || with_ids || kind !== "crates"));
    if (snapshot[kind].x.length > 0) {
      entities[kind] = Object.fromEntries(columns.map(([name, column]) => [name, Array.from(column)]));
    }
  }
  return entities;
}

function coarse_of(tile, tile_px) {
  const unit = tile_px / 256;
  if (tile.density !== null) {
    const { cells } = tile.density;
    const rows = (column) => Array.from({ length: cells }, (_, row) => Array.from(column.slice(row * cells, (row + 1) * cells)));
    return { tile: tile.index, detail: "DETAIL_DENSITY", cells, organisms: rows(tile.density.organisms),
             food: rows(tile.density.food), poison: rows(tile.density.poison) };
  }
  const content = { tile: tile.index, detail: "DETAIL_DOTS" };
  for (const kind of kinds.filter((name) => tile.dots[name].x_px.length > 0)) {
    content[kind] = { x: Array.from(tile.dots[kind].x_px, (x) => (x - tile.left_px) / unit - 0.5),
                      y: Array.from(tile.dots[kind].y_px, (y) => (y - tile.top_px) / unit - 0.5) };
  }
  return content;
}

/** What the tiles of a line contain: those at less detail, and the entities of those at full detail with rising ids. */
function together(tiles) {
  const coarse = tiles.filter((tile) => tile.detail !== "DETAIL_FULL"), entities = {};
  for (const kind of kinds) {
    const rows = tiles.filter((tile) => tile.detail === "DETAIL_FULL" && tile[kind] !== undefined).flatMap((tile) =>
      tile[kind].id.map((_, i) => Object.fromEntries(Object.entries(tile[kind]).map(([name, column]) => [name, column[i]]))));
    rows.sort((a, b) => a.id - b.id);
    if (rows.length > 0) {
      // The snapshot of the page has no ids of boxes.
      const names = Object.keys(rows[0]).filter((name) => name !== "id" || !(kind === "crates" || kind === "obstacles"));
      entities[kind] = Object.fromEntries(names.map((name) => [name, rows.map((row) => row[name])]));
    }
  }
  return { coarse, entities };
}

test("frames have the listed size and checksum", () => {
  for (const vector of vectors) {
    const frame = new Uint8Array(8 + vector.body.length);
    frame.set([0x45, 0x56, 1, 2]);
    new DataView(frame.buffer).setUint32(4, vector.body.length, true);
    frame.set(vector.body, 8);
    assert.equal(frame.length, vector.frame_bytes, vector.name);
    assert.equal(core.crc32(frame), vector.frame_crc32, vector.name);
    assert.equal(vector.frame.codec, vector.codec, vector.name);
  }
});

test("frames decode to the listed values", () => {
  const decoders = new Map();
  let decoded = 0;
  for (const vector of vectors) {
    const key = `${vector.case} ${vector.frame.island ?? 0}`;
    if (!decoders.has(key)) {
      decoders.set(key, new core.SnapshotDecoder());
    }
    const decoder = decoders.get(key);
    // Cases without a compressed body are decoded; the others are refused with the reason, or because their base is one.
    if (vector.codec !== "CODEC_DELTA" || vector.case.endsWith("_zstd") || "refused" in vector.decoded) {
      if (!vector.case.endsWith("_zstd")) {
        assert.throws(() => decoder.decode(vector.frame), core.DamagedData, vector.name);
      }
      continue;
    }
    const snapshot = decoder.decode(vector.frame), { info } = snapshot, expected = { ...vector.decoded };
    const about = ["world", "run_id", "island", "island_count", "tick", "generation", "generation_tick", "width_px", "height_px",
                   "item_radius_px"];
    const seen = Object.fromEntries(about.map((field) => [field, info[field]]));
    Object.assign(seen, entities_of(snapshot, true));
    if ("tiles" in expected) {
      const { coarse, entities } = together(expected.tiles);
      expected.tiles = coarse;
      Object.assign(expected, entities);
      seen.tile_px = info.tile_px;
      seen.tiles = snapshot.coarse.map((tile) => coarse_of(tile, info.tile_px));
    }
    assert.deepEqual(seen, expected, vector.name);
    ++decoded;
  }
  assert.ok(decoded > 50, `only ${decoded} frames were decoded`);
});

test("a compressed snapshot is refused with the reason", () => {
  const vector = vectors.find(({ frame }) => frame.compression === "COMPRESSION_ZSTD" && !frame.base_sequence);
  assert.throws(() => new core.SnapshotDecoder().decode(vector.frame),
                { name: "DamagedData", message: /COMPRESSION_ZSTD; this page decodes only uncompressed snapshots/ });
});

test("a plain snapshot is refused with the reason", () => {
  const vector = vectors.find(({ codec }) => codec === "CODEC_PLAIN");
  assert.throws(() => new core.SnapshotDecoder().decode(vector.frame),
                { name: "DamagedData", message: "a snapshot's codec is CODEC_PLAIN; this page decodes only CODEC_DELTA" });
});

test("decoded columns do not change later", () => {
  const decoder = new core.SnapshotDecoder(), kept = [];
  for (const vector of vectors.filter((one) => one.case === "life_deltas")) {
    const snapshot = decoder.decode(vector.frame);
    kept.push([snapshot, structuredClone(snapshot)]);
  }
  assert.ok(kept.length > 5);
  for (const [snapshot, copy] of kept) {
    assert.deepEqual(snapshot, copy);
  }
});
