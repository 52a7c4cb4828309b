// Fallback: draws a scene with Canvas2D, for browsers without WebGL2. Organisms are discs with an arc of health while
// there are few; otherwise densities are drawn. Food and poison are squares, of which at most a share is drawn.
import {steps_per_px} from "../core/snapshot";

import {type Size, visible_part} from "./camera";
import {label_height} from "./glyphs";

import type {KeptBoxes, Points} from "./interpolator";
import {type Colour, css, with_alpha} from "./look";
import {few_organisms, is_kept, may_touch, seen_pixels_min} from "./marks";
import {arrow_px_per_force, chosen_rows, colour_of_choice, inside_walls, Painter, Scene, Surface} from "./scene";

const items_max = 3_000;

export class FallbackSurface implements Surface {
  readonly #context: OffscreenCanvasRenderingContext2D;

  constructor(context: OffscreenCanvasRenderingContext2D) {
    this.#context = context;
  }

  painter(): Painter {
    return new Fallback(this.#context);
  }

  fill({width, height}: Size, ratio: number, colour: Colour): void {
    this.#context.setTransform(ratio, 0, 0, ratio, 0, 0);
    this.#context.fillStyle = css(colour);
    this.#context.fillRect(0, 0, width, height);
  }

  close(): void {}
}

class Fallback implements Painter {
  readonly kind = "canvas2d";
  readonly organisms_max = 3_000;
  readonly label_height = label_height;

  readonly #context: OffscreenCanvasRenderingContext2D;

  constructor(context: OffscreenCanvasRenderingContext2D) {
    this.#context = context;
  }

  measure(text: string): number {
    this.#context.font = '13px system-ui, "DejaVu Sans", sans-serif';
    return this.#context.measureText(text).width;
  }

  close(): void {}

  draw(scene: Scene): void {
    const context = this.#context;
    const {left, top, width, height, ratio} = scene.place;
    context.save();
    context.setTransform(ratio, 0, 0, ratio, left * ratio, top * ratio);
    context.beginPath();
    context.rect(0, 0, width, height);
    context.clip();
    context.fillStyle = css(scene.colours.outside);
    context.fillRect(0, 0, width, height);
    this.#draw_island(scene);
    context.restore();
  }

  #draw_island(scene: Scene): void {
    const context = this.#context, {colours, at, place: {frame: {walls}}} = scene;
    const info = at.latest.info;
    if (info === null) {
      return;
    }
    const inside = inside_walls(scene, {width: info.width_px, height: info.height_px});
    context.fillStyle = css(colours.wall);
    context.fillRect(inside.left - walls, inside.top - walls, inside.width + 2 * walls, inside.height + 2 * walls);
    context.fillStyle = css(colours.ground);
    context.fillRect(inside.left, inside.top, inside.width, inside.height);
    const x_of = (steps: number) => inside.left + (steps / steps_per_px) * scene.camera.zoom;
    const y_of = (steps: number) => inside.top + (steps / steps_per_px) * scene.camera.zoom;
    this.#draw_boxes(at.latest.obstacles, css(colours.obstacle), scene, x_of, y_of);
    this.#draw_boxes(at.latest.crates, css(colours.crate), scene, x_of, y_of);
    if (scene.shows === "density") {
      this.#draw_density(scene, inside.left, inside.top);
    } else {
      this.#draw_points(at.latest.poison, css(colours.poison), info.item_radius_px, scene, x_of, y_of);
      this.#draw_points(at.latest.food, css(colours.food), info.item_radius_px, scene, x_of, y_of);
      this.#draw_points(at.latest.organism_dots, css(colours.body), 2 / scene.camera.zoom, scene, x_of, y_of);
      this.#draw_organisms(scene, x_of, y_of);
    }
    this.#draw_labels(scene);
    this.#draw_minimap(scene);
  }

