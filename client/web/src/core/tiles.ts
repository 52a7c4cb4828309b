// Tiles: the squares into which an island is divided for subscriptions with a view. Decodes tiles at reduced detail and
// merges the entities of tiles at full detail. stream.proto describes the bodies; proto/codec/tiles.cpp is the model.
import {BodyReader} from "./body";
import {as_int32, as_uint32, kinds} from "./delta";
import type {Kind, Section} from "./delta";
import {DamagedData} from "./errors";
import type {CoarseTile, Dots} from "./snapshot";

const tile_count_max = 1 << 24; // more than the server sends; the range of the indices
const places_per_side = 256; // positions of dots within a tile

/** The tiles of an island, numbered row after row. */
export interface TileLayout {
  width_px: number;
  height_px: number;
  tile_px: number;
  columns: number;
  rows: number;
}

export function tile_layout(tile_px: number, width_px: number, height_px: number): TileLayout {
  if (tile_px === 0 || (tile_px & (tile_px - 1)) !== 0) {
    throw new DamagedData(`a snapshot's tile_px is ${tile_px}, not a power of two`);
  }
  const columns = Math.max(1, Math.ceil(width_px / tile_px)), rows = Math.max(1, Math.ceil(height_px / tile_px));
  if (columns * rows > tile_count_max) {
    throw new DamagedData(`a snapshot's tile_px is ${tile_px}, too small for its island`);
  }
  return {width_px, height_px, tile_px, columns, rows};
}

export function same_layout(a: TileLayout, b: TileLayout): boolean {
  return a.width_px === b.width_px && a.height_px === b.height_px && a.tile_px === b.tile_px;
}

/** Returns the place of a tile, without its content. */
export function coarse_tile(layout: TileLayout, index: number): CoarseTile {
  const left_px = index % layout.columns * layout.tile_px, top_px = Math.floor(index / layout.columns) * layout.tile_px;
  return {
    index,
    left_px,
    top_px,
    width_px: Math.min(layout.tile_px, layout.width_px - left_px),
    height_px: Math.min(layout.tile_px, layout.height_px - top_px),
    dots: null,
    density: null
  };
}

/** Decodes the body of a tile at DETAIL_DOTS. Each dot is in the middle of its place. */
export function decode_dots(
  body: Uint8Array, counts: number[], tile: CoarseTile, tile_px: number): NonNullable<CoarseTile["dots"]> {
  const count = counts.reduce((sum, of_kind) => sum + of_kind, 0);
  if (body.length !== 2 * count) {
    throw new DamagedData(`a tile's body is ${body.length} bytes long, not ${2 * count} as its counts say`);
  }
  const unit_px = tile_px / places_per_side;
  const in_px = (begin: number, length: number, corner_px: number): Float32Array => {
    const column = new Float32Array(length);
    for (let i = 0; i < length; ++i) {
      column[i] = corner_px + (body[begin + i] + 0.5) * unit_px;
    }
    return column;
  };
  let next = 0;
  const dots = counts.map((length): Dots => {
    const begin = next;
    next += length;
    return {x_px: in_px(begin, length, tile.left_px), y_px: in_px(count + begin, length, tile.top_px)};
  });
  return {organisms: dots[0], food: dots[1], poison: dots[2], crates: dots[3], obstacles: dots[4]};
}

/** Decodes the body of a tile at DETAIL_DENSITY. */
export function decode_density(body: Uint8Array, counts: number[]): NonNullable<CoarseTile["density"]> {
  const reader = new BodyReader(body), cells = reader.u8();
  if (![1, 2, 4, 8, 16].includes(cells)) {
    throw new DamagedData(`a density has ${cells} cells per row, not 1, 2, 4, 8 or 16`);
  }
  const [organisms, food, poison] = counts.slice(0, 3).map((count) => {
    const numbers = reader.column(cells * cells).slice(0, cells * cells);
    let sum = 0;
    for (const number of numbers) {
      sum += number >>> 0;
    }
    if (sum !== count) {
      throw new DamagedData("the cells of a density do not add up to the counts of its tile");
    }
    return numbers;
  });
  reader.end();
  return {cells, organisms, food, poison};
}

