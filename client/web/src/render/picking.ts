// Picking: what is at a point of the screen. As in evoview (client/viewer/island/island_renderer.cpp, circle_at).
//
// The target of a small circle has a radius of `target` pixels, that of a large one extends 3 pixels beyond its edge. Of several
// circles that contain the point, the one whose centre is nearest is hit; if none contains it, the one whose edge is nearest.

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
