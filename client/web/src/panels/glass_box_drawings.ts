// Drawings of the glass box: the wheel, a tournament, fitness by rank, the picks in order, copies by rank, the next
// generation in a row, and one descendant with its parents. Each function returns a new element.
import {contender_text} from "../breeding/caption";
import {type Comparison, divided, pick_columns, rank_columns} from "../breeding/comparison";
import {
  brings_back,
  gene_blocks,
  type GeneOrigin,
  type Inheritance,
  inheritance_of,
  origin_text,
  other_genes_text
} from "../breeding/inheritance";
import {type BreedingRecord, rank_of, slot_of} from "../breeding/record";
import {contestants_of} from "../breeding/tournament";
import {point_at, rank_colour, ring_path, text_on, wheel_arcs} from "../breeding/wheel";
import {gene_label} from "../organism/texts";
import type {Descendant} from "../core/protocol";
import {css} from "../render/look";
import {breeding_texts, delta_text, gene_text} from "../texts/breeding";
import {glass_box_texts} from "../texts/glass_box";
import {h, svg} from "../widgets/dom";
import {svg_label, svg_line, svg_rect} from "../widgets/svg";

const columns_max = 12; // genes in the table of a descendant; more are drawn as small cells

function colour_of(record: BreedingRecord, rank: number): string {
  return css(rank_colour(rank, record.contender_count));
}

function drawing(width: number, height: number, label: string): SVGSVGElement {
  return svg(
    "svg",
    {class: "glass-drawing", viewBox: `0 0 ${width} ${height}`, width, height, role: "img", "aria-label": label});
}

// ---- the wheel -------------------------------------------------------------------------------------------------

/** The wheel of a breeding. Its slots are drawn once; show() moves the pointer. */
export class WheelDrawing {
  readonly element: SVGSVGElement;
  readonly #pointers = svg("g", {});
  readonly #radius: number;
  readonly #slots: number;

  readonly #record: BreedingRecord;
  readonly #size: number;
  #complete: boolean;

