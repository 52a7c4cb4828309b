// Delta codec (CODEC_DELTA): decodes the body of a snapshot or of a tile at DETAIL_FULL, which contains residuals
// against the previous one predicted at constant velocity. stream.proto describes the layout;
// proto/codec/delta_codec.cpp is the model. All arithmetic is modulo 2^32.
//
// Ownership    Columns of a Section do not change after decode_body() returned them, except dx and dy, which belong to
//              the decoder. Two successive sections share the columns that are equal, such as the ids when no entity
//              has come or gone. After DamagedData the baseline must not be used again.
// Bounds       Memory is bounded by the length of the body and of the baseline, not by the counts that a message
//              states.
import {BodyReader} from "./body";
import {DamagedData} from "./errors";

const some_are_gone = 1, some_have_come = 2, have_headings = 4, have_species = 8; // flags in the parts of a section

/** The entities of one kind. Absent columns are null. */
export interface Section {
  count: number;
  id: Uint32Array|null;
  x: Int32Array;
  y: Int32Array;
  width: Int32Array|null; // radius, or half width
  height: Int32Array|null; // health, or half height
  heading: Uint8Array|null;
  species: Uint8Array|null;
  dx: Int32Array|null; // movement since the previous snapshot; 0 for new entities
  dy: Int32Array|null;
}

export interface Kind {
  name: "organisms"|"food"|"poison"|"crates"|"obstacles";
  has_ids: boolean; // on a whole island; in a tile all kinds have ids
  moves: boolean;
  has_sizes: boolean;
  has_health: boolean;
}

/** In the order of all encodings. */
export const kinds: readonly Kind[] = [
  {name: "organisms", has_ids: true, moves: true, has_sizes: true, has_health: true},
  {name: "food", has_ids: true, moves: false, has_sizes: false, has_health: false},
  {name: "poison", has_ids: true, moves: false, has_sizes: false, has_health: false},
  {name: "crates", has_ids: false, moves: true, has_sizes: true, has_health: false},
  {name: "obstacles", has_ids: false, moves: false, has_sizes: true, has_health: false},
];

/** The data from which the next snapshot is predicted. */
export interface Baseline {
  ticks: number; // over which the displacements were measured
  position_bytes: number;
  sections: Section[]; // in the order of `kinds`
}

const no_numbers = new Int32Array(0);

function empty_section(kind: Kind, has_ids: boolean): Section {
  const numbers = kind.moves ? no_numbers : null, sizes = kind.has_sizes ? no_numbers : null;
  return {
    count: 0,
    id: has_ids ? new Uint32Array(0) : null,
    x: no_numbers,
    y: no_numbers,
    width: sizes,
    height: sizes,
    heading: null,
    species: null,
    dx: numbers,
    dy: numbers
  };
}

/** Decodes a body.
 *
 *  counts  the numbers of entities that the message states, in the order of `kinds`.
 *  base    the baseline of a delta, which must not be used afterwards; null for a keyframe. */
export function decode_body(
  body: Uint8Array, counts: number[], position_bytes: number, of_tile: boolean, base: Baseline|null): Baseline {
  if (base !== null && base.position_bytes !== position_bytes) {
    throw new DamagedData("a snapshot's position_bytes differ from those of its base");
  }
  const reader = new BodyReader(body);
  const ticks = reader.u16(), base_ticks = Math.max(base === null ? 0 : base.ticks, 1);
  const sections = kinds.map((kind, k) => {
    const has_ids = kind.has_ids || of_tile;
    const before = base === null ? empty_section(kind, has_ids) : base.sections[k];
    return read_section(kind, has_ids, reader, before, counts[k], position_bytes, ticks, base_ticks);
  });
  reader.end();
  return {ticks: base === null || ticks > 0 ? ticks : base.ticks, position_bytes, sections};
}

