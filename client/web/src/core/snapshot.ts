// Snapshot: the state of one island at one tick, as the decoder returns it and the renderer draws it.
//
// Positions, radii, half sizes and health are whole numbers of 1/16 px or 1/16; headings are 1/256 of a full turn, from
// +x toward +y. All columns of a kind have the same length. Row i of each column describes the same entity.

import type {LiveStatistics, RunState, Speed} from "./protocol";

export const steps_per_px = 16;

export interface Organisms {
  id: Uint32Array; // rising
  x: Int32Array; // centre
  y: Int32Array;
  radius: Int32Array;
  health: Int32Array;
  heading: Uint8Array|null; // null: the organisms have no headings
  species: Uint8Array|null; // 0: prey, 1: predators; null: the world has no predators
}

export interface Items {
  id: Uint32Array; // rising
  x: Int32Array;
  y: Int32Array;
}

export interface Boxes {
  x: Int32Array;
  y: Int32Array;
  half_width: Int32Array;
  half_height: Int32Array;
}

/** A tile that arrived as dots or as densities. Tiles in full detail are merged into the columns of the snapshot. */
export interface CoarseTile {
  index: number;
  left_px: number;
  top_px: number;
  width_px: number; // smaller than the side of a tile at the right and lower walls
  height_px: number;
  dots: {organisms: Dots; food: Dots; poison: Dots; crates: Dots; obstacles: Dots}|null;
  density: {cells: number; organisms: Int32Array; food: Int32Array; poison: Int32Array}|
    null; // cells x cells, row after row
}

export interface Dots {
  x_px: Float32Array;
  y_px: Float32Array;
}

/** What a snapshot says besides its entities. */
export interface SnapshotInfo {
  world: string;
  run_id: string; // 32 hexadecimal digits
  island: number;
  island_count: number;
  sequence: number;
  tick: number;
  generation: number;
  generation_tick: number;
  simulated_s: number;
  state: RunState;
  speed: Speed|undefined;
  state_hash: string; // 32 hexadecimal digits
  width_px: number;
  height_px: number;
  item_radius_px: number;
  tile_px: number; // side of the tiles; 0: the snapshot has no tiles
  live: LiveStatistics|undefined;
  ticks_per_s: number;
  slowed: boolean;
  dropped_count: number;
  counts: {organisms: number; food: number; poison: number; crates: number; obstacles: number}; // of the whole island
}

export interface Snapshot {
  info: SnapshotInfo;
  organisms: Organisms;
  food: Items;
  poison: Items;
  crates: Boxes;
  obstacles: Boxes;
  coarse: CoarseTile[]; // empty unless the subscription has a view and the server reduced the detail
}