// ---- merging -------------------------------------------------------------------------------------------------------

/** Merges the entities of tiles into columns with rising ids. If no entity of a kind has changed, the columns are those
 *  of the last merge. */
export class TileMerger {
  #last: {parts: Section[]; order: Uint32Array; merged: Section}[] = []; // in the order of `kinds`

  /** tiles: the sections of each tile, in the order of `kinds`. */
  merge(tiles: Section[][]): Section[] {
    return kinds.map((kind, k) => {
      const parts = tiles.map((sections) => sections[k]).filter((section) => section.count > 0), last = this.#last[k];
      const are_same = (same: (a: Section, b: Section) => boolean) =>
        last !== undefined && last.parts.length === parts.length && parts.every((part, i) => same(part, last.parts[i]));
      if (!are_same((a, b) => a === b)) {
        const order = are_same((a, b) => a.id === b.id) ? last.order : order_of(parts);
        this.#last[k] = {parts, order, merged: merged(kind, parts, order)};
      }
      return this.#last[k].merged;
    });
  }
}

function merged(kind: Kind, parts: Section[], order: Uint32Array): Section {
  if (parts.length === 1) {
    return parts[0];
  }
  const numbers = (column: (part: Section) => Int32Array) =>
    in_order(joined(new Int32Array(order.length), parts.map(column)), order);
  const bytes = (name: "heading"|"species", names: string) => {
    const having = parts.filter((part) => part[name] !== null);
    if (having.length !== 0 && having.length !== parts.length) {
      throw new DamagedData(`only some tiles of a snapshot have ${names}`);
    }
    const all = joined(new Uint8Array(order.length), having.map((part) => part[name]!));
    return having.length === 0 ? null : Uint8Array.from(order, (i) => all[i]);
  };
  return {
    count: order.length,
    id: as_uint32(numbers((part) => as_int32(part.id!))),
    x: numbers((part) => part.x),
    y: numbers((part) => part.y),
    width: kind.has_sizes ? numbers((part) => part.width!) : null,
    height: kind.has_sizes ? numbers((part) => part.height!) : null,
    heading: bytes("heading", "headings"),
    species: bytes("species", "species"),
    dx: null,
    dy: null
  };
}

function joined<C extends Uint32Array|Int32Array|Uint8Array>(to: C, columns: C[]): C {
  let at = 0;
  for (const column of columns) {
    to.set(column, at);
    at += column.length;
  }
  return to;
}

function in_order(column: Int32Array, order: Uint32Array): Int32Array {
  const to = new Int32Array(order.length);
  for (let i = 0; i < order.length; ++i) {
    to[i] = column[order[i]];
  }
  return to;
}

const digit_bits = 11, digits = 1 << digit_bits;

/** Returns the indices of the entities of all parts, one part after another, in the order of their ids. Radix sort,
 *  lowest digit first. */
function order_of(parts: Section[]): Uint32Array {
  const columns = parts.map((part) => part.id!), count = columns.reduce((sum, column) => sum + column.length, 0);
  const ids = joined(new Uint32Array(count), columns), ends = new Uint32Array(digits);
  const id_max = columns.reduce((max, column) => Math.max(max, column[column.length - 1]), 0);
  let order = new Uint32Array(count), next = new Uint32Array(count);
  for (let i = 0; i < count; ++i) {
    order[i] = i;
  }
  for (let shift = 0; shift < 32 && (id_max >>> shift) > 0; shift += digit_bits) {
    ends.fill(0);
    for (let i = 0; i < count; ++i) {
      ++ends[ids[i] >>> shift & digits - 1];
    }
    for (let digit = 1; digit < digits; ++digit) {
      ends[digit] += ends[digit - 1];
    }
    for (let i = count - 1; i >= 0; --i) {
      next[--ends[ids[order[i]] >>> shift & digits - 1]] = order[i];
    }
    [order, next] = [next, order];
  }
  for (let i = 1; i < count; ++i) {
    if (ids[order[i]] === ids[order[i - 1]]) {
      throw new DamagedData(`a snapshot has id ${ids[order[i]]} in two tiles`);
    }
  }
  return order;
}
