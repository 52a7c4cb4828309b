// Interpolator: the latest two snapshots of an island, and positions interpolated between them. The rules are those of
// evoview (client/core/snapshot_interpolator.h), so both show an organism at the same place.
//
// The drawn state is one snapshot behind: organisms move from their position in the previous snapshot to their position
// in the latest one. Positions are never extrapolated. The two kept snapshots are copies, whose memory is used again.
import type {Boxes, CoarseTile, Dots, Items, Snapshot, SnapshotInfo} from "../core/snapshot";
import {steps_per_px} from "../core/snapshot";

/** Two snapshots are interpolated only if they are at most this far apart in simulated time: over longer times the real
 *  paths are not straight lines. At 30 snapshots per second, 2 s between snapshots is a speed of 60 times real time. */
export const blended_s_max = 2;
/** The interpolation takes as long as the interval between the arrivals of the two snapshots, but at most this long. */
export const glide_ms_max = 250;

const predator = 1; // SPECIES_PREDATOR of world.proto

type Column = Int32Array|Uint32Array|Uint8Array;

/** Returns the column, or a larger one without its contents if it is too small. */
export function with_room<Kind extends Column>(column: Kind, count: number): Kind {
  if (column.length >= count) {
    return column;
  }
  const Made = column.constructor as new (length: number) => Kind;
  return new Made(Math.max(count, 2 * column.length, 256));
}

/** Points, in steps. */
export class Points {
  count = 0;
  whole = 0; // the first of them have ids; the others are streamed as dots
  id = new Uint32Array(0);
  x = new Int32Array(0);
  y = new Int32Array(0);

  set(items: Items|null, coarse: readonly CoarseTile[], of_tile: (dots: NonNullable<CoarseTile["dots"]>) => Dots):
    void {
    this.whole = items === null ? 0 : items.x.length;
    this.count = this.whole;
    for (const {dots} of coarse) {
      this.count += dots === null ? 0 : of_tile(dots).x_px.length;
    }
    this.id = with_room(this.id, this.whole);
    this.x = with_room(this.x, this.count);
    this.y = with_room(this.y, this.count);
    if (items !== null) {
      this.id.set(items.id);
      this.x.set(items.x);
      this.y.set(items.y);
    }
    let at = this.whole;
    for (const {dots} of coarse) {
      if (dots !== null) {
        const {x_px, y_px} = of_tile(dots);
        for (let i = 0; i < x_px.length; ++i, ++at) {
          this.x[at] = Math.round(x_px[i]! * steps_per_px);
          this.y[at] = Math.round(y_px[i]! * steps_per_px);
        }
      }
    }
  }
}

export class KeptBoxes {
  count = 0;
  x = new Int32Array(0);
  y = new Int32Array(0);
  half_width = new Int32Array(0);
  half_height = new Int32Array(0);

  set(boxes: Boxes): void {
    this.count = boxes.x.length;
    for (const name of ["x", "y", "half_width", "half_height"] as const) {
      this[name] = with_room(this[name], this.count);
      this[name].set(boxes[name]);
    }
  }
}

/** The densities of the tiles, as one grid per tile. */
export interface TileDensity {
  left_px: number;
  top_px: number;
  width_px: number;
  height_px: number;
  cells: number;
  organisms: Int32Array;
}

/** A copy of a snapshot. */
export class KeptSnapshot {
  info: SnapshotInfo|null = null;
  count = 0; // organisms in full detail
  id = new Uint32Array(0);
  x = new Int32Array(0);
  y = new Int32Array(0);
  radius = new Int32Array(0);
  health = new Int32Array(0);
  heading = new Uint8Array(0);
  has_headings = false;
  species = new Uint8Array(0);
  has_species = false;
  readonly food = new Points();
  readonly poison = new Points();
  readonly crates = new KeptBoxes();
  readonly obstacles = new KeptBoxes();
  readonly organism_dots = new Points();
  readonly crate_dots = new Points();
  readonly obstacle_dots = new Points();
  densities: TileDensity[] = []; // of the tiles that arrived as densities

