// Picking: what is at a point of the screen. As in evoview (client/viewer/island/island_renderer.cpp, circle_at).
//
// The target of a small circle has a radius of `target` pixels, that of a large one extends 3 pixels beyond its edge.
// Of several circles that contain the point, the one whose centre is nearest is hit; if none contains it, the one whose
// edge is nearest.
import type {Camera} from "../core/messages";
import {steps_per_px} from "../core/snapshot";
import {type Point, type Size, to_world} from "./camera";
import type {Interpolator} from "./interpolator";

export interface Picked {
  organism: number|null; // ids
  food: number|null;
  poison: number|null;
  x_px: number; // the point of the island
  y_px: number;
  generation: number;
}

/** Returns the index of the circle at a point, -1 if there is none. All lengths are in px of the island.
 *  pixel: px of the island per pixel of the screen. target: in pixels of the screen. */
export function circle_at(
  x: number, y: number, count: number, x_of: (i: number) => number, y_of: (i: number) => number,
  radius_of: (i: number) => number, pixel: number, target: number): number {
  const slack = 3 * pixel;
  let found = -1;
  let found_inside = false;
  let nearest = 0;
  for (let i = 0; i < count; ++i) {
    const away_x = x_of(i) - x;
    const away_y = y_of(i) - y;
    const radius = radius_of(i);
    const reach = Math.max(radius + slack, target * pixel);
    const square = away_x * away_x + away_y * away_y;
    if (square > reach * reach) {
      continue;
    }
    const distance = Math.sqrt(square);
    const inside = distance <= radius;
    const measure = inside ? distance : distance - radius;
    if (found < 0 || (inside && !found_inside) || (inside === found_inside && measure < nearest)) {
      [found, found_inside, nearest] = [i, inside, measure];
    }
  }
  return found;
}

/** Returns the row of the organism at a point of the screen, -1 if there is none. blend: of the drawn frame. */
export function organism_at(
  point: Point, target: number, camera: Camera, canvas: Size, at: Interpolator, blend: number): number {
  const place = to_world(camera, canvas, point);
  return circle_at(
    place.x, place.y, at.latest.count, (i) => at.x_at(i, blend) / steps_per_px, (i) => at.y_at(i, blend) / steps_per_px,
    (i) => at.latest.radius[i]! / steps_per_px, 1 / camera.zoom, target);
}

/** Returns what is drawn at a point of the screen. Null: the point is not on the island. */
export function picked_at(
  point: Point, target: number, camera: Camera, canvas: Size, at: Interpolator, blend: number): Picked|null {
  const {info, id, food, poison} = at.latest, place = to_world(camera, canvas, point);
  if (info === null || place.x < 0 || place.y < 0 || place.x > info.width_px || place.y > info.height_px) {
    return null;
  }
  const item_at = (items: typeof food): number|null => {
    const found = circle_at(
      place.x, place.y, items.whole, (i) => items.x[i]! / steps_per_px, (i) => items.y[i]! / steps_per_px,
      () => info.item_radius_px, 1 / camera.zoom, target);
    return found < 0 ? null : items.id[found]!;
  };
  const row = organism_at(point, target, camera, canvas, at, blend);
  return {
    organism: row < 0 ? null : id[row]!,
    food: item_at(food),
    poison: item_at(poison),
    x_px: place.x,
    y_px: place.y,
    generation: info.generation,
  };
}