function read_section(
  kind: Kind, has_ids: boolean, reader: BodyReader, base: Section, count: number, position_bytes: number, ticks: number,
  base_ticks: number): Section {
  const parts = reader.u8(), parts_max = kind.has_health ? 15 : 3; // only organisms have headings and species
  if (parts > parts_max) {
    throw new DamagedData(`a snapshot's body has parts ${parts}, not 0 to ${parts_max}`);
  }
  const headings = (parts & have_headings) !== 0;
  if (base.count > 0 && count > 0 && headings !== (base.heading !== null)) {
    throw new DamagedData("only one of a snapshot and its base has headings");
  }
  if (base.count > 0 && count > 0 && ((parts & have_species) !== 0) !== (base.species !== null)) {
    throw new DamagedData("only one of a snapshot and its base has species");
  }
  let section = base;
  if (parts & some_are_gone) {
    const gone_count = reader.u32();
    if (gone_count > base.count) {
      throw new DamagedData("a snapshot removes more entities than its base has");
    }
    section = without(base, reader.rising_column(gone_count, base.count));
  }
  const come = parts & some_have_come ? read_come(kind, has_ids, parts, reader, count, position_bytes) : null;
  const stayed = section.count, whole = stayed + (come === null ? 0 : come.count);
  if (whole !== count) {
    throw new DamagedData(`a snapshot has ${whole} ${kind.name}, not ${count} as its count says`);
  }
  if (stayed > 0 && (kind.moves || headings)) {
    section = {...section};
    if (kind.moves) {
      section.x = moved(reader.column(stayed), section.x, section.dx!, stayed, ticks, base_ticks, position_bytes);
      section.y = moved(reader.column(stayed), section.y, section.dy!, stayed, ticks, base_ticks, position_bytes);
    }
    if (kind.has_health) {
      section.height = changed_health(reader.column(stayed), section.height!, stayed);
    }
    if (headings) {
      section.heading = turned(reader.column(stayed), section.heading!, stayed);
    }
  }
  return come === null || come.count === 0 ? section : stayed === 0 ? come : merged(section, come);
}

function read_come(
  kind: Kind, has_ids: boolean, parts: number, reader: BodyReader, count_max: number,
  position_bytes: number): Section {
  const count = reader.u32();
  // Each entity needs at least the bytes of its position, so the remaining bytes limit the memory that is allocated.
  if (count > count_max || count * 2 * position_bytes > reader.rest_bytes()) {
    throw new DamagedData("a snapshot adds more entities than its count says");
  }
  const planes = (width: number): Int32Array => {
    const numbers = new Int32Array(count);
    reader.planes(count, width, numbers);
    return numbers;
  };
  const id = has_ids ? reader.rising_column(count, 2 ** 32) : null;
  const x = planes(position_bytes), y = planes(position_bytes);
  const width = kind.has_sizes ? planes(2) : null, height = kind.has_sizes ? planes(2) : null;
  const bytes = (): Uint8Array => {
    const numbers = new Uint8Array(count);
    reader.planes(count, 1, numbers);
    return numbers;
  };
  const heading = parts & have_headings ? bytes() : null, species = parts & have_species ? bytes() : null;
  const dx = kind.moves ? reader.column(count).slice(0, count) : null;
  const dy = kind.moves ? reader.column(count).slice(0, count) : null;
  return {count, id, x, y, width, height, heading, species, dx, dy};
}

/** Returns the new positions, and replaces the displacements unless ticks is 0.
 *
 *  The prediction is the displacement times `ticks` divided by `base_ticks`, rounded down. The product is at most 2^47
 *  and base_ticks is below 2^16, so the floating-point quotient is never rounded up to the next whole number. */
function moved(
  residuals: Int32Array, positions: Int32Array, displacements: Int32Array, count: number, ticks: number,
  base_ticks: number, position_bytes: number): Int32Array {
  const to = new Int32Array(count);
  let bits = 0; // all positions, combined with OR
  if (ticks === base_ticks) {
    for (let i = 0; i < count; ++i) {
      const way = residuals[i] + displacements[i] | 0, position = positions[i] + way | 0;
      displacements[i] = way;
      to[i] = position;
      bits |= position;
    }
  } else {
    for (let i = 0; i < count; ++i) {
      const way = residuals[i] + Math.floor(displacements[i] * ticks / base_ticks) | 0;
      const position = positions[i] + way | 0;
      if (ticks > 0) {
        displacements[i] = way;
      }
      to[i] = position;
      bits |= position;
    }
  }
  if (position_bytes === 2 && (bits & ~0xffff) !== 0) {
    throw new DamagedData("a snapshot moves a position out of its range");
  }
  return to;
}

function changed_health(differences: Int32Array, health: Int32Array, count: number): Int32Array {
  const to = new Int32Array(count);
  let bits = 0;
  for (let i = 0; i < count; ++i) {
    bits |= to[i] = health[i] + differences[i];
  }
  if ((bits & ~0xffff) !== 0) {
    throw new DamagedData("a snapshot moves a health out of its range");
  }
  return to;
}

function turned(differences: Int32Array, headings: Uint8Array, count: number): Uint8Array {
  const to = new Uint8Array(count); // stores numbers modulo 256
  for (let i = 0; i < count; ++i) {
    to[i] = headings[i] + differences[i];
  }
  return to;
}

