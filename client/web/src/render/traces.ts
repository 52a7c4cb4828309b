// Trails: the paths of all organisms during the last simulated seconds. Flashes: meals and deaths, found by comparing
// successive snapshots. Both as in evoview (client/viewer/island/marks.h, flashes.cpp). Their memory is used again.
import type {Items, Snapshot, SnapshotInfo} from "../core/snapshot";
import {steps_per_px} from "../core/snapshot";
import {contains, Rectangle} from "./camera";
import {continues, KeptSnapshot, Points, with_room} from "./interpolator";
import {traced_max} from "./marks";

const in_region = {
  id: new Uint32Array(traced_max),
  x: new Int32Array(traced_max),
  y: new Int32Array(traced_max)
};

/** Returns the organisms that have trails; null if they are too many. On a large island that is sent whole, they are
 *  those in `region`, which a View would contain. The result is valid until the next call. */
export function traced({info, organisms}: Snapshot, region: Rectangle|null): Items|null {
  const {id, x, y} = organisms;
  if (id.length < traced_max) {
    return organisms;
  }
  if (info.tile_px > 0 || region === null) {
    return null;
  }
  const left = region.left * steps_per_px, right = left + region.width * steps_per_px;
  const top = region.top * steps_per_px, bottom = top + region.height * steps_per_px;
  let count = 0;
  for (let i = 0; i < id.length; ++i) {
    if (x[i]! >= left && x[i]! <= right && y[i]! >= top && y[i]! <= bottom) {
      in_region.id[count] = id[i]!;
      in_region.x[count] = x[i]!;
      in_region.y[count] = y[i]!;
      if (++count === traced_max) {
        return null;
      }
    }
  }
  return {id: in_region.id.subarray(0, count), x: in_region.x.subarray(0, count), y: in_region.y.subarray(0, count)};
}

export const trail_interval_s = 0.25;
export const trail_kept_s = 3;

/** The lines between the positions in two kept snapshots. */
export interface TrailSegment {
  serial: number; // changes with the lines
  from_s: number;
  to_s: number;
  lines: Int32Array; // from x, from y, to x, to y, in steps
  count: number;
}

export class Trails {
  /** Oldest first. */
  readonly segments: TrailSegment[] = [];
  /** The positions in the last kept snapshot, from which the paths lead to the present positions. */
  readonly last = new Points();
  #last_info: SnapshotInfo|null = null;
  #serial = 0;
  readonly #spare: TrailSegment[] = [];

  /** organisms: what traced() has returned. */
  add(info: SnapshotInfo, organisms: Items|null): void {
    if (organisms === null) {
      this.clear();
      return;
    }
    const {id, x, y} = organisms;
    const from = this.#last_info;
    if (from !== null && !continues(info, from)) {
      this.clear();
    } else if (from !== null && info.simulated_s - from.simulated_s < trail_interval_s - 1e-6) {
      return;
    }
    if (this.#last_info !== null) {
      const segment = this.#spare.pop() ?? {serial: 0, from_s: 0, to_s: 0, lines: new Int32Array(0), count: 0};
      segment.serial = ++this.#serial;
      segment.from_s = this.#last_info.simulated_s;
      segment.to_s = info.simulated_s;
      segment.lines = with_room(segment.lines, 4 * id.length);
      segment.count = add_paths(this.last, id, id.length, (j) => x[j]!, (j) => y[j]!, segment.lines);
      this.segments.push(segment);
    }
    while (this.segments.length > 0 && this.segments[0]!.from_s < info.simulated_s - trail_kept_s - 1e-6) {
      this.#spare.push(this.segments.shift()!);
    }
    this.#last_info = info;
    this.last.set(organisms, [], (dots) => dots.organisms);
  }

  clear(): void {
    this.#spare.push(...this.segments.splice(0));
    this.#last_info = null;
    this.last.count = this.last.whole = 0;
  }
}

/** Writes a line for each organism that is at both places; returns their number. */
export function add_paths(
  from: Points, id: Uint32Array, id_count: number, x_of: (j: number) => number, y_of: (j: number) => number,
  lines: Int32Array, scale = 1): number {
  let count = 0;
  for (let i = 0, j = 0; i < from.whole && j < id_count;) {
    if (from.id[i]! < id[j]!) {
      ++i;
    } else if (id[j]! < from.id[i]!) {
      ++j;
    } else {
      lines[4 * count] = from.x[i]! * scale;
      lines[4 * count + 1] = from.y[i]! * scale;
      lines[4 * count + 2] = x_of(j) * scale;
      lines[4 * count + 3] = y_of(j) * scale;
      ++count;
      ++i;
      ++j;
    }
  }
  return count;
}

// ---- flashes ---------------------------------------------------------------------------------------------------

export interface Flash {
  kind: "food"|"poison"|"death";
  x_px: number;
  y_px: number;
  radius_px: number; // of the item or organism
  began_s: number; // simulated time
}

export const flash_shown_s = 0.7;
/** Snapshots that are farther apart are not compared, because the flashes would last for one snapshot only. */
export const flash_compared_s_max = flash_shown_s / 2;

export class Flashes {
  /** Those that began at most flash_shown_s before the newest snapshot, oldest first. */
  all: Flash[] = [];

  /** Compares the kept snapshot with the next one.
   *
   *  within  the part of the island in which both are complete and flashes are wanted; null: the whole island */
  add(before: KeptSnapshot, next: Snapshot, within: Rectangle|null): void {
    const now_s = next.info.simulated_s;
    if (before.info === null || !continues(next.info, before.info)) {
      this.all = [];
      return;
    }
    this.all = this.all.filter((flash) => flash.began_s >= now_s - flash_shown_s);
    const has_dots = before.densities.length + before.organism_dots.count + next.coarse.length > 0;
    if (now_s - before.info.simulated_s > flash_compared_s_max || has_dots) {
      return;
    }
    const flash = (kind: Flash["kind"], x: number, y: number, radius_px: number) => {
      const place = {x: x / steps_per_px, y: y / steps_per_px};
      if (within === null || contains(within, place)) {
        this.all.push({kind, x_px: place.x, y_px: place.y, radius_px, began_s: now_s});
      }
    };
    const ids = next.organisms.id;
    for (let i = 0, j = 0; i < before.count; ++i) {
      while (j < ids.length && ids[j]! < before.id[i]!) {
        ++j;
      }
      if (!(j < ids.length && ids[j] === before.id[i])) {
        flash("death", before.x[i]!, before.y[i]!, before.radius[i]! / steps_per_px);
      }
    }
    const meals = (kind: Flash["kind"], was: Points, is: Items) => {
      for (let i = 0, j = 0; i < was.whole; ++i) {
        while (j < is.id.length && is.id[j]! < was.id[i]!) {
          ++j;
        }
        if (!(j < is.id.length && is.id[j] === was.id[i] && is.x[j] === was.x[i] && is.y[j] === was.y[i])) {
          flash(kind, was.x[i]!, was.y[i]!, next.info.item_radius_px);
        }
      }
    };
    meals("food", before.food, next.food);
    meals("poison", before.poison, next.poison);
  }

  clear(): void {
    this.all = [];
  }
}
