// Density: the number of organisms in the cells of a grid, for islands with too many organisms to see. As in evoview
// (client/viewer/island/marks.cpp).
import {steps_per_px} from "../core/snapshot";
import type {Rectangle, Size} from "./camera";
import type {Interpolator, KeptSnapshot, Points, TileDensity} from "./interpolator";
import {nice_step, ScaleTable} from "./look";
import {with_room} from "./interpolator";

/** Side of a cell on the screen, at least. */
export const density_cell_pixels = 5;
export const overview_cells_max = 60; // along the island's longer side

/** Cells are square, row after row. The memory of the counts is used again. */
export class DensityGrid {
  left_px = 0;
  top_px = 0;
  cell_px = 1;
  columns = 0;
  rows = 0;
  counts = new Uint32Array(0);

  begin(part: Rectangle, cell_px: number): void {
    this.cell_px = cell_px;
    this.left_px = Math.floor(part.left / cell_px) * cell_px;
    this.top_px = Math.floor(part.top / cell_px) * cell_px;
    this.columns = Math.ceil((part.left + part.width - this.left_px) / cell_px);
    this.rows = Math.ceil((part.top + part.height - this.top_px) / cell_px);
    this.counts = with_room(this.counts, this.columns * this.rows);
    this.counts.fill(0, 0, this.columns * this.rows);
  }

  add(x_px: number, y_px: number, amount: number): void {
    const column = Math.floor((x_px - this.left_px) / this.cell_px);
    const row = Math.floor((y_px - this.top_px) / this.cell_px);
    if (column >= 0 && row >= 0 && column < this.columns && row < this.rows) {
      this.counts[row * this.columns + column]! += amount;
    }
  }

  add_points(points: Points): void {
    for (let i = 0; i < points.count; ++i) {
      this.add(points.x[i]! / steps_per_px, points.y[i]! / steps_per_px, 1);
    }
  }

  most(): number {
    let most = 0;
    for (let i = 0, size = this.columns * this.rows; i < size; ++i) {
      most = Math.max(most, this.counts[i]!);
    }
    return most;
  }
}

/** The side of a cell in px: the smallest power of two that is at least density_cell_pixels wide on the screen. */
export function density_cell_px(zoom: number): number {
  return 2 ** Math.ceil(Math.log2(density_cell_pixels / zoom));
}

function intersection(a: Rectangle, b: Size): Rectangle {
  const left = Math.max(a.left, 0);
  const top = Math.max(a.top, 0);
  return {
    left,
    top,
    width: Math.max(Math.min(a.left + a.width, b.width) - left, 0),
    height: Math.max(Math.min(a.top + a.height, b.height) - top, 0)
  };
}

/** Counts the visible organisms where they are drawn. */
export function count_organisms(
  grid: DensityGrid, at: Interpolator, blend: number, visible: Rectangle, island: Size, zoom: number): void {
  grid.begin(intersection(visible, island), density_cell_px(zoom));
  for (let i = 0, count = at.latest.count; i < count; ++i) {
    grid.add(at.x_at(i, blend) / steps_per_px, at.y_at(i, blend) / steps_per_px, 1);
  }
}

/** Puts the densities of tiles together. All tiles have cells of the same size, except after a change of the level of
 *  detail. */
export function join_tiles(grid: DensityGrid, tiles: readonly TileDensity[], tile_px: number): void {
  let [left, top, right, bottom] = [Infinity, Infinity, -Infinity, -Infinity];
  let cells_max = 1;
  for (const tile of tiles) {
    left = Math.min(left, tile.left_px);
    top = Math.min(top, tile.top_px);
    right = Math.max(right, tile.left_px + tile.width_px);
    bottom = Math.max(bottom, tile.top_px + tile.height_px);
    cells_max = Math.max(cells_max, tile.cells);
  }
  grid.begin({left, top, width: right - left, height: bottom - top}, tile_px / cells_max);
  for (const tile of tiles) {
    add_tile(grid, tile, tile_px);
  }
}

function add_tile(grid: DensityGrid, tile: TileDensity, tile_px: number): void {
  const cell_px = tile_px / tile.cells;
  for (let i = 0; i < tile.organisms.length; ++i) {
    if (tile.organisms[i]! > 0) {
      grid.add(
        tile.left_px + ((i % tile.cells) + 0.5) * cell_px, tile.top_px + (Math.floor(i / tile.cells) + 0.5) * cell_px,
        tile.organisms[i]!);
    }
  }
}

/** Counts the organisms of the whole island at any level of detail, for the minimap. */
export function count_overview(grid: DensityGrid, snapshot: KeptSnapshot, island: Size, tile_px: number): void {
  grid.begin(
    {left: 0, top: 0, width: island.width, height: island.height},
    Math.max(island.width, island.height) / overview_cells_max);
  for (let i = 0; i < snapshot.count; ++i) {
    grid.add(snapshot.x[i]! / steps_per_px, snapshot.y[i]! / steps_per_px, 1);
  }
  grid.add_points(snapshot.organism_dots);
  for (const tile of snapshot.densities) {
    add_tile(grid, tile, tile_px);
  }
}

/** The colour scale of densities: from 0 to the greatest count, rounded up. */
export function density_scale(palette: "violet"|"viridis"|"cividis", grid: DensityGrid): ScaleTable {
  return new ScaleTable(palette, 0, nice_step(grid.most()));
}
