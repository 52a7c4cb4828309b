// GlOverlays: the shapes of an island that are computed in each frame: trails, radii, flashes, arrows, highlights.
import {steps_per_px} from "../core/snapshot";

import {visible_part} from "./camera";
import {GlShapes, Projection, Table} from "./gl_shapes";
import {label_height} from "./glyphs";
import {with_room} from "./interpolator";
import {packed, ShapeStyle, with_alpha} from "./look";
import {may_touch} from "./marks";
import {
  arrow_px_per_force,
  choice_flee,
  choice_seek,
  chosen_rows,
  colour_of_choice,
  perception_px_max,
  Scene,
  trail_alpha,
  trail_share
} from "./scene";
import {add_paths, flash_shown_s, trail_interval_s, trail_kept_s} from "./traces";

/** Per px of the island, or per pixel: finer than positions in snapshots, as overlays are at interpolated places. */
export const overlay_steps = 1024;

/** Of overlays in device pixels of the place. */
const of_pixels: Projection = {
  centre_x: 0,
  centre_y: 0,
  origin_x: 0,
  origin_y: 0,
  zoom: 1 / overlay_steps
};

/** Shapes that are computed in each frame. */
class Overlay {
  #staging = new Int32Array(8 * 64);
  #table: Table|null = null; // until something is drawn first
  count = 0;

  close(): void {
    this.#table?.close();
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
      this.#table ??= new Table(shapes.gl, 4);
      this.#table.update(this.#staging, 2 * this.count);
      shapes.draw(this.#table, this.count, style, projection, {stride: 2, coloured});
    }
  }
}

export class GlOverlays {
  readonly #shapes: GlShapes;
  readonly #trails: {table: Table; serial: number}[] = [];
  readonly #overlays = new Map<string, Overlay>();
  #staging = new Int32Array(0);

  constructor(shapes: GlShapes) {
    this.#shapes = shapes;
  }

  /** The overlay of a name, empty. It is made when it is needed first. */
  begin(name: string): Overlay {
    let overlay = this.#overlays.get(name);
    if (overlay === undefined) {
      overlay = new Overlay();
      this.#overlays.set(name, overlay);
    }
    overlay.clear();
    return overlay;
  }

  close(): void {
    this.#overlays.forEach((overlay) => overlay.close());
    this.#trails.forEach(({table}) => table.close());
  }

  draw_radii(scene: Scene, projection: Projection): void {
    const {population, at, blend, camera, place} = scene;
    if (scene.look.perception === "none" || population === null) {
      return;
    }
    const visible = visible_part(camera, place);
    const radii = this.begin("radii");
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

  draw_trails(scene: Scene, projection: Projection, of_overlay: Projection): void {
    const {trails, at, blend} = scene;
    if (trails === null) {
      return;
    }
    const info = at.latest.info!, now_s = info.simulated_s, share = trail_share(info), kept_s = trail_kept_s * share;
    const of_look = scene.styles.trail;
    const style = {
      ...of_look,
      fill: with_alpha(of_look.fill, of_look.fill[3] * (0.5 + share / 2)),
      line_pixels: of_look.line_pixels * Math.sqrt(share)
    };
    for (const segment of trails.segments.filter(({from_s}) => from_s >= now_s - kept_s - trail_interval_s)) {
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
      const fill = with_alpha(style.fill, trail_alpha(style.fill[3], now_s - segment.to_s, kept_s));
      this.#shapes.draw(slot.table, segment.count, style, projection, {fill});
    }
    // From the last kept positions to the present ones.
    const paths = this.begin("paths");
    const lines = (this.#staging = with_room(this.#staging, 4 * at.latest.count));
    const count = add_paths(
      trails.last, at.latest.id, at.latest.count, (row) => at.x_at(row, blend), (row) => at.y_at(row, blend), lines,
      overlay_steps / steps_per_px);
    for (let i = 0; i < 4 * count; i += 4) {
      paths.push(
        lines[i]! / overlay_steps, lines[i + 1]! / overlay_steps, lines[i + 2]! / overlay_steps,
        lines[i + 3]! / overlay_steps);
    }
    paths.draw(this.#shapes, style, of_overlay);
  }

  /** Draws each flash as a growing and fading disc in the colour of what was eaten or died. */
  draw_flashes(scene: Scene, projection: Projection): void {
    const flashes = this.begin("flashes");
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
  draw_forces(scene: Scene, projection: Projection): void {
    const {population, at, blend, camera, place, colours} = scene;
    if (
      scene.look.forces === "none" || population === null || population.choices === null ||
      population.forces === null) {
      return;
    }
    const visible = visible_part(camera, place);
    const arrows = this.begin("arrows"), targets = this.begin("targets");
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

  /** Draws the background of the labels that name an organism. */
  draw_label_grounds({labels, place: {ratio}, styles, colours}: Scene): void {
    const overlay = this.begin("labels"), half_height = (label_height / 2) * ratio;
    for (const {left, top, width} of labels.filter(({is_named}) => is_named)) {
      const half_width = (width / 2) * ratio;
      overlay.push(left * ratio + half_width, top * ratio + half_height, half_width + 3 * ratio, half_height);
    }
    overlay.draw(
      this.#shapes, {...styles.obstacle, fill: with_alpha(colours.ground, 215), half_pixels_min: 0}, of_pixels);
  }

  draw_preview({preview, place: {ratio}, styles}: Scene): void {
    if (preview === null) {
      return;
    }
    const overlay = this.begin("preview");
    overlay.push(preview.x * ratio, preview.y * ratio, preview.radius * ratio, preview.radius * ratio);
    const style = {
      ...styles.pointed_at,
      fill: with_alpha(preview.colour, 110),
      edge: preview.colour,
      edge_pixels: 2,
      half_pixels_min: 3
    };
    overlay.draw(this.#shapes, style, of_pixels);
  }
}
