// Snapshot decoder: converts the SnapshotFrame messages of one island of one subscription into snapshots, in the order
// in which they arrive. It decodes CODEC_DELTA without compression, with and without tiles.
//
// It checks everything that proto/codec/snapshot_decoder.cpp checks, and throws only DamagedData. After that, it
// refuses all deltas before the next keyframe.
//
// Ownership    A snapshot and its columns do not change after decode() returned them, so the caller may keep them as
//              long as it likes. It must not write into them: the decoder predicts the next snapshot from them, and
//              successive snapshots share the columns that are equal. A caller may compare columns by identity to find
//              those.
import {crc32} from "./crc32";
import {decode_body} from "./delta";
import type {Baseline, Section} from "./delta";
import {DamagedData} from "./errors";
import type {Detail, SnapshotFrame, SnapshotTile} from "./protocol";
import type {Boxes, CoarseTile, Items, Snapshot, SnapshotInfo} from "./snapshot";
import {coarse_tile, decode_density, decode_dots, same_layout, TileMerger, tile_layout} from "./tiles";
import type {TileLayout} from "./tiles";

/** The fields that a delta omits if they are those of its base. */
type Unchanging = Pick<SnapshotInfo, "world"|"run_id"|"island_count"|"width_px"|"height_px"|"item_radius_px">;

/** Returns whether a SnapshotFrame can be decoded without an earlier one. */
export function is_keyframe(frame: SnapshotFrame): boolean {
  return !frame.base_sequence && (frame.tiles ?? []).every((tile) => !tile.base_sequence);
}

interface Base {
  baseline: Baseline;
  sequence: number; // of the snapshot
}

type WholeBase = Base&{same: Unchanging};
type TileBases = {
  layout: TileLayout; bases: Map<number, Base>
}; // key: index of the tile

export class SnapshotDecoder {
  #whole: WholeBase|null = null;
  #tiles: TileBases|null = null;
  #merger = new TileMerger();

  /** frame: a SnapshotFrame message. */
  decode(frame: SnapshotFrame): Snapshot {
    // The baselines are taken out first. If this frame is damaged, there are none.
    const whole = this.#whole, tiles = this.#tiles;
    this.#whole = this.#tiles = null;
    if (frame.codec !== "CODEC_DELTA") {
      throw new DamagedData(`a snapshot's codec is ${frame.codec ?? "missing"}; this page decodes only CODEC_DELTA`);
    }
    return frame.tile_px ? this.#decode_tiles(frame, frame.tile_px, tiles) : this.#decode_whole(frame, whole);
  }

  #decode_whole(frame: SnapshotFrame, last: WholeBase|null): Snapshot {
    const base_sequence = frame.base_sequence ?? 0, base = base_sequence === 0 ? null : last;
    if (base_sequence !== 0 && base === null) {
      throw new DamagedData("a snapshot has an unknown base: a keyframe is needed");
    }
    check_base(base_sequence, base);
    const info = info_of(frame, base === null ? unchanging(frame) : base.same);
    const position_bytes = position_bytes_of(frame), counts = counts_of(frame);
    const body = checked_body(frame, position_bytes, 0);
    const baseline = decode_body(body, counts, position_bytes, false, base === null ? null : base.baseline);
    this.#whole = {baseline, sequence: info.sequence, same: unchanging(info)};
    return snapshot_of(info, baseline.sections, []);
  }

  #decode_tiles(frame: SnapshotFrame, tile_px: number, last: TileBases|null): Snapshot {
    const info = info_of(frame, unchanging(frame)), position_bytes = position_bytes_of(frame);
    const layout = tile_layout(tile_px, info.width_px, info.height_px), tile_count = layout.columns * layout.rows;
    const before = last !== null && same_layout(last.layout, layout) ? last.bases : null;
    const bases = new Map<number, Base>(), coarse: CoarseTile[] = [];
    let index_before = -1;
    for (const message of frame.tiles ?? []) {
      const index = message.tile ?? 0, sequence = message.sequence ?? 0;
      if (index >= tile_count || index <= index_before) {
        throw new DamagedData(`a tile's index is ${index}, allowed: rising, below ${tile_count}`);
      }
      if (sequence !== info.sequence) {
        throw new DamagedData(`a tile's sequence is ${sequence}, not that of its snapshot, ${info.sequence}`);
      }
      index_before = index;
      const detail = details.indexOf(message.detail ?? "DETAIL_UNSPECIFIED");
      if (detail < 1) {
        const allowed = details.slice(1).join(", ");
        throw new DamagedData(`a tile's detail is ${message.detail ?? "missing"}, allowed: ${allowed}`);
      }
      let base: Base|null = null;
      if (message.detail === "DETAIL_FULL" && message.base_sequence) {
        base = before?.get(index) ?? null;
        if (base === null) {
          throw new DamagedData("a tile has an unknown base: a keyframe is needed");
        }
        check_base(message.base_sequence, base);
      }
      const counts = counts_of(message);
      const body = checked_body(message, position_bytes, crc32(little_endian([tile_px, index, detail])));
      if (message.detail === "DETAIL_FULL") {
        const baseline = decode_body(body, counts, position_bytes, true, base === null ? null : base.baseline);
        bases.set(index, {sequence, baseline});
      } else {
        const tile = coarse_tile(layout, index);
        if (message.detail === "DETAIL_DOTS") {
          tile.dots = decode_dots(body, counts, tile, layout.tile_px);
        } else {
          tile.density = decode_density(body, counts);
        }
        coarse.push(tile);
      }
    }
    const sections = this.#merger.merge([...bases.values()].map((base) => base.baseline.sections));
    this.#tiles = {layout, bases};
    return snapshot_of(info, sections, coarse);
  }
}

