// lesson_plot: axes on which a curve is drawn, and a line of numbers, as SVG: a prediction and what was observed.
import {type CurveQuestion, type Point} from "../lesson/lesson_file";
import {nice_step, shown_number} from "../texts/numbers";
import {lesson_texts as texts} from "../texts/lesson";
import {h, svg} from "../widgets/dom";
import {svg_label, svg_line} from "../widgets/svg";

const width = 360, height = 230, left = 50, right = 348, top = 10, bottom = 190;

export type Kind = "predicted"|"observed"|"theory";

/** The multiples of a round number between two numbers, at most about `most`. */
function ticks(min: number, max: number, most: number): number[] {
  const step = nice_step((max - min) / most), first = Math.ceil(min / step - 1e-9);
  return Array.from(
    {length: Math.floor(max / step + 1e-9) - first + 1}, (_, i) => Number(((first + i) * step).toPrecision(12)));
}

/** Axes and the curves on them. */
export class CurvePlot {
  readonly element: SVGSVGElement;
  readonly #question: CurveQuestion;
  readonly #curves = svg("g", {});

  constructor(question: CurveQuestion, label: string) {
    const {x, y} = question;
    this.#question = question;
    this.element =
      svg("svg", {class: "lesson-plot", viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": label});
    for (const at of ticks(x.min, x.max, 8)) {
      this.element.append(
        svg_line("lesson-grid", [this.#x(at), top, this.#x(at), bottom]),
        svg_label("lesson-tick", [this.#x(at), bottom + 15], shown_number(at), {"text-anchor": "middle"}));
    }
    for (const at of ticks(y.min, y.max, 5)) {
      this.element.append(
        svg_line("lesson-grid", [left, this.#y(at), right, this.#y(at)]),
        svg_label("lesson-tick", [left - 5, this.#y(at) + 4], shown_number(at), {"text-anchor": "end"}));
    }
    const middle = (top + bottom) / 2;
    this.element.append(
      svg_line("lesson-axis", [left, bottom, right, bottom]), svg_line("lesson-axis", [left, top, left, bottom]),
      svg_label("lesson-label", [(left + right) / 2, height - 6], x.label, {"text-anchor": "middle"}),
      svg_label(
        "lesson-label", [11, middle], y.label, {"text-anchor": "middle", transform: `rotate(-90 11 ${middle})`}),
      this.#curves);
  }

  /** Shows these curves, each with its sign. */
  show(curves: readonly {
    kind: Kind;
    points: readonly Point[]
  }[]): void {
    this.#curves.replaceChildren(...curves.filter(({points}) => points.length > 0).flatMap(({kind, points}) => {
      const places = points.map(([x, y]): Point => [this.#x(x), this.#y(y)]);
      const d = places.map(([x, y], i) => `${i === 0 ? "M" : "L"}${x.toFixed(1)} ${y.toFixed(1)}`).join("");
      const marks = kind === "observed" || points.length === 1 ? places.map((place) => mark(kind, place)) : [];
      return [svg("path", {class: `lesson-curve lesson-${kind}`, d}), ...marks];
    }));
  }

  /** The point of the plot at a point of the page. */
  at(client_x: number, client_y: number): Point {
    const box = this.element.getBoundingClientRect(), {x, y} = this.#question;
    const share_x = ((client_x - box.left) / box.width * width - left) / (right - left);
    const share_y = (bottom - (client_y - box.top) / box.height * height) / (bottom - top);
    return [x.min + share_x * (x.max - x.min), y.min + share_y * (y.max - y.min)];
  }

  #x(value: number): number {
    const {min, max} = this.#question.x;
    return left + (value - min) / (max - min) * (right - left);
  }

  #y(value: number): number {
    const {min, max} = this.#question.y;
    return bottom - Math.min(Math.max((value - min) / (max - min), -0.03), 1.03) * (bottom - top);
  }
}

/** The sign of a kind: they differ in shape, too. */
function mark(kind: Kind, [x, y]: Point): SVGElement {
  const d = kind === "observed" ? `M${x - 4} ${y}a4 4 0 1 0 8 0a4 4 0 1 0 -8 0` :
    kind === "predicted" ? `M${x} ${y - 6}L${x + 6} ${y}L${x} ${y + 6}L${x - 6} ${y}Z` :
                           `M${x - 5} ${y - 5}L${x + 5} ${y + 5}M${x - 5} ${y + 5}L${x + 5} ${y - 5}`;
  return svg("path", {class: `lesson-mark lesson-${kind}`, d});
}

/** The signs of the kinds with their words. */
export function legend(kinds: readonly Kind[]): HTMLElement {
  const words = {predicted: texts.predicted, observed: texts.observed, theory: texts.theory};
  return h("p", {class: "lesson-legend"}, ...kinds.map((kind) => {
    const sign = svg("svg", {viewBox: "0 0 16 16", width: 16, height: 16, "aria-hidden": "true"}, mark(kind, [8, 8]));
    return h("span", {}, sign, words[kind]);
  }));
}

/** Shows numbers on a line.
 *
 *  range  what the line shows at least
 *  error  the uncertainty of the theory */
export function number_line(range: {min: number; max: number}, numbers: readonly {
  kind: Kind;
  value: number;
  error?: number
}[], label: string): SVGSVGElement {
  const ends = numbers.flatMap(({value, error = 0}) => [value - error, value + error]);
  const min = Math.min(range.min, ...ends), max = Math.max(range.max, ...ends), margin = 16, y = 34;
  const place = (value: number): number => margin + (value - min) / (max - min || 1) * (width - 2 * margin);
  return svg(
    "svg", {class: "lesson-plot", viewBox: `0 0 ${width} 62`, role: "img", "aria-label": label},
    svg_line("lesson-axis", [margin, y, width - margin, y]),
    ...ticks(min, max, 8)
      .flatMap(
        (at) =>
          [svg_line("lesson-axis", [place(at), y, place(at), y + 5]),
           svg_label("lesson-tick", [place(at), y + 20], shown_number(at), {"text-anchor": "middle"})]),
    ...numbers.flatMap(
      ({kind, value, error = 0}) =>
        [...(error > 0 ? [svg_line("lesson-error", [place(value - error), y, place(value + error), y])] : []),
         mark(
           kind,
           [place(value),
            kind === "observed"    ? y :
              kind === "predicted" ? y - 14 :
                                     y])]));
}
