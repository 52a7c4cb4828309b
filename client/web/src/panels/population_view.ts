// PopulationView: the population of an island without bodies, as a line for each organism across an axis for each gene.
// It fills the pane in place of the island.
import {axes_with_room, best_of, bounded, lines_max, place_on, sample_of} from "../plots/parallel_axes";
import {theme_of, type PlotTheme} from "../plots/plot_theme";
import type {Size} from "../render/camera";
import {css, ramp_at} from "../render/look";
import type {PopulationColumns} from "../core/messages";
import type {ParameterSet} from "../core/protocol";
import {fitness_text} from "../texts/numbers";
import {gene_name} from "../texts/genes";
import {population_texts as texts} from "../texts/population";
import {observe_size} from "../widgets/canvas_size";
import {set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {on_theme_change} from "../widgets/theme";
import {gene_axes, gene_value_text, type GeneAxis} from "../world/gene_axes";
import {value_in_effect} from "../world/parameter_values";
import type {ViewedWorld} from "../world/world";

const organisms_read = 10_000; // of a larger population only the first ones are read
const upright_pixels = 72; // between axes with less room, labels are turned
const font_pixels = 11, line_pixels = 15;
const turned_high = 44, turned_gap = 6; // of turned labels: room for the upper bound, and between it and the name

type Axis = GeneAxis&{min: number; max: number; values: Float32Array; x: number};

export class PopulationView {
  readonly element: HTMLElement;
  readonly #canvas = h("canvas", {class: "population-canvas", role: "img"});
  readonly #shown = h("span", {});
  readonly #best = h("span", {class: "population-best"});
  readonly #low = h("span", {});
  readonly #high = h("span", {});
  readonly #bar = h("canvas", {class: "population-bar", width: 200, height: 1, "aria-hidden": "true"});
  readonly #scale = h("span", {class: "population-scale"}, texts.fitness, this.#low, this.#bar, this.#high);
  readonly #range = h("span", {});
  readonly #before = h("button", {type: "button", class: "button square", "aria-label": texts.before}, "‹");
  readonly #after = h("button", {type: "button", class: "button square", "aria-label": texts.after}, "›");
  readonly #pages = h("span", {class: "population-pages"}, this.#before, this.#range, this.#after);
  readonly #ends: (() => void)[];
  readonly #world: ViewedWorld;
  #release: (() => void)|null = null; // ends the reading of the population
  #size: Size = {width: 0, height: 0};
  #pixel_ratio = 1;
  #first_gene = 0;
  #is_light = false; // the ground: the greatest fitness is dark then
  #columns: PopulationColumns|null = null; // in the drawing
  #set: ParameterSet|null = null;          // its bounds
  #drawn = "";                             // what else determines it

  constructor(world: ViewedWorld) {
    this.#world = world;
    this.element = h(
      "div", {class: "population", hidden: true, role: "group", "aria-label": texts.name},
      h("div", {class: "population-head", role: "status"}, this.#shown, this.#best, this.#scale, this.#pages),
      h("div", {class: "population-area"}, this.#canvas));
    this.#before.addEventListener("click", () => this.#turn(-1));
    this.#after.addEventListener("click", () => this.#turn(1));
    this.#ends = [
      observe_size(this.#canvas.parentElement!, (size, pixel_ratio) => {
        this.#size = size;
        this.#pixel_ratio = pixel_ratio;
        this.refresh();
      }),
      on_theme_change(() => {
        this.#drawn = "";
        this.refresh();
      })
    ];
  }

  close(): void {
    this.#ends.forEach((end) => end());
    this.#release?.();
  }

  /** Shows the population if the organisms have no bodies. */
  refresh(): void {
    const is_shown = !this.#world.has_bodies;
    this.element.hidden = !is_shown;
    if (!is_shown) {
      this.#release?.();
      this.#release = null;
      return;
    }
    this.#release ??= this.#world.population.need(organisms_read);
    const {population: {columns}, parameters: {set}, look: {palette}} = this.#world, {width, height} = this.#size;
    const key = [width, height, this.#pixel_ratio, this.#first_gene, palette].join(" ");
    if (width > 0 && (columns !== this.#columns || set !== this.#set || key !== this.#drawn)) {
      this.#columns = columns;
      this.#set = set;
      this.#drawn = key;
      this.#draw(columns, gene_axes(this.#world.info, set));
    }
  }

  #turn(direction: number): void {
    const {gene_names} = this.#world, step = axes_with_room(gene_names.length, this.#size.width);
    this.#first_gene = Math.min(Math.max(this.#first_gene + direction * step, 0), gene_names.length - step);
    this.refresh();
  }

  // ---- the drawing ----

  #draw(columns: PopulationColumns|null, all: GeneAxis[]): void {
    const context = this.#canvas.getContext("2d")!, {width, height} = this.#size, ratio = this.#pixel_ratio;
    this.#canvas.width = Math.round(width * ratio);
    this.#canvas.height = Math.round(height * ratio);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    const theme = theme_of(this.#canvas);
    this.#is_light = is_light(context, theme.surface);
    const read = columns?.genes[0]?.length ?? 0, fitness = columns?.fitness ?? null, best = best_of(fitness);
    const count = axes_with_room(all.length, width);
    this.#first_gene = Math.max(Math.min(this.#first_gene, all.length - count), 0);
    const sample = sample_of(read, lines_max, best);
    this.#describe(columns, sample.length, best, count, all.length);
    if (columns === null || read === 0 || columns.genes.length !== all.length) {
      return;
    }
    const space = width / count, is_turned = space < upright_pixels;
    const axes = all.slice(this.#first_gene, this.#first_gene + count).map((axis, i): Axis => {
      const values = columns.genes[this.#first_gene + i]!;
      return {...bounded(axis, values), values, x: (i + 0.5) * space};
    });
    const top = is_turned ? between(0.3 * height, 70, 120) : 2.5 * line_pixels;
    const bottom = height - (is_turned ? between(0.13 * height, 30, 56) : 1.5 * line_pixels);
    context.font = `${font_pixels}px ${theme.font}`;
    this.#draw_axes(context, theme, axes, top, bottom);
    this.#draw_lines(context, axes, sample, fitness, top, bottom);
    if (best !== null) {
      context.strokeStyle = theme.text;
      context.lineWidth = 2.5;
      context.globalAlpha = 1;
      draw_line(context, axes, best, top, bottom);
    }
    for (const axis of axes) {
      if (is_turned) {
        draw_turned_labels(context, theme, axis, top, bottom, height);
      } else {
        draw_labels(context, theme, axis, space, top, bottom);
      }
    }
  }

  #describe(
    columns: PopulationColumns|null, drawn: number, best: number|null, axis_count: number, gene_count: number): void {
    const read = columns?.genes[0]?.length ?? 0, fitness = columns?.fitness ?? null;
    const has_objectives = (value_in_effect(this.#set, "objectives")?.count ?? 1) > 1;
    const best_text = best !== null ? texts.best(best, fitness![best]!) :
      has_objectives                ? texts.objectives :
                                      texts.unrated;
    set_text(this.#shown, columns === null ? texts.loading : texts.shown(drawn, read, columns.organism_count));
    set_text(this.#best, columns === null ? "" : best_text);
    set_attribute(this.#best, "data-known", best === null ? null : "");
    this.#scale.hidden = fitness === null;
    if (fitness !== null) {
      set_text(this.#low, fitness_text(least_of(fitness)));
      set_text(this.#high, fitness_text(fitness[best!]!));
      this.#draw_bar();
    }
    this.#pages.hidden = axis_count >= gene_count;
    set_text(this.#range, texts.genes(this.#first_gene + 1, this.#first_gene + axis_count, gene_count));
    this.#before.disabled = this.#first_gene === 0;
    this.#after.disabled = this.#first_gene + axis_count >= gene_count;
    set_attribute(this.#canvas, "aria-label", texts.canvas(axis_count, columns?.generation ?? 0, best_text));
  }

  #draw_axes(context: CanvasRenderingContext2D, theme: PlotTheme, axes: Axis[], top: number, bottom: number): void {
    context.strokeStyle = theme.grid;
    context.lineWidth = 1;
    context.beginPath();
    for (const {x} of axes) {
      context.moveTo(x, top);
      context.lineTo(x, bottom);
    }
    context.stroke();
  }

  #draw_lines(
    context: CanvasRenderingContext2D, axes: Axis[], sample: number[], fitness: Float64Array|null, top: number,
    bottom: number): void {
    const low = fitness === null ? 0 : least_of(fitness), high = fitness === null ? 0 : fitness[best_of(fitness)!]!;
    const share = (id: number): number =>
      fitness === null ? 0.5 : high > low ? (fitness[id]! - low) / (high - low) : 1;
    context.lineWidth = 1;
    context.globalAlpha = between(50 / sample.length, 0.06, 0.85);
    const in_order = fitness === null ? sample : [...sample].sort((a, b) => fitness[a]! - fitness[b]!); // the best last
    for (const id of in_order) {
      context.strokeStyle = this.#colour_of(share(id));
      draw_line(context, axes, id, top, bottom);
    }
    context.globalAlpha = 1;
  }

  /** share: 0 for the least fitness, 1 for the greatest. */
  #colour_of(share: number): string {
    return css(ramp_at(this.#world.look.palette, this.#is_light ? 1 - share : share));
  }

  #draw_bar(): void {
    const context = this.#bar.getContext("2d")!, {width} = this.#bar;
    for (let x = 0; x < width; ++x) {
      context.fillStyle = this.#colour_of((x + 0.5) / width);
      context.fillRect(x, 0, 1, 1);
    }
  }
}

function least_of(values: Float64Array): number {
  return values.reduce((least, value) => Math.min(least, value), Infinity);
}

function is_light(context: CanvasRenderingContext2D, ground: string): boolean {
  context.fillStyle = ground; // reads back as "#rrggbb"
  const channels = /^#(..)(..)(..)$/.exec(context.fillStyle)?.slice(1).map((channel) => parseInt(channel, 16)) ?? [0];
  return channels.reduce((sum, channel) => sum + channel, 0) > 3 * 128;
}

/** Draws the genes of an organism; a single gene as a short line on its axis. */
function draw_line(context: CanvasRenderingContext2D, axes: Axis[], id: number, top: number, bottom: number): void {
  const y_of = (axis: Axis): number => bottom - (bottom - top) * place_on(axis, axis.values[id]!);
  context.beginPath();
  if (axes.length === 1) {
    context.moveTo(axes[0]!.x - 20, y_of(axes[0]!));
    context.lineTo(axes[0]!.x + 20, y_of(axes[0]!));
  }
  axes.forEach((axis, i) => i === 0 ? context.moveTo(axis.x, y_of(axis)) : context.lineTo(axis.x, y_of(axis)));
  context.stroke();
}

function between(value: number, least: number, most: number): number {
  return Math.min(Math.max(value, least), most);
}

/** Draws the bounds and the name of an axis upwards. */
function draw_turned_labels(
  context: CanvasRenderingContext2D, theme: PlotTheme, axis: Axis, top: number, bottom: number, height: number): void {
  const {x} = axis, high = clipped(context, gene_value_text(axis, axis.max), turned_high);
  const name_y = top - 4 - context.measureText(high).width - turned_gap;
  context.textBaseline = "middle";
  draw_turned(context, theme.quiet, high, x, top - 4, "left");
  draw_turned(context, theme.text, clipped(context, gene_name(axis.name), name_y - 4), x, name_y, "left");
  const low = clipped(context, gene_value_text(axis, axis.min), height - bottom - 6);
  draw_turned(context, theme.quiet, low, x, bottom + 4, "right");
}

/** Draws the name of an axis, its bounds, and its choices. */
function draw_labels(
  context: CanvasRenderingContext2D, theme: PlotTheme, axis: Axis, space: number, top: number, bottom: number): void {
  const low = gene_value_text(axis, axis.min), high = gene_value_text(axis, axis.max), {x} = axis;
  context.textBaseline = "middle";
  context.textAlign = "center";
  context.fillStyle = theme.text;
  context.fillText(clipped(context, gene_name(axis.name), space - 6), x, line_pixels * 0.7);
  context.fillStyle = theme.quiet;
  context.fillText(clipped(context, high, space - 6), x, line_pixels * 1.8);
  context.fillText(clipped(context, low, space - 6), x, bottom + line_pixels * 0.8);
  const inner = axis.choices.slice(1, -1);
  if (inner.length > 0 && (bottom - top) / axis.choices.length >= line_pixels) {
    context.textAlign = "left";
    inner.forEach((choice, i) => {
      const y = bottom - (bottom - top) * place_on(axis, i + 1);
      draw_on_ground(context, theme, clipped(context, choice, space / 2 - 8), x + 5, y);
    });
  }
}

/** Draws text above lines. */
function draw_on_ground(
  context: CanvasRenderingContext2D, theme: PlotTheme, text: string, x: number, y: number): void {
  context.lineWidth = 3;
  context.strokeStyle = theme.surface;
  context.strokeText(text, x, y);
  context.fillStyle = theme.quiet;
  context.fillText(text, x, y);
}

/** Draws text that is read from below. */
function draw_turned(
  context: CanvasRenderingContext2D, colour: string, text: string, x: number, y: number, align: "left"|"right"): void {
  context.save();
  context.translate(x, y);
  context.rotate(-Math.PI / 2);
  context.textAlign = align;
  context.fillStyle = colour;
  context.fillText(text, 0, 0);
  context.restore();
}

/** Shortens a text to a width. */
function clipped(context: CanvasRenderingContext2D, text: string, width: number): string {
  if (context.measureText(text).width <= width) {
    return text;
  }
  let length = text.length;
  while (length > 1 && context.measureText(`${text.slice(0, length)}…`).width > width) {
    --length;
  }
  return `${text.slice(0, length)}…`;
}
