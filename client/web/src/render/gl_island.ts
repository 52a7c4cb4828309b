// GlIsland: draws a scene with WebGL2. Snapshots are uploaded once; between them only uniforms change, as the shader interpolates.
import {steps_per_px} from "../core/snapshot";

import {visible_part, wall_pixels, zoom_min} from "./camera";

import type {DensityGrid} from "./density";
import {Cells, GlShapes, Projection, Table} from "./gl_shapes";
import {Glyphs, label_height} from "./glyphs";
import {KeptBoxes, Points, with_room} from "./interpolator";
import {Colour, packed, ScaleTable, ShapeStyle, with_alpha} from "./look";
import {is_kept, item_dots_max, may_touch, outline_zoom_min, too_small_to_see, typical_radius_px} from "./marks";
import {
  arrow_px_per_force,
  choice_flee,
  choice_seek,
  chosen_rows,
  colour_of_choice,
  inside_walls,
  Painter,
  perception_px_max,
  Scene,
  trail_alpha
} from "./scene";
import {add_paths, flash_shown_s, trail_kept_s} from "./traces";

const overlay_steps =
  1024; // per px of the island, or per pixel: finer than positions in snapshots, as overlays are at interpolated places
const margin_shadow_pixels = 6;

/** Shapes that are computed in each frame. */
class Overlay {
  #staging = new Int32Array(8 * 64);
  readonly #table: Table;
  count = 0;

  constructor(gl: WebGL2RenderingContext) {
    this.#table = new Table(gl, 4);
  }

  clear(): void {
    this.count = 0;
  }

