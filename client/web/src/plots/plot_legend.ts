// PlotLegend: the names of the series above a plot. Each is a button that shows or hides its series.
import {plot_texts} from "../texts/plot";
import {h, set_text, svg} from "../widgets/dom";

import {compare_dash} from "./plot_layout";

import type {Box} from "./plot_layout";
import {listed_series, thickness_default} from "./plot_content";
import type {PlotContent, PlotView, Series, SeriesColour} from "./plot_content";
import {band_sample_alpha} from "./plot_theme";
import type {PlotTheme} from "./plot_theme";

export class PlotLegend {
  readonly element = h("div", {class: "plot-legend"});
  readonly #with_title: boolean;
  readonly #on_change: () => void;
  #content: PlotContent = {title: "", series: [], x_label: "", y_label: ""};
  #built = ""; // the texts and styles in the element
  #hidden = new Set<string>(); // names of series that the user has switched off
  #highlighted = "";

  /** on_change: the user has switched a series on or off, or points at its name. */
  constructor(with_title: boolean, on_change: () => void) {
    this.#with_title = with_title;
    this.#on_change = on_change;
  }

  /** The name of the series that the user points at; empty: none. */
  get highlighted(): string {
    return this.#highlighted;
  }

  shows(series: Series): boolean {
    return !this.#hidden.has(series.name);
  }

  update(content: PlotContent): void {
    this.#content = content;
    const {series, solid, dashed, title} = content;
    const listed = listed_series(series);
    const described = JSON.stringify(
      [title, solid, dashed, listed.map((one) => [one.name, one.colour, one.kind, one.dash, one.thickness])]);
    if (described !== this.#built) {
      this.#built = described;
      this.#build(listed);
    }
    this.element.querySelectorAll(".plot-title").forEach((element) => set_text(element, title));
    this.element.querySelectorAll<HTMLElement>("[data-series]").forEach((entry) => {
      const one = listed.find((each) => each.name === entry.dataset.series);
      set_text(entry.querySelector(".plot-newest")!, one?.newest ?? "");
      entry.setAttribute("aria-pressed", String(!this.#hidden.has(entry.dataset.series!)));
    });
  }

  #build(listed: readonly Series[]): void {
    const {series, solid, dashed} = this.#content;
    const names = new Set(series.map((one) => one.name));
    this.#hidden = new Set([...this.#hidden].filter((name) => names.has(name)));
    const entries: HTMLElement[] = [];
    if (this.#with_title) {
      entries.push(h("span", {class: "plot-title"}));
    }
    if (solid !== undefined && dashed !== undefined) {
      entries.push(
        h("span", {class: "plot-entry"}, swatch("grey", "line", [], 2), solid),
        h("span", {class: "plot-entry"}, swatch("grey", "line", compare_dash, 2), dashed));
    }
    this.element.replaceChildren(...entries, ...listed.map((one) => this.#entry(one)));
  }

  #entry(series: Series): HTMLElement {
    const {name} = series;
    const highlight = (which: string) => () => {
      this.#highlighted = which;
      this.#on_change();
    };
    const toggle = () => {
      if (!this.#hidden.delete(name)) {
        this.#hidden.add(name);
      }
      this.update(this.#content);
      this.#on_change();
    };
    return h(
      "button", {
        type: "button",
        class: "plot-entry",
        "data-series": name,
        title: plot_texts.shows_or_hides(name),
        onclick: toggle,
        onpointerenter: highlight(name),
        onpointerleave: highlight(""),
        onfocus: highlight(name),
        onblur: highlight(""),
      },
      swatch_of(series), h("span", {}, name), h("span", {class: "plot-newest"}));
  }
}

/** A sample of the style of a series. */
export function swatch_of(series: Series): SVGElement {
  return swatch(series.colour, series.kind, series.dash ?? [], series.thickness ?? thickness_default);
}

function swatch(colour: SeriesColour, kind: Series["kind"], dash: readonly number[], thickness: number): SVGElement {
  const sample = svg("svg", {class: "plot-swatch", width: 18, height: 10, "aria-hidden": "true"});
  sample.style.color = `var(--series-${colour})`;
  sample.append(
    kind === "line" ?
      svg("line", {
        x1: 0,
        y1: 5,
        x2: 18,
        y2: 5,
        stroke: "currentColor",
        "stroke-width": Math.max(thickness, 1.4),
        "stroke-dasharray": dash.join(" ") || null
      }) :
      svg(
        "rect",
        {x: 0, y: 0, width: 18, height: 10, fill: "currentColor", opacity: kind === "band" ? band_sample_alpha : 1}));
  return sample;
}

/** Paints title and legend of an image. Returns the y below them. */
export function paint_legend(
  context: CanvasRenderingContext2D, theme: PlotTheme, {content, visible}: PlotView, box: Box): number {
  const letter = 13;
  let x = box.left, y = box.top + letter;
  context.fillStyle = theme.text;
  context.font = `bold ${letter + 2}px ${theme.font}`;
  context.fillText(content.title, x, y);
  context.font = `${letter}px ${theme.font}`;
  y += letter + 10;
  const line = {area: false, alpha: 1};
  const entries = listed_series(visible).map((one) => ({
                                               name: one.name,
                                               colour: theme.series[one.colour],
                                               dash: [...one.dash ?? []],
                                               area: one.kind !== "line",
                                               alpha: one.kind === "band" ? band_sample_alpha : 1
                                             }));
  if (content.solid !== undefined && content.dashed !== undefined) {
    entries.unshift(
      {...line, name: content.solid, colour: theme.quiet, dash: []},
      {...line, name: content.dashed, colour: theme.quiet, dash: [...compare_dash]});
  }
  for (const entry of entries) {
    const width = context.measureText(entry.name).width + 44;
    if (x > box.left && x + width > box.right) {
      x = box.left;
      y += letter + 5;
    }
    context.strokeStyle = context.fillStyle = entry.colour;
    context.lineWidth = entry.area ? 9 : 2;
    context.setLineDash(entry.dash);
    context.beginPath();
    context.moveTo(x, y - letter / 3);
    context.lineTo(x + 20, y - letter / 3);
    context.globalAlpha = entry.alpha;
    context.stroke();
    context.globalAlpha = 1;
    context.setLineDash([]);
    context.fillStyle = theme.text;
    context.fillText(entry.name, x + 26, y);
    x += width;
  }
  return y + 10;
}
