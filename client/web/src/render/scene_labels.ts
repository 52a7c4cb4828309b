// Scene labels: the labels of a scene: the health of the visible organisms if there is room; otherwise of the
// healthiest, the selected and the pointed one.
import {steps_per_px} from "../core/snapshot";

import {visible_part} from "./camera";
import {label_height} from "./glyphs";

import {type Label, place_labels} from "./labels";
import type {ShapeStyle} from "./look";
import {few_organisms, labels_are_readable, named_count, ranked_max, seen_pixels_min, shown_health} from "./marks";
import {inside_walls, type Painter, type Scene} from "./scene";

/** The radius of a mark on the screen, with the arc around a body. */
function radius_with_arc(radius: number, {form, edge_pixels}: ShapeStyle): number {
  return form !== "body" || radius < 0.8 * edge_pixels ? radius : radius + 1.6 * Math.min(edge_pixels, 0.4 * radius);
}

/** The rows of the visible organisms, if there is room for all their labels; otherwise null. */
function readable_rows({at, blend, camera, place, styles}: Scene): number[]|null {
  if (!labels_are_readable(camera, place, 0, styles.label_zoom_min, label_height)) {
    return null;
  }
  const visible = visible_part(camera, place), shown: number[] = [];
  for (let row = 0; row < at.latest.count; ++row) {
    const x = at.x_at(row, blend) / steps_per_px, y = at.y_at(row, blend) / steps_per_px;
    if (
      x >= visible.left && x <= visible.left + visible.width && y >= visible.top && y <= visible.top + visible.height) {
      shown.push(row);
    }
  }
  const is_readable = labels_are_readable(camera, place, shown.length, styles.label_zoom_min, label_height);
  return shown.length > 0 && is_readable ? shown : null;
}

export function labels_of(scene: Scene, painter: Painter): Label[] {
  const {at, blend, camera, styles, place} = scene, {latest} = at;
  const named = new Map<number, number>(); // health by row; first those whose labels must not be left out
  for (const row of [scene.selected, scene.pointed_at].filter((one) => one >= 0)) {
    named.set(row, shown_health(latest.health[row]!));
  }
  for (const {id, health} of latest.count <= ranked_max ? scene.healthiest.slice(0, named_count) : []) {
    const row = latest.index_of(id);
    if (row >= 0) {
      named.set(row, Math.ceil(health));
    }
  }
  const inside = inside_walls(scene, {width: latest.info!.width_px, height: latest.info!.height_px});
  const least = latest.count <= few_organisms ? seen_pixels_min(camera) : 0;
  const rows = new Set([...named.keys(), ...readable_rows(scene) ?? []]);
  const labels = [...rows].map((row): Label => {
    const health = named.get(row);
    const text = health === undefined ? String(shown_health(latest.health[row]!)) : `#${latest.id[row]!} ♥${health}`;
    return {
      text,
      is_named: health !== undefined,
      x: inside.left + (at.x_at(row, blend) / steps_per_px) * camera.zoom,
      y: inside.top + (at.y_at(row, blend) / steps_per_px) * camera.zoom,
      radius: radius_with_arc(Math.max((latest.radius[row]! / steps_per_px) * camera.zoom, least), styles.organism),
      width: painter.measure(text, place.ratio),
      left: 0,
      top: 0,
    };
  });
  return place_labels(labels, label_height, inside);
}