  #draw_boxes(
    boxes: KeptBoxes, fill: string, {camera}: Scene, x_of: (x: number) => number, y_of: (y: number) => number): void {
    this.#context.fillStyle = fill;
    for (let i = 0; i < boxes.count; ++i) {
      const half_width = Math.max((boxes.half_width[i]! / steps_per_px) * camera.zoom, 1);
      const half_height = Math.max((boxes.half_height[i]! / steps_per_px) * camera.zoom, 1);
      this.#context.fillRect(
        x_of(boxes.x[i]!) - half_width, y_of(boxes.y[i]!) - half_height, 2 * half_width, 2 * half_height);
    }
  }

  #draw_points(
    points: Points, fill: string, radius_px: number, {camera, place}: Scene, x_of: (x: number) => number,
    y_of: (y: number) => number): void {
    const half = Math.max(radius_px * camera.zoom, 1);
    const share = items_max / Math.max(points.count, 1);
    this.#context.fillStyle = fill;
    for (let i = 0; i < points.count; ++i) {
      const x = x_of(points.x[i]!);
      const y = y_of(points.y[i]!);
      const is_visible = x >= -half && y >= -half && x <= place.width + half && y <= place.height + half;
      if (is_visible && is_kept(points.x[i]! / steps_per_px, points.y[i]! / steps_per_px, share)) {
        this.#context.fillRect(x - half, y - half, 2 * half, 2 * half);
      }
    }
  }

  #draw_organisms(scene: Scene, x_of: (x: number) => number, y_of: (y: number) => number): void {
    const context = this.#context;
    const {at, blend, camera, colours, place, organism_colours} = scene;
    const {latest} = at;
    const visible = visible_part(camera, place), is_seen = latest.has_headings || latest.count <= few_organisms;
    const bytes =
      organism_colours === null ? null : new Uint8Array(organism_colours.buffer, organism_colours.byteOffset);
    for (let i = 0; i < latest.count; ++i) {
      const radius_px = latest.radius[i]! / steps_per_px;
      if (!may_touch(visible, at.x_at(i, blend) / steps_per_px, at.y_at(i, blend) / steps_per_px, radius_px)) {
        continue;
      }
      const x = x_of(at.x_at(i, blend));
      const y = y_of(at.y_at(i, blend));
      const radius = Math.max(radius_px * camera.zoom, is_seen ? seen_pixels_min : 1.5);
      const share = Math.min(latest.health[i]! / steps_per_px / scene.health_max, 1);
      context.fillStyle =
        bytes !== null ? `rgb(${bytes[4 * i]}, ${bytes[4 * i + 1]}, ${bytes[4 * i + 2]})` : css(colours.body);
      context.beginPath();
      context.arc(x, y, radius, 0, 2 * Math.PI);
      context.fill();
      if (radius >= 3) {
        context.strokeStyle = css(colours.arc);
        context.lineWidth = Math.min(2, 0.4 * radius);
        context.beginPath();
        context.arc(x, y, radius + 2, -Math.PI / 2, 2 * Math.PI * share - Math.PI / 2);
        context.stroke();
      }
    }
    this.#draw_chosen(scene, x_of, y_of);
  }

  /** Draws rings of perception, forces and the rings around the selected organism and the one at the mouse. */
  #draw_chosen(scene: Scene, x_of: (x: number) => number, y_of: (y: number) => number): void {
    const context = this.#context;
    const {at, blend, camera, colours, population, look, styles} = scene;
    const ring = (row: number, radius: number, colour: string, width: number) => {
      context.strokeStyle = colour;
      context.lineWidth = width;
      context.beginPath();
      context.arc(x_of(at.x_at(row, blend)), y_of(at.y_at(row, blend)), radius, 0, 2 * Math.PI);
      context.stroke();
    };
    for (const row of population === null ? [] : chosen_rows(look.perception, scene)) {
      for (const [gene, colour] of [["food_radius", colours.food_radius], ["poison_radius", colours.poison_radius]] as
           const) {
        const radius = population!.genes[population!.gene_names.indexOf(gene)]?.[at.latest.id[row]!];
        if (radius !== undefined) {
          ring(row, radius * camera.zoom, css(colour), 1);
        }
      }
    }
    for (const row of population?.forces && population.choices ? chosen_rows(look.forces, scene) : []) {
      const id = at.latest.id[row]!;
      const x = x_of(at.x_at(row, blend));
      const y = y_of(at.y_at(row, blend));
      const scale = arrow_px_per_force * camera.zoom;
      context.strokeStyle = css(colour_of_choice(population!.choices![id] ?? 0, colours));
      context.lineWidth = 2;
      context.beginPath();
      context.moveTo(x, y);
      context.lineTo(x + scale * (population!.forces![0]![id] ?? 0), y + scale * (population!.forces![1]![id] ?? 0));
      context.stroke();
    }
    for (const [row, style] of [[scene.selected, styles.selected], [scene.pointed_at, styles.pointed_at]] as const) {
      if (row >= 0) {
        const radius = (at.latest.radius[row]! / steps_per_px) * camera.zoom + styles.highlight_pixels;
        ring(row, Math.max(radius, style.half_pixels_min) - style.edge_pixels / 2, css(style.edge), style.edge_pixels);
      }
    }
  }

  #draw_density({density, density_scale, camera, at}: Scene, left: number, top: number): void {
    const context = this.#context;
    const {width_px, height_px} = at.latest.info!;
    for (let i = 0; i < density.columns * density.rows; ++i) {
      const count = density.counts[i]!;
      if (count > 0) {
        const colour = density_scale!.at(count);
        const x_px = density.left_px + (i % density.columns) * density.cell_px;
        const y_px = density.top_px + Math.floor(i / density.columns) * density.cell_px;
        context.fillStyle = `rgb(${colour & 255}, ${(colour >> 8) & 255}, ${(colour >> 16) & 255})`;
        context.fillRect(
          left + x_px * camera.zoom, top + y_px * camera.zoom, Math.min(density.cell_px, width_px - x_px) * camera.zoom,
          Math.min(density.cell_px, height_px - y_px) * camera.zoom);
      }
    }
  }

  #draw_labels({labels, colours}: Scene): void {
    const context = this.#context;
    this.measure(""); // sets the font
    context.textBaseline = "top";
    context.lineJoin = "round";
    context.lineWidth = 3;
    context.strokeStyle = css(with_alpha(colours.ground, 210));
    context.fillStyle = css(colours.label);
    for (const {text, left, top} of labels) {
      context.strokeText(text, Math.round(left), Math.round(top));
      context.fillText(text, Math.round(left), Math.round(top));
    }
  }

  #draw_minimap({minimap, colours}: Scene): void {
    if (minimap === null) {
      return;
    }
    const context = this.#context;
    const {left, top, width, height} = minimap.place.screen;
    const {grid} = minimap;
    const cell = grid.cell_px * minimap.place.zoom;
    context.fillStyle = css(colours.wall);
    context.fillRect(left - 1, top - 1, width + 2, height + 2);
    context.fillStyle = css(colours.ground);
    context.fillRect(left, top, width, height);
    for (let i = 0; i < grid.columns * grid.rows; ++i) {
      if (grid.counts[i]! > 0) {
        const x = left + (i % grid.columns) * cell;
        const y = top + Math.floor(i / grid.columns) * cell;
        context.fillStyle = css(with_alpha(colours.body, 60 + 195 * Math.min(grid.counts[i]! / minimap.scale.high, 1)));
        context.fillRect(x, y, Math.min(cell, left + width - x), Math.min(cell, top + height - y));
      }
    }
    context.strokeStyle = css(colours.selected);
    context.lineWidth = 2;
    context.strokeRect(minimap.frame.left, minimap.frame.top, minimap.frame.width, minimap.frame.height);
  }
}
