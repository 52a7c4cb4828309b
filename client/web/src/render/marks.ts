// Marks: the rules of what is drawn at which zoom, in which order and size. The same rules as in evoview
// (client/viewer/island/marks.h, island_renderer.cpp). All functions are pure.
import type {SnapshotInfo} from "../core/snapshot";
import type {Camera} from "../core/messages";
import {Rectangle, Size, visible_part} from "./camera";

/** Radius of a typical organism. If it is below one pixel on the screen, organisms are too small to see one by one. */
export const typical_radius_px = 10;
export const few_organisms = 300;
export const heading_zoom_min = 0.1; // at a smaller zoom, headings are not drawn
/** While organisms are too small to see, at most about this many dots of food are drawn, and of poison. */
export const item_dots_max = 10_000;
/** Trails and flashes are shown if a snapshot contains fewer organisms than this. On an island that is sent whole,
 *  those around the visible part count. */
export const traced_max = 5_000;
/** The greatest number of visible organisms that are streamed and drawn as moving dots. */
export const dots_max = 30_000;
/** Smaller coloured organisms have neither outline nor arc. */
export const outline_zoom_min = 0.3;
/** Larger populations are not ranked for labels. */
export const ranked_max = 2_000;
export const named_count = 3; // the labels of this many of the healthiest organisms contain their ids
/** Organisms smaller than this on the screen are streamed as dots. */
export const dots_radius_pixels = 2;

/** Least radius on the screen of an organism with a heading, or of one among few, so that its body and arc are seen. A
 *  crowded small island has smaller ones. */
export function seen_pixels_min({zoom}: Camera): number {
  return Math.min(Math.max(13 * zoom, 3), 4.5);
}

/** Least half size on the screen of food and poison among few organisms. */
export function item_pixels_min({zoom}: Camera): number {
  return Math.min(7 * zoom, 2.4);
}

export function too_small_to_see(camera: Camera): boolean {
  return typical_radius_px * camera.zoom < 1;
}

/** Smaller organisms have neither radii, forces, trails nor flashes, which would cover everything. */
export function shows_details(camera: Camera): boolean {
  return typical_radius_px * camera.zoom >= 0.5;
}

function overlap(begin: number, size: number, whole: number): number {
  return Math.max(Math.min(begin + size, whole) - Math.max(begin, 0), 0);
}

/** Whether there are too many visible organisms for dots: more than dots_max, or more than one per pixel.
 *  organism_count: on the whole island, assumed to be evenly spread. */
export function too_many_for_dots(camera: Camera, canvas: Size, info: SnapshotInfo, organism_count: number): boolean {
  const visible = visible_part(camera, canvas);
  const area_px2 =
    overlap(visible.left, visible.width, info.width_px) * overlap(visible.top, visible.height, info.height_px);
  const count = (organism_count * area_px2) / Math.max(info.width_px * info.height_px, 1);
  return count > dots_max || count > area_px2 * camera.zoom * camera.zoom;
}

/** The health as it is written: rounded up, so that a living organism never shows 0. `health` in steps of 1/16. */
export function shown_health(health: number): number {
  return health > 0 ? Math.ceil(health / 16) : 0;
}

/** The upper end of the scale of health: the greatest health rounded up to hundreds, at least 100. */
export function health_scale_max(health: Int32Array, count: number): number {
  let most = 1600;
  for (let i = 0; i < count; ++i) {
    most = health[i]! > most ? health[i]! : most;
  }
  return 100 * Math.ceil(most / 1600);
}

const float_bits = new Float32Array(2);
const integer_bits = new Uint32Array(float_bits.buffer);

/** Whether an item is kept if only `share` of them is drawn. This depends only on its place, so that the choice stays
 *  the same while others appear and disappear. */
export function is_kept(x_px: number, y_px: number, share: number): boolean {
  if (share >= 1) {
    return true;
  }
  float_bits[0] = x_px;
  float_bits[1] = y_px;
  // Multiplying by these odd numbers spreads the places over all 32-bit numbers.
  let mixed = Math.imul(integer_bits[0]!, 0x9e3779b1) ^ Math.imul(integer_bits[1]!, 0x85ebca77);
  mixed = Math.imul(mixed ^ (mixed >>> 15), 0x2c1b3c6d);
  return ((mixed ^ (mixed >>> 12)) >>> 0) < Math.trunc(Math.max(share, 0) * 2 ** 32);
}

/** Whether a circle may overlap a rectangle. Also true for some circles that just miss a corner. */
export function may_touch(rectangle: Rectangle, x: number, y: number, radius: number): boolean {
  return x + radius >= rectangle.left && x - radius <= rectangle.left + rectangle.width &&
    y + radius >= rectangle.top && y - radius <= rectangle.top + rectangle.height;
}

/** Whether the health numbers of all visible organisms are readable: organisms must be large enough, and few enough
 *  that the numbers do not cover the island. */
export function labels_are_readable(
  camera: Camera, canvas: Size, visible_count: number, label_zoom_min: number, label_height: number): boolean {
  const covered_max = 0.4;
  const label_area = 2 * label_height * label_height;
  return camera.zoom >= label_zoom_min && visible_count * label_area <= covered_max * canvas.width * canvas.height;
}
