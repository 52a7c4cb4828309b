// PlotNote: the numbers at the cursor of a plot, in a box next to the plot.
import {fitness_text, shown_number, significant} from "../texts/numbers";
import {plot_texts} from "../texts/plot";
import {h} from "../widgets/dom";

import {column} from "./plot_frame";

import type {Frame} from "./plot_frame";
import {nearest, note_place} from "./plot_layout";
import type {PlotContent, PlotView, Series} from "./plot_content";
import {swatch_of} from "./plot_legend";
import {mark_pixels} from "./plot_painter";

const marks_max = 8;

interface Line {
  text: string;
  series?: Series; // whose number the line shows
  is_mark?: boolean;
}

export class PlotNote {
  readonly element = h("div", {class: "plot-note", role: "status", "aria-live": "polite", hidden: true});
  #shown = ""; // the numbers in the element

  show(view: PlotView, frame: Frame, x: number): void {
    const lines = lines_at(view, frame, x);
    const described = JSON.stringify(lines.map((line) => [line.text, line.series?.colour]));
    if (described !== this.#shown) {
      this.#shown = described;
      this.element.replaceChildren(...lines.map(
        ({text, series, is_mark}) =>
          h("div", {class: is_mark === true ? "plot-note-mark" : null}, series !== undefined && swatch_of(series),
            h("span", {}, text))));
    }
    this.element.hidden = false;
  }

  hide(): void {
    this.element.hidden = true;
    this.#shown = "";
  }

  /** Places the note next to the plot, centred at this height of the window. */
  place(plot: Element, y: number): void {
    const window = {width: document.documentElement.clientWidth, height: innerHeight};
    const {left, top} = note_place(plot.getBoundingClientRect(), this.element.getBoundingClientRect(), y, window);
    this.element.style.left = `${Math.round(left)}px`;
    this.element.style.top = `${Math.round(top)}px`;
  }
}

function lines_at({content, visible}: PlotView, frame: Frame, x: number): Line[] {
  const lines: Line[] =
    [{text: `${content.x_label} ${content.counted_x === true ? shown_number(x) : significant(x)}`.trim()}];
  for (const series of visible) {
    const index = index_at(series, x);
    if (index !== null && series.name !== "") {
      lines.push({text: plot_texts.value(series.name, value_text(content, series, index)), series});
    }
  }
  const at = column(frame, x);
  const is_here = (of: number): boolean =>
    of >= frame.x.min && of <= frame.x.max && Math.abs(column(frame, of) - at) <= mark_pixels;
  const marks =
    (content.marks ?? [])
      .flatMap(
        ({marks, name}) => marks.filter((mark) => is_here(mark.x))
                             .map((mark) => (name === "" ? mark.text : plot_texts.mark_of(mark.text, name))));
  lines.push(...marks.slice(0, marks_max).map((text) => ({text, is_mark: true})));
  if (marks.length > marks_max) {
    lines.push({text: plot_texts.more(marks.length - marks_max)});
  }
  if (content.note_end !== undefined) {
    lines.push({text: content.note_end});
  }
  return lines;
}

/** Returns the index of the number of a series at exactly this x; null if it has none. */
export function index_at(series: Series, x: number): number|null {
  const index = nearest(series.x, x);
  return index >= 0 && series.x[index] === x && Number.isFinite(series.y[index]) ? index : null;
}

function value_text(content: PlotContent, series: Series, index: number): string {
  const text = (number: number) => (series.whole === true ? shown_number(number) : fitness_text(number));
  const y = series.y[index]!;
  if (series.kind === "band" && series.low !== undefined) {
    return plot_texts.band(text(series.low[index]!), text(y));
  }
  return series.raw === undefined ?
    text(y) :
    plot_texts.smoothed(text(series.raw[index]!), content.smoothed ?? plot_texts.mean, fitness_text(y));
}
