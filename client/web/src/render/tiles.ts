// Tiles: the places of the islands of a world in one canvas, row by row. The page lays out its controls by the same
// function.
import type {Frame, Place, Rectangle, Size} from "./camera";

export const gap_pixels = 6; // between two tiles, and around all
export const label_pixels = 20; // the label above the island of a tile
/** Islands that are smaller on the screen have neither labels of organisms nor trails. */
export const details_pixels = 240;
/** More islands are not shown at once: they would be too small to see. */
export const tiles_max = 256;
/** All tiles together show at most about this many snapshots per second. */
export const snapshots_per_s_max = 480;

const tile_frame: Frame = {
  walls: 2,
  margin: 2
};

/** Returns tiles of equal size, so many in a row that the islands are as large as possible.
 *
 *  aspect  width of an island divided by its height */
export function tile_places(canvas: Size, count: number, aspect: number): Rectangle[] {
  const width_of = (columns: number): number => (canvas.width - gap_pixels) / columns - gap_pixels;
  const height_of = (rows: number): number => (canvas.height - gap_pixels) / rows - gap_pixels;
  const rows_of = (columns: number): number => Math.ceil(count / columns);
  let columns = 1, largest = 0;
  for (let tried = 1; tried <= count; ++tried) {
    const height = Math.min(width_of(tried) / aspect, height_of(rows_of(tried)) - label_pixels);
    if (height > largest) {
      largest = height;
      columns = tried;
    }
  }
  const width = Math.max(Math.floor(width_of(columns)), 1);
  const height = Math.max(Math.floor(height_of(rows_of(columns))), label_pixels + 1);
  return Array.from({length: count}, (_, i) => ({
                                       left: gap_pixels + (i % columns) * (width + gap_pixels),
                                       top: gap_pixels + Math.floor(i / columns) * (height + gap_pixels),
                                       width,
                                       height,
                                     }));
}

/** The place of the island in a tile: below its label. */
export function island_place({left, top, width, height}: Rectangle, ratio: number): Place {
  return tile_place({left, top: top + label_pixels, width, height: height - label_pixels}, ratio);
}

/** The place of an island that is shown as a tile without a label. */
export function tile_place({left, top, width, height}: Rectangle, ratio: number): Place {
  return {
    left,
    top,
    width,
    height,
    ratio,
    frame: tile_frame,
    is_tile: true,
    has_details: Math.min(width, height) >= details_pixels
  };
}

/** The snapshots per second of each island, if all are shown and at most `rate_hz` are wanted. */
export function tile_rate_hz(rate_hz: number, count: number): number {
  return Math.min(rate_hz, snapshots_per_s_max / Math.max(count, 1));
}