  /** A shape: centre and half sizes. A line: begin and end. */
  push(x: number, y: number, w: number, h: number, colour = 0): void {
    if (8 * (this.count + 1) > this.#staging.length) {
      const larger = new Int32Array(2 * this.#staging.length);
      larger.set(this.#staging);
      this.#staging = larger;
    }
    const at = 8 * this.count++;
    this.#staging[at] = Math.round(x * overlay_steps);
    this.#staging[at + 1] = Math.round(y * overlay_steps);
    this.#staging[at + 2] = Math.round(w * overlay_steps);
    this.#staging[at + 3] = Math.round(h * overlay_steps);
    this.#staging[at + 7] = colour;
  }

  draw(shapes: GlShapes, style: ShapeStyle, projection: Projection, coloured = false): void {
    if (this.count > 0) {
      this.#table.update(this.#staging, 2 * this.count);
      shapes.draw(this.#table, this.count, style, projection, {stride: 2, coloured});
    }
  }
}

/** A table of positions from a snapshot, and for what it was filled. */
class Filled {
  readonly table: Table;
  count = 0;
  key = "";

  constructor(gl: WebGL2RenderingContext, channels: 2|4) {
    this.table = new Table(gl, channels);
  }

  /** Whether the table must be filled again. */
  is_stale(key: string): boolean {
    const stale = key !== this.key;
    this.key = key;
    return stale;
  }
}

export class GlIsland implements Painter {
  readonly kind = "webgl2";
  readonly organisms_max = Infinity;
  readonly label_height = label_height;
  readonly #shapes: GlShapes;
  readonly #organisms: Filled;
  readonly #food: Filled;
  readonly #poison: Filled;
  readonly #crates: Filled;
  readonly #obstacles: Filled;
  readonly #organism_dots: Filled;
  readonly #crate_dots: Filled;
  readonly #obstacle_dots: Filled;
  readonly #trails: {table: Table; serial: number}[] = [];
  readonly #overlays: {
    [name in "shadow" | "radii" | "paths" | "flashes" | "arrows" | "targets" | "selected" | "pointed_at" | "preview"]:
      Overlay
  };
  readonly #density_cells: Cells;
  readonly #minimap_cells: Cells;
  #minimap_key = "";
  readonly #glyph_table: Table;
  readonly #atlas: Cells;
  #glyphs: Glyphs|null = null;
  #staging = new Int32Array(0);
  #glyph_staging = new Int32Array(0);
  #bytes = new Uint8Array(0);
  #radius_max = 0; // of the organisms, in steps

  constructor(gl: WebGL2RenderingContext) {
    this.#shapes = new GlShapes(gl);
    this.#organisms = new Filled(gl, 4);
    this.#food = new Filled(gl, 2);
    this.#poison = new Filled(gl, 2);
    this.#crates = new Filled(gl, 4);
    this.#obstacles = new Filled(gl, 4);
    this.#organism_dots = new Filled(gl, 2);
    this.#crate_dots = new Filled(gl, 2);
    this.#obstacle_dots = new Filled(gl, 2);
    const overlay = () => new Overlay(gl);
    this.#overlays = {
      shadow: overlay(),
      radii: overlay(),
      paths: overlay(),
      flashes: overlay(),
      arrows: overlay(),
      targets: overlay(),
      selected: overlay(),
      pointed_at: overlay(),
      preview: overlay(),
    };
    this.#density_cells = new Cells(gl);
    this.#minimap_cells = new Cells(gl);
    this.#glyph_table = new Table(gl, 4);
    this.#atlas = new Cells(gl);
  }

  measure(text: string, ratio: number): number {
    return this.#glyphs_at(ratio).measure(text);
  }

  draw(scene: Scene): void {
    const {canvas, ratio, camera, colours, styles, at} = scene;
    const shapes = this.#shapes;
    const width = Math.round(canvas.width * ratio);
    const height = Math.round(canvas.height * ratio);
    shapes.begin(width, height, ratio);
    shapes.fill(0, 0, width, height, colours.outside);
    const info = at.latest.info;
    if (info === null) {
      return;
    }
    const projection = (steps: number): Projection => ({
      centre_x: camera.x_px * steps,
      centre_y: camera.y_px * steps,
      origin_x: (canvas.width * ratio) / 2,
      origin_y: (canvas.height * ratio) / 2,
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
      shapes.clip_to_canvas();
    } else {
      this.#draw_items(scene, of_snapshot);
      this.#fill_organisms(scene);
      clip_to_walls();
      this.#draw_radii(scene, of_overlay);
      this.#draw_trails(scene, of_snapshot, of_overlay);
      this.#draw_flashes(scene, of_overlay);
      shapes.clip_to_canvas();
      this.#draw_organisms(scene, of_snapshot);
      clip_to_walls();
      this.#draw_forces(scene, of_overlay);
      shapes.clip_to_canvas();
    }
    for (const [name, row] of [["selected", scene.selected], ["pointed_at", scene.pointed_at]] as const) {
      this.#overlays[name].clear();
      if (row >= 0) {
        const radius = at.latest.radius[row]! / steps_per_px + styles.highlight_pixels / camera.zoom;
        this.#overlays[name].push(
          at.x_at(row, scene.blend) / steps_per_px, at.y_at(row, scene.blend) / steps_per_px, radius, radius);
        this.#overlays[name].draw(shapes, styles[name], of_overlay);
      }
    }
    this.#draw_labels(scene);
    this.#draw_minimap(scene);
    this.#draw_preview(scene);
  }

  /** Draws the ground and the walls. The walls lie outside the island and have the same thickness at any zoom. */
  #draw_walls(scene: Scene, projection: Projection, left: number, top: number, width: number, height: number): void {
    const {ratio, camera, colours, styles, at} = scene;
    const shapes = this.#shapes;
    if (styles.shadow.fill[3] > 0) {
      const beyond = wall_pixels / camera.zoom;
      const further = margin_shadow_pixels / camera.zoom;
      const right = at.latest.info!.width_px + beyond;
      const bottom = at.latest.info!.height_px + beyond;
      const {shadow} = this.#overlays;
      shadow.clear();
      shadow.push(-beyond - further, -beyond, right + further, -beyond);
      shadow.push(-beyond - further, bottom, right + further, bottom);
      shadow.push(-beyond, -beyond - further, -beyond, bottom + further);
      shadow.push(right, -beyond - further, right, bottom + further);
      shadow.draw(shapes, styles.shadow, projection);
    }
    const fill = (around: number, colour: Colour) => shapes.fill(
      (left - around) * ratio, (top - around) * ratio, (left + width + around) * ratio, (top + height + around) * ratio,
      colour);
    fill(wall_pixels, colours.wall);
    fill(0, colours.ground);
  }