  set(snapshot: Snapshot): void {
    const {organisms, coarse} = snapshot;
    this.info = snapshot.info;
    const count = (this.count = organisms.id.length);
    this.id = with_room(this.id, count);
    this.id.set(organisms.id);
    for (const name of ["x", "y", "radius", "health"] as const) {
      this[name] = with_room(this[name], count);
      this[name].set(organisms[name]);
    }
    this.has_headings = organisms.heading !== null;
    if (organisms.heading !== null) {
      this.heading = with_room(this.heading, count);
      this.heading.set(organisms.heading);
    }
    this.has_species = organisms.species !== null;
    if (organisms.species !== null) {
      this.species = with_room(this.species, count);
      this.species.set(organisms.species);
    }
    this.food.set(snapshot.food, coarse, (dots) => dots.food);
    this.poison.set(snapshot.poison, coarse, (dots) => dots.poison);
    this.crates.set(snapshot.crates);
    this.obstacles.set(snapshot.obstacles);
    this.organism_dots.set(null, coarse, (dots) => dots.organisms);
    this.crate_dots.set(null, coarse, (dots) => dots.crates);
    this.obstacle_dots.set(null, coarse, (dots) => dots.obstacles);
    this.densities.length = 0;
    for (const {density, left_px, top_px, width_px, height_px} of coarse) {
      if (density !== null) {
        this.densities.push(
          {left_px, top_px, width_px, height_px, cells: density.cells, organisms: density.organisms.slice()});
      }
    }
  }

  is_predator(row: number): boolean {
    return this.has_species && this.species[row] === predator;
  }

  /** Returns the row of an organism; -1 if it is not there. */
  index_of(id: number|null): number {
    let low = 0;
    let high = this.count;
    if (id === null) {
      return -1;
    }
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.id[middle]! < id) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    return low < this.count && this.id[low] === id ? low : -1;
  }
}

/** Whether `next` continues what `last` showed. */
export function continues(next: SnapshotInfo, last: SnapshotInfo): boolean {
  return next.run_id === last.run_id && next.world === last.world && next.island === last.island &&
    next.generation === last.generation && next.tick >= last.tick;
}

export class Interpolator {
  latest = new KeptSnapshot();
  previous: KeptSnapshot|null = null;
  /** For each organism, its row in `previous`, or -1. */
  match = new Int32Array(0);
  #spare = new KeptSnapshot();
  #arrived_ms = 0;
  #glide_ms = 0;

  /** Adds a snapshot. It is not interpolated if it belongs to another run or generation than the one before, or to an
   *  earlier tick. A snapshot of the same tick, with another region or level of detail, replaces the latest. */
  add(snapshot: Snapshot, now_ms: number): void {
    const last = this.latest.info;
    const is_next =
      last !== null && continues(snapshot.info, last) && snapshot.info.simulated_s - last.simulated_s <= blended_s_max;
    if (!(is_next && this.previous !== null && snapshot.info.tick === last.tick)) {
      this.#glide_ms = Math.min(now_ms - this.#arrived_ms, glide_ms_max);
      const freed = this.previous ?? this.#spare;
      this.previous = is_next ? this.latest : null;
      if (!is_next) {
        this.#spare = this.latest;
      }
      this.latest = freed;
      this.#arrived_ms = now_ms;
    }
    this.latest.set(snapshot);
    this.#find_matches();
  }

  clear(): void {
    this.previous = null;
    this.latest = new KeptSnapshot();
    this.#spare = new KeptSnapshot();
  }

  /** Returns the progress of the interpolation: 0 draws the positions in `previous`, 1 those in `latest`. Returns 1 if
   *  the latest snapshot is not interpolated, and while the world does not run. */
  blend_at(now_ms: number): number {
    if (this.previous === null || this.#glide_ms <= 0 || this.latest.info?.state !== "RUN_STATE_RUNNING") {
      return 1;
    }
    return Math.min(Math.max((now_ms - this.#arrived_ms) / this.#glide_ms, 0), 1);
  }

  /** The simulated time that is drawn. */
  shown_s(blend: number): number {
    const now_s = this.latest.info?.simulated_s ?? 0;
    const before_s = this.previous?.info?.simulated_s ?? now_s;
    return now_s - (1 - blend) * (now_s - before_s);
  }

  /** Returns the x coordinate of organism i in steps. An organism without a match keeps its position in `latest`. */
  x_at(i: number, blend: number): number {
    const j = this.previous === null ? -1 : this.match[i]!;
    const to = this.latest.x[i]!;
    return j < 0 ? to : this.previous!.x[j]! + (to - this.previous!.x[j]!) * blend;
  }

  y_at(i: number, blend: number): number {
    const j = this.previous === null ? -1 : this.match[i]!;
    const to = this.latest.y[i]!;
    return j < 0 ? to : this.previous!.y[j]! + (to - this.previous!.y[j]!) * blend;
  }

  #find_matches(): void {
    if (this.previous === null) {
      return;
    }
    const {id, count} = this.latest;
    const among = this.previous;
    this.match = with_room(this.match, count);
    for (let i = 0, j = 0; i < count; ++i) {
      while (j < among.count && among.id[j]! < id[i]!) {
        ++j;
      }
      this.match[i] = j < among.count && among.id[j] === id[i] ? j : -1;
    }
  }
}