  constructor(record: BreedingRecord, size: number, complete: boolean) {
    this.#record = record;
    this.#size = size;
    this.#complete = complete;
    this.element = drawing(size, size, "");
    this.#radius = size / 2 - 24;
    this.#slots = record.contenders.length;
    const centre = size / 2, inner = this.#radius * 0.6, middle = (this.#radius + inner) / 2;
    const circumference = 2 * Math.PI * this.#radius;
    this.element.append(
      svg("circle", {class: "wheel-empty", cx: centre, cy: centre, r: middle, "stroke-width": this.#radius - inner}));
    for (const arc of wheel_arcs(record.contenders, 1 / circumference)) {
      const colour = rank_colour(arc.rank, record.contender_count), length = (arc.end - arc.begin) * circumference;
      this.element.append(svg(
        "path", {
          d: ring_path(centre, inner, this.#radius, arc.begin, arc.end),
          fill: css(colour),
          class: length > 4 ? "wheel-slot" : "",
        },
        svg(
          "title", {},
          arc.first === arc.last ? contender_text(arc.first, record.contenders[arc.first]!, complete) :
                                   glass_box_texts.narrow_slots(arc.first, arc.last))));
      if (arc.first === arc.last && length > 24) {
        const {x, y} = point_at(centre, middle, (arc.begin + arc.end) / 2);
        this.element.append(svg_label("wheel-label", [x, y], String(arc.first), {fill: text_on(colour)}));
      }
    }
    this.element.append(this.#pointers);
  }

  /** Whether the slots of this drawing are those of the record at this size. */
  fits(record: BreedingRecord, size: number, complete: boolean): boolean {
    return record === this.#record && size === this.#size && complete === this.#complete &&
      record.contenders.length === this.#slots;
  }

  show(index: number, caption: string): void {
    const record = this.#record, size = this.#size, radius = this.#radius;
    const centre = size / 2, inner = radius * 0.6;
    this.element.setAttribute("aria-label", caption);
    const parts: SVGElement[] = [];
    const pick = record.picks[index];
    const chosen = pick ? record.contenders[pick.organism ?? 0] : undefined;
    if (chosen && slot_of(chosen) > 0) {
      parts.push(svg(
        "path",
        {class: "wheel-chosen", d: ring_path(centre, inner, radius, chosen.slot_begin ?? 0, chosen.slot_end ?? 0)}));
    }
    // In stochastic universal sampling one spin sets all pointers; in roulette selection the wheel is spun for each
    // pick.
    const marks = record.choice("selection") === "stochastic_universal" ? record.picks.length : index;
    const outline = (from: number, to: number): string =>
      record.picks.slice(from, to)
        .map((other) => {
          const begin = point_at(centre, radius + 2, other.turns ?? 0),
                end = point_at(centre, radius + 9, other.turns ?? 0);
          return `M${begin.x.toFixed(1)} ${begin.y.toFixed(1)}L${end.x.toFixed(1)} ${end.y.toFixed(1)}`;
        })
        .join("");
    parts.push(
      svg("path", {class: "wheel-mark", d: outline(0, index)}),
      svg("path", {class: "wheel-mark later", d: outline(index, marks)}));
    if (pick?.turns !== undefined) {
      const half = 7 / (2 * Math.PI * radius);
      const points = [
        point_at(centre, radius + 1, pick.turns), point_at(centre, radius + 18, pick.turns - half),
        point_at(centre, radius + 18, pick.turns + half)
      ];
      const from = point_at(centre, inner, pick.turns), to = point_at(centre, radius, pick.turns);
      parts.push(
        svg("polygon", {class: "pointer", points: points.map(({x, y}) => `${x.toFixed(1)},${y.toFixed(1)}`).join(" ")}),
        svg_line("pointer-line", [from.x, from.y, to.x, to.y]));
    }
    if (chosen) {
      const wide = inner > 65;
      const lines = [
        glass_box_texts.slot_organism(pick!.organism ?? 0),
        glass_box_texts.slot_rank(rank_of(chosen), wide ? record.contender_count : null),
        glass_box_texts.slot_share(slot_of(chosen), wide)
      ];
      lines.forEach((line, i) => parts.push(svg_label("wheel-centre", [centre, centre + 19 * (i - 1)], line)));
    }
    this.#pointers.replaceChildren(...parts);
  }
}

// ---- tournaments and ranks -------------------------------------------------------------------------------------

/** The contestants of the tournament of pick `index`; the winners are framed. */
export function draw_tournament(record: BreedingRecord, index: number, complete: boolean): HTMLElement {
  const contestants = contestants_of(record, index);
  const fitness = contestants.map((contestant) => record.contenders[contestant.organism]?.fitness ?? 0);
  const least = Math.min(0, ...fitness), span = Math.max(0, ...fitness) - least || 1;
  return h(
    "ol", {class: "tournament", "aria-label": glass_box_texts.contestants}, ...contestants.map((contestant, i) => {
      const contender = record.contenders[contestant.organism];
      const bar = h("span", {class: "tournament-bar"});
      bar.style.width = `${(100 * (fitness[i]! - least) / span).toFixed(1)}%`;
      bar.style.background = contender ? colour_of(record, rank_of(contender)) : "none";
      return h(
        "li", {
          class: contestant.picked_now ? "tournament-row picked-now" :
            contestant.won             ? "tournament-row won" :
                                         "tournament-row",
          title: contender ? contender_text(contestant.organism, contender, complete) : null,
        },
        h("span", {class: "tournament-id"}, String(contestant.organism)), h("span", {class: "tournament-track"}, bar),
        h("span", {class: "tournament-value"},
          contender ? glass_box_texts.contestant_fitness(contender.fitness ?? 0, contestant.won) :
                      glass_box_texts.unknown));
    }));
}

interface Bars {
  title: string;
  value_of: (rank: number) => number;
  copies: readonly number[]; // a dot marks each rank with copies
  current: number|null; // a pointer marks this organism
}

/** One bar per rank. If there are more ranks than places, each bar shows the mean of neighbouring ranks. */
function draw_bars(
  record: BreedingRecord, comparison: Comparison, bars: Bars, width: number, height: number,
  complete: boolean): SVGSVGElement {
  const count = comparison.organisms.length, top = 38, bottom = height - 2;
  const values = comparison.organisms.map((_, rank) => bars.value_of(rank));
  const least = values.reduce((a, b) => Math.min(a, b), 0), most = values.reduce((a, b) => Math.max(a, b), 0),
        span = most - least || 1;
  const y_of = (value: number): number => bottom - (value - least) / span * (bottom - top);
  const range = glass_box_texts.rank_range(values[0] ?? 0, values[count - 1] ?? 0, count);
  const image = drawing(width, height, glass_box_texts.by_rank(bars.title, range));
  image.append(
    svg_label("drawing-title", [0, 10], bars.title),
    svg_label("drawing-quiet", [width, 10], range, {"text-anchor": "end"}));
  const columns = divided(count, Math.floor(width / 2)), each = width / columns.length, gap = each > 5 ? 1 : 0;
  columns.forEach(({first, last}, i) => {
    const ranks = Array.from({length: last - first + 1}, (_, n) => first + n);
    const mean = ranks.reduce((sum, rank) => sum + values[rank]!, 0) / ranks.length;
    const y = Math.min(y_of(mean), y_of(0)), middle = i * each + (each - gap) / 2;
    const organism = comparison.organisms[first]!;
    image.append(svg_rect(
      "rank-bar", [i * each, y, each - gap, Math.max(y_of(mean), y_of(0)) - y + 1], {fill: colour_of(record, first)},
      svg(
        "title", {},
        ranks.length === 1 ? contender_text(organism, record.contenders[organism]!, complete) :
                             glass_box_texts.ranks(first, last))));
    if (ranks.some((rank) => comparison.organisms[rank] === bars.current)) {
      image.append(svg(
        "polygon", {class: "pointer", points: `${middle - 6},${y - 12} ${middle + 6},${y - 12} ${middle},${y - 2}`}));
    } else if (ranks.some((rank) => (bars.copies[rank] ?? 0) > 0)) {
      image.append(svg("circle", {class: "picked-dot", cx: middle, cy: y - 5, r: 2.5}));
    }
  });
  image.append(svg_line("axis", [0, y_of(0), width, y_of(0)]));
  return image;
}

/** Fitness by rank; for a wheel with fitness scaling, also the weights below. */
export function draw_ranking(
  record: BreedingRecord, comparison: Comparison, copies: readonly number[], current: number|null, width: number,
  complete: boolean): HTMLElement {
  const method = record.choice("selection");
  const scaled =
    (method === "roulette" || method === "stochastic_universal") && record.choice("fitness_scaling") !== "none";
  const weight_of = (rank: number): number => record.contenders[comparison.organisms[rank]!]!.weight ?? 0;
  return h(
    "div", {class: "panel"},
    draw_bars(
      record, comparison,
      {title: glass_box_texts.fitness, value_of: (rank) => comparison.fitness[rank]!, copies, current}, width,
      scaled ? 150 : 220, complete),
    scaled &&
      draw_bars(
        record, comparison, {title: glass_box_texts.weight, value_of: weight_of, copies: [], current: null}, width, 150,
        complete));
}

/** The picks up to `index` in order, coloured by rank. */
export function draw_picks(
  record: BreedingRecord, index: number, width: number, go_to: (pick: number) => void): SVGSVGElement {
  const columns = pick_columns(record, index, Math.floor(width / 2));
  const each = Math.min(14, width / Math.max(columns.length, 1));
  const image = drawing(width, 20, glass_box_texts.picks_in_order(index, record.pick_count));
  columns.forEach(
    (column, i) => image.append(svg_rect(
      column.rank === null ? "strip-cell empty" : "strip-cell", [i * each, 3, each - (each > 4 ? 1 : 0), 14],
      {fill: column.rank === null ? null : colour_of(record, column.rank), onclick: () => go_to(column.first)},
      svg("title", {}, glass_box_texts.one_pick(column.first)))));
  const now = columns.findIndex((column) => column.first <= index && index <= column.last);
  image.append(svg_rect("strip-current", [Math.max(0, now * each - 1), 1, Math.max(each, 2) + 1, 18]));
  return image;
}

/** The observed and the expected copies of each rank with their standard errors; after all picks, the deviations below.
 *
 *  expected_share  the fraction of all picks that `copies` includes, 0 to 1 */
export function draw_copies(
  record: BreedingRecord, comparison: Comparison, copies: readonly number[], expected_share: number, complete: boolean,
  width: number): SVGSVGElement {
  const margin = 26, right = width - margin, top = 22, bottom = 150, lower_top = bottom + 44,
        lower_bottom = lower_top + 90;
  const columns = rank_columns(comparison, copies, expected_share, Math.floor(right / 3));
  const most = columns.reduce((a, column) => Math.max(a, column.copies, column.expected + column.standard_error), 1);
  const y_of = (value: number): number => bottom - Math.min(Math.max(value, 0) / most, 1) * (bottom - top);
  const deviation_max = 4, zero = (lower_top + lower_bottom) / 2; // larger deviations are drawn at the end of the axis
  const deviation_y = (off: number): number =>
    zero - Math.min(Math.max(off, -deviation_max), deviation_max) / deviation_max * (lower_bottom - lower_top) / 2;
  const image = drawing(width, complete ? lower_bottom + 4 : bottom + 20, glass_box_texts.copies_label);
  image.append(svg_label("drawing-title", [0, 10], glass_box_texts.copies_title));
  const each = right / columns.length, gap = each > 5 ? 1 : 0;
  if (complete) {
    image.append(
      svg_rect("expected-band", [0, deviation_y(2), right, deviation_y(-2) - deviation_y(2)]),
      svg_line("axis", [0, zero, right, zero]),
      svg_label("drawing-title", [0, lower_top - 12], glass_box_texts.deviation_title),
      svg_label("drawing-quiet", [width, deviation_y(2)], glass_box_texts.plus_two, {"text-anchor": "end"}),
      svg_label("drawing-quiet", [width, deviation_y(-2)], glass_box_texts.minus_two, {"text-anchor": "end"}));
  }
  columns.forEach((column, i) => {
    const x = i * each, middle = x + (each - gap) / 2;
    const note = (column.first === column.last ?
                    glass_box_texts.one_rank(
                      column.first, comparison.organisms[column.first]!, comparison.fitness[column.first]!) :
                    glass_box_texts.ranks(column.first, column.last)) +
      glass_box_texts.copies(column.copies, column.expected, column.standard_error, complete ? column.deviation : null);
    const group = svg(
      "g", {}, svg("title", {}, note), svg_rect("hover-area", [x, top, each, (complete ? lower_bottom : bottom) - top]),
      svg_rect(
        "rank-bar", [x, y_of(column.copies), each - gap, bottom - y_of(column.copies)],
        {fill: colour_of(record, column.first)}),
      svg_line(
        "error-bar",
        [middle, y_of(column.expected - column.standard_error), middle, y_of(column.expected + column.standard_error)]),
      svg_line("expected-line", [x, y_of(column.expected), x + each, y_of(column.expected)]));
    if (complete) {
      const from = deviation_y(Math.max(column.deviation, 0)), to = deviation_y(Math.min(column.deviation, 0));
      group.append(svg_rect(
        Math.abs(column.deviation) > 2 ? "deviation large" : "deviation", [x, from, each - gap, to - from + 1]));
    }
    image.append(group);
  });
  image.append(
    svg_line("axis", [0, bottom, right, bottom]),
    svg_label("drawing-quiet", [0, bottom + 12], glass_box_texts.rank_label(0)),
    svg_label(
      "drawing-quiet", [right, bottom + 12], glass_box_texts.rank_label(comparison.organisms.length - 1),
      {"text-anchor": "end"}));
  return image;
}

// ---- descendants -----------------------------------------------------------------------------------------------

/** The next generation as a row of cells: elite, survivors, children. The cell of `current` is framed. */
export function draw_descendants(
  record: BreedingRecord, current: number|null, width: number, go_to: (descendant: number) => void): SVGSVGElement {
  const count = Math.max(record.descendant_count, 1), each = Math.min(14, width / count), gap = each > 4 ? 1 : 0;
  const image = drawing(
    width, 20,
    current === null ? glass_box_texts.next_generation :
                       glass_box_texts.descendant_of(current, record.descendant_count));
  const part = (begin: number, end: number, kind: string): void => {
    for (let i = begin; i<end; i += gap>0 ? 1 : end - begin) { // narrow cells form one bar
      image.append(svg_rect(`strip-cell ${kind}`, [i * each, 3, (gap > 0 ? 1 : end - begin) * each - gap, 14]));
    }
  };
  part(0, Math.min(record.elite_count, count), "elite");
  part(record.elite_count, Math.min(record.survivor_count, count), "survivor");
  part(record.survivor_count, record.descendant_count, "child");
  if (current !== null) {
    image.append(svg_rect("strip-current", [Math.max(0, current * each - 1), 1, Math.max(each, 2) + 1, 18]));
  }
  image.addEventListener(
    "click",
    (event) =>
      go_to(Math.min(count - 1, Math.max(0, Math.floor((event.clientX - image.getBoundingClientRect().left) / each)))));
  return image;
}

function swatch(kind: string, text: string): HTMLElement {
  return h("span", {}, h("span", {class: `swatch ${kind}`}), text);
}

export function descendants_legend(): HTMLElement {
  return h(
    "p", {class: "hint glass-legend"}, swatch("elite", glass_box_texts.elite),
    swatch("survivor", glass_box_texts.survivors), swatch("child", glass_box_texts.children));
}

function parents_legend(alone: boolean): HTMLElement {
  return h(
    "p", {class: "hint glass-legend"}, !alone && swatch("first", glass_box_texts.first_parent),
    !alone && swatch("second", glass_box_texts.second_parent), !alone && swatch("blended", glass_box_texts.blended),
    !alone && swatch("cut", glass_box_texts.cut), swatch("mutated", glass_box_texts.mutated));
}

function kind_of(origin: GeneOrigin): string {
  return origin.blended ? "blended" : origin.from_second ? "second" : "first";
}

/** One descendant with its parents, cuts, crossover, order mutation and mutations, below each other. Of a long
 *  chromosome, only the genes of the body are columns; a small cell shows from which parent each other gene comes.
 *
 *  body_count  the number of genes of the body, which come first */
export function draw_family(descendant: Descendant, gene_names: readonly string[], body_count: number): HTMLElement {
  const inheritance = inheritance_of(descendant);
  if (!inheritance) {
    return h("p", {class: "error"}, glass_box_texts.contradiction);
  }
  const all = inheritance.genes.length;
  const count = all > columns_max && body_count > 0 ? Math.min(body_count, all) : all;
  const genes = Array.from({length: count}, (_, gene) => gene);
  const names = Array.from({length: all}, (_, gene) => gene_names[gene] ?? glass_box_texts.unnamed_gene(gene));
  const cell = (gene: number, value: number, kind: string, title: string): HTMLElement =>
    h("td", {
      class: `gene-cell ${kind}${inheritance.cuts.includes(gene) ? " cut" : ""}`,
      title,
    },
      gene_text(value));
  const row = (label: string, kind: string, cells: (HTMLElement|null)[]): HTMLElement =>
    h("tr", {class: kind}, h("th", {scope: "row"}, label), ...cells.map((content) => content ?? h("td", {})));
  const parent_row = (second: boolean, label: string): HTMLElement => row(
    `${label} ${(second ? descendant.second_parent : descendant.first_parent) ?? 0}`, "parent-row",
    genes.map((gene) => {
      const origin = inheritance.crossed[gene]!, given = origin.blended || origin.from_second === second;
      return cell(
        gene, (second ? inheritance.second : inheritance.first)[gene]!,
        (second ? "second" : "first") + (given ? "" : " not-given"),
        glass_box_texts.gene_received(gene_label(names[gene]!), given));
    }));
  const rows = [parent_row(false, inheritance.alone ? glass_box_texts.itself : glass_box_texts.parent)];
  if (!inheritance.alone) {
    rows.push(
      parent_row(true, glass_box_texts.parent), row(glass_box_texts.crossed, "crossed-row", genes.map((gene) => {
        const origin = inheritance.crossed[gene]!;
        return cell(
          gene, origin.value, kind_of(origin),
          origin.blended       ? glass_box_texts.from_both(gene_label(names[gene]!)) :
            origin.from_second ? glass_box_texts.from_second(gene_label(names[gene]!)) :
                                 glass_box_texts.from_first(gene_label(names[gene]!)));
      })));
  }
  if (descendant.order_mutation) {
    rows.push(row(descendant.order_mutation.method ?? glass_box_texts.order, "arranged-row", genes.map((gene) => {
      const origin = inheritance.arranged[gene]!;
      return h(
        "td", {class: `gene-cell ${kind_of(origin)}`}, gene_text(origin.value),
        origin.gene === gene ?
          null :
          h("span", {class: "gene-moved"}, glass_box_texts.moved_from(gene_label(names[origin.gene]!))));
    })));
  }
  if (inheritance.changes.some((change) => change.gene < count)) {
    rows.push(row(
      glass_box_texts.mutations, "mutation-row",
      genes.map(
        (gene) => h(
          "td", {},
          ...inheritance.changes.filter((change) => change.gene === gene)
            .map(
              (change) =>
                h("div", {
                  class: brings_back(change.kind) ? "gene-change clamped" : "gene-change",
                  title: glass_box_texts.mutation(
                    delta_text(change.after - change.before), breeding_texts.mutation[change.kind]),
                },
                  h("span", {}, gene_text(change.before)),
                  h("span", {}, glass_box_texts.changed_to(gene_text(change.after))),
                  h("span", {}, breeding_texts.mutation[change.kind])))))));
  }
  const final: number[] = descendant.genes ?? inheritance.genes;
  rows.push(row(
    glass_box_texts.organism_row(descendant.id ?? 0), "organism-row",
    genes.map(
      (gene) =>
        h("td", {
          class: `gene-cell ${kind_of(inheritance.arranged[gene]!)}${inheritance.changed[gene] ? " mutated" : ""}`,
          title: origin_text(inheritance, gene, gene_label(names[gene]!), descendant),
        },
          gene_text(final[gene] ?? inheritance.genes[gene]!)))));
  return h(
    "div", {class: "panel"},
    h("div", {class: "family-scroll"},
      h("table", {class: "family-table", "aria-label": glass_box_texts.gene_table},
        h("thead", {},
          h("tr", {}, h("td", {}), ...genes.map((gene) => h("th", {scope: "col"}, gene_label(names[gene]!))))),
        h("tbody", {}, ...rows))),
    all > count && draw_other_genes(inheritance, count, names, descendant), parents_legend(inheritance.alone));
}

/** The genes that are not columns as small cells in the colours of their parents, neuron by neuron. */
function draw_other_genes(
  inheritance: Inheritance, first: number, names: readonly string[], descendant: Descendant): HTMLElement {
  const note = h("p", {class: "hint gene-note", "aria-live": "polite"}, glass_box_texts.other_genes_help);
  const cells: HTMLElement[] = [];
  const show = (event: Event): void => { // texts are made when they are read: there may be thousands of cells
    const cell = event.target as HTMLElement, gene = cell.dataset.gene;
    if (gene !== undefined) {
      note.textContent = origin_text(inheritance, Number(gene), gene_label(names[Number(gene)]!), descendant);
      cell.setAttribute("aria-label", note.textContent);
    }
  };
  const blocks = gene_blocks(names, first)
                   .map(
                     (block) =>
                       h("span", {class: "gene-block"}, h("span", {class: "gene-block-label"}, gene_label(block.label)),
                         ...Array.from({length: block.count}, (_, i) => {
                           const gene = block.first + i, origin = inheritance.arranged[gene]!;
                           const cell = h("span", {
                             class: `gene-dot ${kind_of(origin)}${inheritance.changed[gene] ? " mutated" : ""}`,
                             role: "img",
                             tabindex: cells.length === 0 ? 0 : -1,
                             "data-gene": gene,
                           });
                           cells.push(cell);
                           return cell;
                         })));
  const press = (event: KeyboardEvent): void => {
    const step = event.key === "ArrowRight" || event.key === "ArrowDown" ? 1 :
      event.key === "ArrowLeft" || event.key === "ArrowUp"               ? -1 :
                                                                           0;
    const at = cells.indexOf(event.target as HTMLElement), next = cells[at + step];
    if (step === 0 || at < 0) {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
    if (next) {
      cells[at]!.tabIndex = -1;
      next.tabIndex = 0;
      next.focus();
    }
  };
  return h(
    "div", {class: "other-genes"}, h("p", {}, other_genes_text(inheritance, first, descendant)),
    h("div", {
      class: "gene-blocks",
      role: "group",
      "aria-label": glass_box_texts.other_genes,
      onkeydown: press,
      onmouseover: show,
      onfocusin: show
    },
      ...blocks),
    note);
}
