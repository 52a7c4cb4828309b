// GlIsland: draws a scene with WebGL2. Snapshots are uploaded once; between them only uniforms change, as the shader
// interpolates.
import {steps_per_px} from "../core/snapshot";

import {zoom_min} from "./camera";

import type {DensityGrid} from "./density";
import {GlMinimap} from "./gl_minimap";
import {GlOverlays, overlay_steps} from "./gl_overlays";
import {Cells, GlShapes, Projection, Table} from "./gl_shapes";
import type {GlText} from "./gl_text";
import {KeptBoxes, Points, with_room} from "./interpolator";
import {Colour, ScaleTable, ShapeStyle} from "./look";
import {
  few_organisms,
  heading_zoom_min,
  is_kept,
  item_pixels_min,
  item_dots_max,
  outline_zoom_min,
  seen_pixels_min,
  too_small_to_see,
  typical_radius_px
} from "./marks";
import {inside_walls, Painter, Scene} from "./scene";

const margin_shadow_pixels = 6;

/** A table of positions from a snapshot, and for what it was filled. */
class Filled {
  table: Table|null = null; // until it is filled first
  count = 0;
  #key = "";
  readonly #gl: WebGL2RenderingContext;
  readonly #channels: 2|4;

  constructor(gl: WebGL2RenderingContext, channels: 2|4) {
    this.#gl = gl;
    this.#channels = channels;
  }

  /** Replaces the contents by `count` shapes. */
  fill(staging: Int32Array, count: number, texels: number): void {
    this.count = count;
    if (count > 0) {
      this.table ??= new Table(this.#gl, this.#channels);
      this.table.update(staging, texels);
    }
  }

  close(): void {
    this.table?.close();
  }

  /** Whether the table must be filled again. */
  is_stale(key: string): boolean {
    const stale = key !== this.#key;
    this.#key = key;
    return stale;
  }
}

export class GlIsland implements Painter {
  readonly #shapes: GlShapes;
  readonly #text: GlText;
  readonly #tables: {
    [name in "organisms" | "predators" | "food" | "poison" | "crates" | "obstacles" | "organism_dots" | "crate_dots" |
     "obstacle_dots"]: Filled
  };
  readonly #overlays: GlOverlays;
  readonly #minimap: GlMinimap;
  #density_cells: Cells|null = null; // until densities are drawn first
  #staging = new Int32Array(0);
  #bytes = new Uint8Array(0);
  #radius_max = 0; // of the organisms, in steps