  #draw_boxes(scene: Scene, projection: Projection): void {
    const {latest, previous} = scene.at;
    const {styles} = scene;
    this.#fill_boxes(this.#obstacles, String(scene.snapshot_version), latest.obstacles, null);
    this.#shapes.draw(
      this.#obstacles.table, this.#obstacles.count, styles.obstacle, projection, {moving: true, blend: 1});
    this.#fill_boxes(this.#crates, String(scene.snapshot_version), latest.crates, previous?.crates ?? null);
    this.#shapes.draw(
      this.#crates.table, this.#crates.count, styles.crate, projection, {moving: true, blend: scene.blend});
  }

  /** Boxes have no ids: they are interpolated if both snapshots contain the same number of them, and each is of the same size. */
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
    filled.count = boxes.count;
    filled.table.update(staging, 2 * boxes.count);
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
    filled.count = at / 2;
    filled.table.update(staging, filled.count);
  }

  #draw_items(scene: Scene, projection: Projection): void {
    const {latest} = scene.at;
    const {styles, camera} = scene;
    const small = too_small_to_see(camera);
    // The same share of both, so that the dots show which kind is more frequent.
    const share = small ? item_dots_max / Math.max(latest.food.count, latest.poison.count, 1) : 1;
    const in_sight = this.#is_island_in_sight(scene);
    const draw = (filled: Filled, points: Points, kept: number, style: ShapeStyle, radius_px: number) => {
      this.#fill_points(filled, `${scene.snapshot_version} ${kept}`, points, kept);
      const item_half = radius_px * camera.zoom * scene.ratio;
      this.#shapes.draw(
        filled.table, filled.count, style, projection, {item_half, half_max: item_half, as_points: in_sight});
    };
    draw(this.#obstacle_dots, latest.obstacle_dots, 1, styles.obstacle, typical_radius_px);
    draw(this.#crate_dots, latest.crate_dots, 1, styles.crate, typical_radius_px);
    const radius_px = latest.info!.item_radius_px;
    draw(this.#poison, latest.poison, share, small ? styles.poison_dot : styles.poison, radius_px);
    draw(this.#food, latest.food, share, small ? styles.food_dot : styles.food, radius_px);
    draw(this.#organism_dots, latest.organism_dots, 1, styles.organism_dot, typical_radius_px);
  }

  /** Drivers in software reject points out of sight much more slowly than triangles: points are drawn only if the island is almost whole
   *  in sight. */
  #is_island_in_sight({camera, canvas, at}: Scene): boolean {
    const {width_px, height_px} = at.latest.info!;
    return camera.zoom <= 2.5 * zoom_min(canvas, {width: width_px, height: height_px});
  }

  #fill_organisms(scene: Scene): void {
    if (!this.#organisms.is_stale(`${scene.snapshot_version} ${scene.colours_version}`)) {
      return;
    }
    const {latest, previous, match} = scene.at;
    const {organism_colours} = scene;
    const {count, x, y, radius, health, heading, has_headings} = latest;
    const staging = (this.#staging = with_room(this.#staging, 8 * count));
    const turns = previous !== null && previous.has_headings;
    this.#radius_max = 0;
    for (let i = 0, at = 0; i < count; ++i, at += 8) {
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
    }
    this.#organisms.count = count;
    this.#organisms.table.update(staging, 2 * count);
  }

  #draw_organisms(scene: Scene, projection: Projection): void {
    const {styles, camera, ratio, blend} = scene;
    const coloured = scene.organism_colours !== null;
    const {table, count} = this.#organisms;
    this.#shapes.draw(table, count, coloured ? styles.coloured : styles.organism, projection, {
      moving: true,
      blend,
      coloured,
      health_share: 1 / (steps_per_px * scene.health_max),
      edge_pixels: coloured && camera.zoom < outline_zoom_min ? 0 : undefined,
      half_max: this.#radius_max * projection.zoom,
      as_points: this.#is_island_in_sight(scene),
    });
    const radius_pixels = typical_radius_px * camera.zoom;
    if (scene.at.latest.has_headings && radius_pixels >= 2) {
      const heading_beyond =
        Math.min(styles.heading_pixels, radius_pixels + 4) * ratio; // lines of small organisms are shorter
      this.#shapes.draw(table, count, styles.heading, projection, {moving: true, blend, heading_beyond});
    }
  }

  #draw_density(grid: DensityGrid, scale: ScaleTable, projection: Projection): void {
    const size = grid.columns * grid.rows;
    const bytes = (this.#bytes = with_room(this.#bytes, 4 * size));
    const words = new Int32Array(bytes.buffer, 0, size);
    for (let i = 0; i < size; ++i) {
      words[i] = grid.counts[i]! > 0 ? scale.at(grid.counts[i]!) : 0;
    }
    this.#density_cells.set(bytes, grid.columns, grid.rows);
    const zoom = projection.zoom * steps_per_px;
    const left = projection.origin_x + (grid.left_px - projection.centre_x / steps_per_px) * zoom;
    const top = projection.origin_y + (grid.top_px - projection.centre_y / steps_per_px) * zoom;
    const cell = grid.cell_px * zoom;
    this.#shapes.draw_cells(
      this.#density_cells, grid.columns, grid.rows, left, top, grid.columns * cell, grid.rows * cell);
  }

  #draw_radii(scene: Scene, projection: Projection): void {
    const {population, at, blend, camera, canvas} = scene;
    if (scene.look.perception === "none" || population === null) {
      return;
    }
    const visible = visible_part(camera, canvas);
    const {radii} = this.#overlays;
    for (const [gene, style] of [
           ["food_radius", scene.styles.food_radius], ["poison_radius", scene.styles.poison_radius]] as const) {
      const values = population.genes[population.gene_names.indexOf(gene)];
      radii.clear();
      if (values === undefined) {
        continue;
      }
      for (const row of chosen_rows(scene.look.perception, scene)) {
        const radius = values[at.latest.id[row]!];
        const x = at.x_at(row, blend) / steps_per_px;
        const y = at.y_at(row, blend) / steps_per_px;
        if (radius !== undefined && may_touch(visible, x, y, radius)) {
          radii.push(x, y, radius, radius);
        }
      }
      radii.draw(this.#shapes, style, projection);
    }
  }

  #draw_trails(scene: Scene, projection: Projection, of_overlay: Projection): void {
    const {trails, at, blend} = scene;
    if (trails === null) {
      return;
    }
    const style = scene.styles.trail;
    const now_s = at.latest.info!.simulated_s;
    for (const segment of trails.segments) {
      let slot = this.#trails.find(({serial}) => serial === segment.serial);
      if (slot === undefined) {
        slot = this.#trails.find(({serial}) => trails.segments.every((other) => other.serial !== serial));
        if (slot === undefined) {
          slot = {table: new Table(this.#shapes.gl, 4), serial: 0};
          this.#trails.push(slot);
        }
        slot.serial = segment.serial;
        slot.table.update(segment.lines, segment.count);
      }
      const fill = with_alpha(style.fill, trail_alpha(style.fill[3], now_s - segment.to_s, trail_kept_s));
      this.#shapes.draw(slot.table, segment.count, style, projection, {fill});
    }
    // From the last kept positions to the present ones.
    const {paths} = this.#overlays;
    const lines = (this.#staging = with_room(this.#staging, 4 * at.latest.count));
    const count = add_paths(
      trails.last, at.latest.id, at.latest.count, (row) => at.x_at(row, blend), (row) => at.y_at(row, blend), lines,
      overlay_steps / steps_per_px);
    paths.clear();
    for (let i = 0; i < 4 * count; i += 4) {
      paths.push(
        lines[i]! / overlay_steps, lines[i + 1]! / overlay_steps, lines[i + 2]! / overlay_steps,
        lines[i + 3]! / overlay_steps);
    }
    paths.draw(this.#shapes, style, of_overlay);
  }

  /** Draws each flash as a growing and fading disc in the colour of what was eaten or died. */
  #draw_flashes(scene: Scene, projection: Projection): void {
    const {flashes} = this.#overlays;
    flashes.clear();
    for (const flash of scene.flashes) {
      const age = (scene.shown_s - flash.began_s) / flash_shown_s;
      if (age < 0 || age >= 1) { // it begins after the shown time, which is interpolated
        continue;
      }
      const colour = with_alpha(scene.colours[flash.kind], 255 * (1 - age));
      const radius = flash.radius_px * (1.5 + (flash.kind === "death" ? 2 : 3.5) * Math.sqrt(age));
      flashes.push(flash.x_px, flash.y_px, radius, radius, packed(colour));
    }
    flashes.draw(this.#shapes, scene.styles.ripple, projection, true);
  }

  /** Draws an arrow along the force of each chosen organism and a line to its target, coloured by its choice. */
  #draw_forces(scene: Scene, projection: Projection): void {
    const {population, at, blend, camera, canvas, colours} = scene;
    const {arrows, targets} = this.#overlays;
    if (
      scene.look.forces === "none" || population === null || population.choices === null ||
      population.forces === null) {
      return;
    }
    const visible = visible_part(camera, canvas);
    arrows.clear();
    targets.clear();
    for (const row of chosen_rows(scene.look.forces, scene)) {
      const id = at.latest.id[row]!;
      const x = at.x_at(row, blend) / steps_per_px;
      const y = at.y_at(row, blend) / steps_per_px;
      const choice = population.choices[id] ?? 0;
      if (choice === 0 || !may_touch(visible, x, y, perception_px_max)) {
        continue;
      }
      const colour = packed(colour_of_choice(choice, colours));
      const [force_x, force_y] = population.forces;
      arrows.push(x, y, x + arrow_px_per_force * force_x![id]!, y + arrow_px_per_force * force_y![id]!, colour);
      if ((choice === choice_seek || choice === choice_flee) && population.targets !== null) {
        targets.push(x, y, population.targets[0]![id]!, population.targets[1]![id]!, colour);
      }
    }
    targets.draw(this.#shapes, scene.styles.target, projection, true);
    arrows.draw(this.#shapes, scene.styles.arrow, projection, true);
  }

  #draw_labels({labels, ratio, colours}: Scene): void {
    if (labels.length === 0) {
      return;
    }
    const glyphs = this.#glyphs_at(ratio);
    this.#glyph_staging = with_room(this.#glyph_staging, 4 * labels.reduce((sum, {text}) => sum + text.length, 0));
    let count = 0;
    for (const {text, left, top} of labels) {
      let x = Math.round(left * ratio) - glyphs.padding;
      const y = Math.round(top * ratio) - glyphs.padding;
      for (const character of text) {
        const index = glyphs.index_of(character);
        this.#glyph_staging[4 * count] = x;
        this.#glyph_staging[4 * count + 1] = y;
        this.#glyph_staging[4 * count + 2] = index;
        this.#glyph_staging[4 * count + 3] = 0;
        ++count;
        x += glyphs.advance(index);
      }
    }
    this.#glyph_table.update(this.#glyph_staging, count);
    this.#shapes.draw_glyphs(
      this.#glyph_table, count, this.#atlas, glyphs.cell_width, glyphs.cell_height, colours.label,
      with_alpha(colours.ground, 210));
  }

  #draw_minimap({minimap, colours, ratio, look}: Scene): void {
    if (minimap === null) {
      return;
    }
    const {place, frame, grid, scale} = minimap;
    const shapes = this.#shapes;
    const left = place.screen.left * ratio;
    const top = place.screen.top * ratio;
    const right = left + place.screen.width * ratio;
    const bottom = top + place.screen.height * ratio;
    const key = `${minimap.version} ${look.skin} ${look.background}`;
    if (key !== this.#minimap_key) {
      this.#minimap_key = key;
      const size = grid.columns * grid.rows;
      const bytes = (this.#bytes = with_room(this.#bytes, 4 * size));
      for (let i = 0; i < size; ++i) {
        const count = grid.counts[i]!;
        const alpha = count === 0 ? 0 : (60 + 195 * Math.min(count / scale.high, 1)) / 255;
        for (let channel = 0; channel < 3; ++channel) {
          bytes[4 * i + channel] = colours.body[channel]! * alpha;
        }
        bytes[4 * i + 3] = 255 * alpha;
      }
      this.#minimap_cells.set(bytes, grid.columns, grid.rows);
    }
    const pixel = Math.max(Math.round(ratio), 1);
    shapes.fill(left - pixel, top - pixel, right + pixel, bottom + pixel, colours.wall);
    shapes.fill(left, top, right, bottom, colours.ground);
    shapes.clip(left, top, right, bottom);
    const cell = grid.cell_px * place.zoom * ratio;
    shapes.draw_cells(this.#minimap_cells, grid.columns, grid.rows, left, top, grid.columns * cell, grid.rows * cell);
    shapes.clip_to_canvas();
    const [x0, y0] = [frame.left * ratio, frame.top * ratio];
    const [x1, y1] = [x0 + frame.width * ratio, y0 + frame.height * ratio];
    const thick = 2 * pixel;
    shapes.fill(x0, y0, x1, y0 + thick, colours.selected);
    shapes.fill(x0, y1 - thick, x1, y1, colours.selected);
    shapes.fill(x0, y0, x0 + thick, y1, colours.selected);
    shapes.fill(x1 - thick, y0, x1, y1, colours.selected);
  }

  #draw_preview({preview, ratio, styles}: Scene): void {
    if (preview === null) {
      return;
    }
    const overlay = this.#overlays.preview;
    overlay.clear();
    overlay.push(preview.x * ratio, preview.y * ratio, preview.radius * ratio, preview.radius * ratio);
    const style = {
      ...styles.pointed_at,
      fill: with_alpha(preview.colour, 110),
      edge: preview.colour,
      edge_pixels: 2,
      half_pixels_min: 3
    };
    overlay.draw(this.#shapes, style, {centre_x: 0, centre_y: 0, origin_x: 0, origin_y: 0, zoom: 1 / overlay_steps});
  }

  #glyphs_at(ratio: number): Glyphs {
    if (this.#glyphs === null || this.#glyphs.ratio !== ratio) {
      this.#glyphs = new Glyphs(ratio);
      this.#atlas.set(this.#glyphs.bytes, this.#glyphs.cell_width * this.#glyphs.columns, this.#glyphs.cell_height);
    }
    return this.#glyphs;
  }
}