const details: readonly Detail[] = ["DETAIL_UNSPECIFIED", "DETAIL_FULL", "DETAIL_DOTS", "DETAIL_DENSITY"]; // by number

function check_base(got: number, base: Base|null): void {
  if (base !== null && got !== base.sequence) {
    throw new DamagedData(`a snapshot's base_sequence is ${got}, not the last one, ${base.sequence}`);
  }
}

function counts_of(message: SnapshotFrame|SnapshotTile): number[] {
  return [
    message.organism_count ?? 0, message.food_count ?? 0, message.poison_count ?? 0, message.crate_count ?? 0,
    message.obstacle_count ?? 0
  ];
}

function position_bytes_of(frame: SnapshotFrame): number {
  const bytes = frame.position_bytes ?? 0;
  if (bytes !== 2 && bytes !== 4) {
    throw new DamagedData(`a snapshot's position_bytes is ${bytes}, not 2 or 4`);
  }
  return bytes;
}

function little_endian(numbers: number[]): Uint8Array {
  return new Uint8Array(new Uint32Array(numbers).buffer); // body.ts checks the order of the processor
}

function words_of(number: number): [low: number, high: number] {
  const whole = BigInt(number);
  return [Number(whole & 0xffffffffn), Number(whole >> 32n)];
}

const no_bytes = new Uint8Array(0);

/** Returns the body of a SnapshotFrame or SnapshotTile after comparing its checksum.
 *
 *  before  the checksum of the bytes that precede the fields. */
function checked_body(message: SnapshotFrame|SnapshotTile, position_bytes: number, before: number): Uint8Array {
  const compression = message.compression ?? "COMPRESSION_UNSPECIFIED";
  if (compression !== "COMPRESSION_NONE" && compression !== "COMPRESSION_UNSPECIFIED") {
    throw new DamagedData(`a snapshot's compression is ${compression}; this page decodes only uncompressed snapshots`);
  }
  const body = message.body ?? no_bytes;
  const fields = little_endian([
    ...words_of(message.sequence ?? 0), ...words_of(message.base_sequence ?? 0), ...counts_of(message), position_bytes
  ]);
  if (crc32(body, crc32(fields, before)) !== (message.checksum ?? 0)) {
    throw new DamagedData("a snapshot's checksum does not match its body");
  }
  return body;
}

/** from: a SnapshotFrame or the info of a snapshot. */
function unchanging(from: SnapshotFrame|SnapshotInfo): Unchanging {
  const {world = "", run_id = "", island_count = 0, width_px = 0, height_px = 0, item_radius_px = 0} = from;
  return {
    world,
    run_id: typeof run_id === "string" ? run_id : hexadecimal(run_id),
    island_count,
    width_px,
    height_px,
    item_radius_px
  };
}

function hexadecimal(bytes: Uint8Array|undefined): string {
  return Array.from(bytes ?? no_bytes, (byte) => byte.toString(16).padStart(2, "0")).join("");
}

/** Checks the fields that do not contain entities. */
function info_of(frame: SnapshotFrame, same: Unchanging): SnapshotInfo {
  const info: SnapshotInfo = {
    ...same,
    island: frame.island ?? 0,
    sequence: frame.sequence ?? 0,
    tile_px: frame.tile_px ?? 0,
    tick: frame.tick ?? 0,
    generation: frame.generation ?? 0,
    generation_tick: frame.generation_tick ?? 0,
    simulated_s: frame.simulated_s ?? 0,
    state: frame.state ?? "RUN_STATE_UNSPECIFIED",
    speed: frame.speed,
    state_hash: hexadecimal(frame.state_hash),
    live: frame.live,
    ticks_per_s: frame.ticks_per_s ?? 0,
    slowed: frame.slowed ?? false,
    dropped_count: frame.dropped_count ?? 0,
    counts: {
      organisms: frame.organism_count ?? 0,
      food: frame.food_count ?? 0,
      poison: frame.poison_count ?? 0,
      crates: frame.crate_count ?? 0,
      obstacles: frame.obstacle_count ?? 0
    },
  };
  if (info.island >= info.island_count) {
    throw new DamagedData(`a snapshot's island is ${info.island}, not one of ${info.island_count}`);
  }
  for (const field of ["width_px", "height_px", "item_radius_px", "simulated_s", "ticks_per_s"] as const) {
    const zero_allowed = field !== "width_px" && field !== "height_px";
    if (!Number.isFinite(info[field]) || info[field] < 0 || (info[field] === 0 && !zero_allowed)) {
      throw new DamagedData(`a snapshot's ${field} is ${info[field]}, not a finite positive number`);
    }
  }
  if (!Number.isFinite(info.live?.health_mean ?? 0)) {
    throw new DamagedData(`a snapshot's live.health_mean is ${info.live?.health_mean}, not a finite number`);
  }
  return info;
}

function snapshot_of(info: SnapshotInfo, sections: Section[], coarse: CoarseTile[]): Snapshot {
  const [organisms, food, poison, crates, obstacles] = sections;
  const items = (of: Section): Items => ({id: of.id!, x: of.x, y: of.y});
  const boxes = (of: Section): Boxes => ({x: of.x, y: of.y, half_width: of.width!, half_height: of.height!});
  return {
    info,
    organisms: {
      id: organisms.id!,
      x: organisms.x,
      y: organisms.y,
      radius: organisms.width!,
      health: organisms.height!,
      heading: organisms.heading,
      species: organisms.species
    },
    food: items(food),
    poison: items(poison),
    crates: boxes(crates),
    obstacles: boxes(obstacles),
    coarse,
  };
}