  constructor(shapes: GlShapes, text: GlText) {
    this.#shapes = shapes;
    this.#text = text;
    const table = (channels: 2|4) => new Filled(shapes.gl, channels);
    this.#tables = {
      organisms: table(4),
      predators: table(4),
      food: table(2),
      poison: table(2),
      crates: table(4),
      obstacles: table(4),
      organism_dots: table(2),
      crate_dots: table(2),
      obstacle_dots: table(2),
    };
    this.#overlays = new GlOverlays(shapes);
    this.#minimap = new GlMinimap(shapes);
  }

  measure(text: string, ratio: number): number {
    return this.#text.measure(text, ratio);
  }

  close(): void {
    Object.values(this.#tables).forEach((table) => table.close());
    this.#overlays.close();
    this.#minimap.close();
    this.#density_cells?.close();
  }

  draw(scene: Scene): void {
    const {place, camera, colours, at} = scene, {ratio} = place;
    const shapes = this.#shapes;
    shapes.begin(place);
    shapes.fill(0, 0, place.width * ratio, place.height * ratio, colours.outside);
    const info = at.latest.info;
    if (info === null) {
      return;
    }
    const projection = (steps: number): Projection => ({
      centre_x: camera.x_px * steps,
      centre_y: camera.y_px * steps,
      origin_x: (place.width * ratio) / 2,
      origin_y: (place.height * ratio) / 2,
      zoom: (camera.zoom * ratio) / steps,
    });
    const of_snapshot = projection(steps_per_px);
    const of_overlay = projection(overlay_steps);
    const inside = inside_walls(scene, {width: info.width_px, height: info.height_px});
    const clip_to_walls = () => shapes.clip(
      inside.left * ratio, inside.top * ratio, (inside.left + inside.width) * ratio,
      (inside.top + inside.height) * ratio);

    this.#draw_walls(scene, of_overlay, inside.left, inside.top, inside.width, inside.height);
    this.#draw_boxes(scene, of_snapshot);
    if (scene.shows === "density") {
      clip_to_walls();
      this.#draw_density(scene.density, scene.density_scale!, of_snapshot);
      shapes.clip_to_place();
    } else {
      this.#draw_items(scene, of_snapshot);
      this.#fill_organisms(scene);
      clip_to_walls();
      this.#overlays.draw_radii(scene, of_overlay);
      this.#overlays.draw_trails(scene, of_snapshot, of_overlay);
      this.#overlays.draw_flashes(scene, of_overlay);
      shapes.clip_to_place();
      this.#draw_organisms(scene, of_snapshot);
      clip_to_walls();
      this.#overlays.draw_forces(scene, of_overlay);
      shapes.clip_to_place();
    }
    this.#draw_highlights(scene, of_overlay);
    this.#overlays.draw_label_grounds(scene);
    this.#text.draw(scene);
    this.#minimap.draw(scene);
    this.#overlays.draw_preview(scene);
  }

  #draw_highlights(scene: Scene, projection: Projection): void {
    const {at, blend, camera, styles} = scene;
    for (const [name, row] of [["selected", scene.selected], ["pointed_at", scene.pointed_at]] as const) {
      if (row >= 0) {
        const radius = at.latest.radius[row]! / steps_per_px + styles.highlight_pixels / camera.zoom;
        const overlay = this.#overlays.begin(name);
        overlay.push(at.x_at(row, blend) / steps_per_px, at.y_at(row, blend) / steps_per_px, radius, radius);
        overlay.draw(this.#shapes, styles[name], projection);
      }
    }
  }

  /** Draws the ground and the walls. The walls lie outside the island and have the same thickness at any zoom. */
  #draw_walls(scene: Scene, projection: Projection, left: number, top: number, width: number, height: number): void {
    const {camera, colours, styles, at} = scene, {ratio, frame} = scene.place;
    const shapes = this.#shapes;
    if (styles.shadow.fill[3] > 0) {
      const beyond = frame.walls / camera.zoom;
      const further = margin_shadow_pixels / camera.zoom;
      const right = at.latest.info!.width_px + beyond;
      const bottom = at.latest.info!.height_px + beyond;
      const shadow = this.#overlays.begin("shadow");
      shadow.push(-beyond - further, -beyond, right + further, -beyond);
      shadow.push(-beyond - further, bottom, right + further, bottom);
      shadow.push(-beyond, -beyond - further, -beyond, bottom + further);
      shadow.push(right, -beyond - further, right, bottom + further);
      shadow.draw(shapes, styles.shadow, projection);
    }
    const fill = (around: number, colour: Colour) => shapes.fill(
      (left - around) * ratio, (top - around) * ratio, (left + width + around) * ratio, (top + height + around) * ratio,
      colour);
    fill(frame.walls, colours.wall);
    fill(0, colours.ground);
  }

  #draw_boxes(scene: Scene, projection: Projection): void {
    const {latest, previous} = scene.at;
    const {styles} = scene;
    this.#fill_boxes(this.#tables.obstacles, String(scene.snapshot_version), latest.obstacles, null);
    this.#shapes.draw(
      this.#tables.obstacles.table, this.#tables.obstacles.count, styles.obstacle, projection,
      {moving: true, blend: 1});
    this.#fill_boxes(this.#tables.crates, String(scene.snapshot_version), latest.crates, previous?.crates ?? null);
    this.#shapes.draw(
      this.#tables.crates.table, this.#tables.crates.count, styles.crate, projection,
      {moving: true, blend: scene.blend});
  }

  /** Boxes have no ids: they are interpolated if both snapshots contain the same number of them, and each is of the
   *  same size. */
  #fill_boxes(filled: Filled, key: string, boxes: KeptBoxes, before: KeptBoxes|null): void {
    if (!filled.is_stale(key)) {
      return;
    }
    const staging = (this.#staging = with_room(this.#staging, 8 * boxes.count));
    for (let i = 0; i < boxes.count; ++i) {
      const at = 8 * i;
      const is_same = before !== null && before.count === boxes.count && before.half_width[i] === boxes.half_width[i] &&
        before.half_height[i] === boxes.half_height[i];
      staging[at] = boxes.x[i]!;
      staging[at + 1] = boxes.y[i]!;
      staging[at + 2] = boxes.half_width[i]!;
      staging[at + 3] = boxes.half_height[i]!;
      staging[at + 4] = is_same ? before.x[i]! : boxes.x[i]!;
      staging[at + 5] = is_same ? before.y[i]! : boxes.y[i]!;
      staging[at + 6] = staging[at + 7] = 0;
    }
    filled.fill(staging, boxes.count, 2 * boxes.count);
  }

  #fill_points(filled: Filled, key: string, points: Points, share: number): void {
    if (!filled.is_stale(key)) {
      return;
    }
    const staging = (this.#staging = with_room(this.#staging, 2 * points.count));
    let at = 0;
    for (let i = 0; i < points.count; ++i) {
      const x = points.x[i]!;
      const y = points.y[i]!;
      if (share >= 1 || is_kept(x / steps_per_px, y / steps_per_px, share)) {
        staging[at++] = x;
        staging[at++] = y;
      }
    }
    filled.fill(staging, at / 2, at / 2);
  }

  #draw_items(scene: Scene, projection: Projection): void {
    const {latest} = scene.at;
    const {styles, camera} = scene;
    const small = too_small_to_see(camera);
    // The same share of both, so that the dots show which kind is more frequent.
    const share = small ? item_dots_max / Math.max(latest.food.count, latest.poison.count, 1) : 1;
    const least = latest.count <= few_organisms && scene.place.has_details ? item_pixels_min(camera) : 0;
    const in_sight = this.#is_island_in_sight(scene);
    const draw = (filled: Filled, points: Points, kept: number, style: ShapeStyle, radius_px: number) => {
      this.#fill_points(filled, `${scene.snapshot_version} ${kept}`, points, kept);
      const item_half = Math.max(radius_px * camera.zoom, least) * scene.place.ratio;
      this.#shapes.draw(
        filled.table, filled.count, style, projection, {item_half, half_max: item_half, as_points: in_sight});
    };
    draw(this.#tables.obstacle_dots, latest.obstacle_dots, 1, styles.obstacle, typical_radius_px);
    draw(this.#tables.crate_dots, latest.crate_dots, 1, styles.crate, typical_radius_px);
    const radius_px = latest.info!.item_radius_px;
    draw(this.#tables.poison, latest.poison, share, small ? styles.poison_dot : styles.poison, radius_px);
    draw(this.#tables.food, latest.food, share, small ? styles.food_dot : styles.food, radius_px);
    draw(this.#tables.organism_dots, latest.organism_dots, 1, styles.organism_dot, typical_radius_px);
  }

  /** Drivers in software reject points out of sight much more slowly than triangles: points are drawn only if the
   *  island is almost whole in sight. */
  #is_island_in_sight({camera, place, at}: Scene): boolean {
    const {width_px, height_px} = at.latest.info!;
    return camera.zoom <= 2.5 * zoom_min(place, {width: width_px, height: height_px});
  }

  #fill_organisms(scene: Scene): void {
    if (this.#tables.organisms.is_stale(`${scene.snapshot_version} ${scene.colours_version}`)) {
      this.#radius_max = 0;
      this.#fill_species(scene, this.#tables.organisms, false);
      this.#fill_species(scene, this.#tables.predators, true);
    }
  }

  #fill_species(scene: Scene, filled: Filled, predators: boolean): void {
    const {latest, previous, match} = scene.at;
    const {organism_colours} = scene;
    const {count, x, y, radius, health, heading, has_headings} = latest;
    const staging = (this.#staging = with_room(this.#staging, 8 * count));
    const turns = previous !== null && previous.has_headings;
    let at = 0;
    for (let i = 0; i < count; ++i) {
      if (latest.is_predator(i) !== predators) {
        continue;
      }
      const j = previous === null ? -1 : match[i]!;
      const ahead = has_headings ? heading[i]! : 0;
      staging[at] = x[i]!;
      staging[at + 1] = y[i]!;
      staging[at + 2] = radius[i]!;
      staging[at + 3] = health[i]!;
      staging[at + 4] = j < 0 ? x[i]! : previous!.x[j]!;
      staging[at + 5] = j < 0 ? y[i]! : previous!.y[j]!;
      staging[at + 6] = ahead | ((turns && j >= 0 ? previous!.heading[j]! : ahead) << 8);
      staging[at + 7] = organism_colours === null ? 0 : organism_colours[i]!;
      this.#radius_max = radius[i]! > this.#radius_max ? radius[i]! : this.#radius_max;
      at += 8;
    }
    filled.fill(staging, at / 8, at / 4);
  }

  #draw_organisms(scene: Scene, projection: Projection): void {
    const {styles, camera, blend} = scene, {ratio} = scene.place;
    const coloured = scene.organism_colours !== null;
    const {has_headings, count} = scene.at.latest;
    const options = {
      moving: true,
      blend,
      coloured,
      health_share: 1 / (steps_per_px * scene.health_max),
      edge_pixels: coloured && camera.zoom < outline_zoom_min ? 0 : undefined,
      half_pixels_min: has_headings || count <= few_organisms ? seen_pixels_min(camera) : undefined,
      half_max: this.#radius_max * projection.zoom,
      as_points: this.#is_island_in_sight(scene),
    };
    const draw = (filled: Filled, style: ShapeStyle) =>
      this.#shapes.draw(filled.table, filled.count, style, projection, options);
    draw(this.#tables.organisms, coloured ? styles.coloured : styles.organism);
    draw(this.#tables.predators, styles.predator);
    const radius_pixels = Math.max(typical_radius_px * camera.zoom, seen_pixels_min(camera));
    if (has_headings && camera.zoom >= heading_zoom_min) { // lines of small organisms are shorter and thinner
      for (const {table, count} of [this.#tables.organisms, this.#tables.predators]) {
        this.#shapes.draw(table, count, styles.heading, projection, {
          moving: true,
          blend,
          heading_beyond: Math.min(styles.heading_pixels, 1.5 * radius_pixels - 1) * ratio,
          line_pixels: Math.min(styles.heading.line_pixels, radius_pixels / 4),
        });
      }
    }
  }

  #draw_density(grid: DensityGrid, scale: ScaleTable, projection: Projection): void {
    const size = grid.columns * grid.rows;
    const bytes = (this.#bytes = with_room(this.#bytes, 4 * size));
    const words = new Int32Array(bytes.buffer, 0, size);
    for (let i = 0; i < size; ++i) {
      words[i] = grid.counts[i]! > 0 ? scale.at(grid.counts[i]!) : 0;
    }
    const cells = (this.#density_cells ??= new Cells(this.#shapes.gl));
    cells.set(bytes, grid.columns, grid.rows);
    const zoom = projection.zoom * steps_per_px;
    const left = projection.origin_x + (grid.left_px - projection.centre_x / steps_per_px) * zoom;
    const top = projection.origin_y + (grid.top_px - projection.centre_y / steps_per_px) * zoom;
    const cell = grid.cell_px * zoom;
    this.#shapes.draw_cells(cells, grid.columns, grid.rows, left, top, grid.columns * cell, grid.rows * cell);
  }
}