// ---- entities that are gone or have come ---------------------------------------------------------------------------
//
// The loops over Int32Array and Uint8Array are separate functions, because a loop that meets both is several times
// slower.

/** Returns the section with the columns that numbers() and bytes() make of its columns. Ids pass as the Int32Array of
 *  the same bits. */
function with_columns(
  section: Section, count: number, numbers: (column: Int32Array, name: keyof Section) => Int32Array,
  bytes: (column: Uint8Array, name: "heading"|"species") => Uint8Array): Section {
  const of = (name: "width"|"height"|"dx"|"dy") => {
    const column = section[name];
    return column === null ? null : numbers(column, name);
  };
  return {
    count,
    id: section.id === null ? null : as_uint32(numbers(as_int32(section.id), "id")),
    x: numbers(section.x, "x"),
    y: numbers(section.y, "y"),
    width: of("width"),
    height: of("height"),
    heading: section.heading === null ? null : bytes(section.heading, "heading"),
    species: section.species === null ? null : bytes(section.species, "species"),
    dx: of("dx"),
    dy: of("dy")
  };
}

export function as_int32(column: Uint32Array): Int32Array {
  return new Int32Array(column.buffer, column.byteOffset, column.length);
}

export function as_uint32(column: Int32Array): Uint32Array {
  return new Uint32Array(column.buffer, column.byteOffset, column.length);
}

/** Returns the section without the entities at `gone`, which are rising. */
function without(section: Section, gone: Uint32Array): Section {
  const count = section.count - gone.length;
  const kept = with_columns(
    section, count, (column) => numbers_without(column, gone, count), (column) => bytes_without(column, gone, count));
  if (count === 0) {
    kept.heading = kept.species = null; // the next organisms may have headings and species or not
  }
  return kept;
}

function numbers_without(column: Int32Array, gone: Uint32Array, count: number): Int32Array {
  const to = new Int32Array(count);
  for (let at = 0, from = 0, next = 0; next <= gone.length; ++next) {
    const until = next < gone.length ? gone[next] : column.length;
    for (; from < until; ++from) {
      to[at++] = column[from];
    }
    ++from;
  }
  return to;
}

function bytes_without(column: Uint8Array, gone: Uint32Array, count: number): Uint8Array {
  const to = new Uint8Array(count);
  for (let at = 0, from = 0, next = 0; next <= gone.length; ++next) {
    const until = next < gone.length ? gone[next] : column.length;
    for (; from < until; ++from) {
      to[at++] = column[from];
    }
    ++from;
  }
  return to;
}

/** Inserts the entities `come` into `stayed`: ordered by id, or at the end if the kind has no ids. */
function merged(stayed: Section, come: Section): Section {
  const places = places_of(stayed, come);
  const added = (name: keyof Section) => name === "id" ? as_int32(come.id!) : come[name] as Int32Array;
  return with_columns(
    stayed, stayed.count + come.count, (column, name) => merged_numbers(column, added(name), places),
    (column, name) => merged_bytes(column, come[name]!, places));
}

/** Returns for each entity of `come` the index in `stayed` before which it is inserted. */
function places_of(stayed: Section, come: Section): Uint32Array {
  const places = new Uint32Array(come.count);
  if (stayed.id === null) {
    return places.fill(stayed.count);
  }
  const a = stayed.id, b = come.id!;
  for (let i = 0, j = 0; j < b.length; ++j) {
    while (i < a.length && a[i] < b[j]) {
      ++i;
    }
    if (i < a.length && a[i] === b[j]) {
      throw new DamagedData(`a snapshot adds id ${a[i]}, which its base already has`);
    }
    places[j] = i;
  }
  return places;
}

function merged_numbers(stayed: Int32Array, come: Int32Array, places: Uint32Array): Int32Array {
  const to = new Int32Array(stayed.length + come.length);
  let at = 0, from = 0;
  for (let j = 0; j < come.length; ++j) {
    for (const until = places[j]; from < until; ++from) {
      to[at++] = stayed[from];
    }
    to[at++] = come[j];
  }
  to.set(stayed.subarray(from), at);
  return to;
}

function merged_bytes(stayed: Uint8Array, come: Uint8Array, places: Uint32Array): Uint8Array {
  const to = new Uint8Array(stayed.length + come.length);
  let at = 0, from = 0;
  for (let j = 0; j < come.length; ++j) {
    for (const until = places[j]; from < until; ++from) {
      to[at++] = stayed[from];
    }
    to[at++] = come[j];
  }
  to.set(stayed.subarray(from), at);
  return to;
}
