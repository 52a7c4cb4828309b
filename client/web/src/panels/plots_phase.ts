// PhasePlot: the predators of a colony over its prey, a point for each generation, joined by a line in their order.
import type {HistoryTable, Island} from "../plots/history_table";
import {range_of, tick_label, ticks_in, with_room} from "../plots/plot_layout";
import type {Numbers} from "../plots/plot_layout";
import {figure_texts} from "../texts/plots_panel";
import {h, set_text, svg} from "../widgets/dom";
import {svg_label, svg_line} from "../widgets/svg";
import type {Range} from "../widgets/visible_range";

const texts = figure_texts.phase;
const width = 368, height = 290, left = 46, right = 360, top = 22, bottom = 248;
const shown_max = 500; // generations
const parts = 5; // of the line, each paler than the one after it

export class PhasePlot {
  readonly #svg =
    svg("svg", {class: "phase-plot", viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": texts.title});
  readonly #note = h("p", {class: "hint"});
  readonly element = h("div", {}, this.#svg, this.#note);

  /** births: generations are intervals. */
  update(table: HistoryTable, island: Island, births: boolean): void {
    const generation = table.column(island, "generation").slice(-shown_max);
    const of = (column: "colony:count_mean"|"predators:count_mean"): Numbers =>
      table.column(island, column).slice(-shown_max);
    const prey = of("colony:count_mean"), predators = of("predators:count_mean");
    const x = axis(prey), y = axis(predators), last = generation.length - 1;
    const x_of = (count: number): number => left + (count - x.min) / (x.max - x.min) * (right - left);
    const y_of = (count: number): number => bottom - (count - y.min) / (y.max - y.min) * (bottom - top);
    this.#svg.replaceChildren(...axes(x, y, x_of, y_of));
    if (last < 0) {
      set_text(this.#note, "");
      return;
    }
    const places = generation.map((_, i) => `${x_of(prey[i]!).toFixed(1)},${y_of(predators[i]!).toFixed(1)}`);
    for (let part = 0; part < parts; ++part) {
      const begin = Math.floor(part * last / parts), end = Math.floor((part + 1) * last / parts);
      this.#svg.append(svg("polyline", {
        points: places.slice(begin, end + 1).join(" "),
        fill: "none",
        stroke: "var(--series-orange)",
        "stroke-width": 1.5,
        "stroke-opacity": 0.25 + 0.75 * part / (parts - 1)
      }));
    }
    this.#svg.append(svg("circle", {
      cx: x_of(prey[last]!),
      cy: y_of(predators[last]!),
      r: 4.5,
      fill: "var(--series-orange)",
      stroke: "currentColor"
    }));
    set_text(this.#note, texts.newest(generation[last]!, prey[last]!, predators[last]!, births));
  }
}

/** An axis from 0, or from near the least number if all are far from 0. */
function axis(numbers: Numbers): Range {
  const range = with_room(range_of(numbers) ?? {min: 0, max: 1}, 0.05);
  return {min: range.min < range.max / 2 ? 0 : range.min, max: Math.max(range.max, 1)};
}

function axes(x: Range, y: Range, x_of: (count: number) => number, y_of: (count: number) => number): SVGElement[] {
  const of_x = ticks_in(x, 6), of_y = ticks_in(y, 6), grid = {stroke: "var(--line)"};
  const text = {fill: "currentColor", "font-size": 12};
  return [
    ...of_x.at.flatMap((tick) => [
      svg_line("", [x_of(tick), top, x_of(tick), bottom], grid),
      svg_label("", [x_of(tick), bottom + 16], tick_label(tick, of_x.step), {...text, "text-anchor": "middle"})
    ]),
    ...of_y.at.flatMap((tick) => [
      svg_line("", [left, y_of(tick), right, y_of(tick)], grid),
      svg_label("", [left - 5, y_of(tick) + 4], tick_label(tick, of_y.step), {...text, "text-anchor": "end"})
    ]),
    svg_label("", [(left + right) / 2, height - 8], texts.prey, {...text, "text-anchor": "middle"}),
    svg_label("", [4, 14], texts.predators, text),
  ];
}
