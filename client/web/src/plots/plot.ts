// Plot: draws lines, bands, stacks and bars over axes on a canvas. The user can zoom and read numbers with mouse, fingers and keyboard.
//
// Two canvases lie over each other. The lower one is drawn after a change of the data, the size, the theme or the zoom; the upper one
// contains the cursor. Both have one pixel per pixel of the screen. A series with more numbers than pixels is drawn with the least and
// the greatest number of each column of pixels, so 100,000 numbers take a few milliseconds. Nothing is animated.
import {h, set_text, svg} from "../widgets/dom";

import {
  compare_dash,
  groups_of,
  joined,
  line_of,
  mark_lines,
  mean_of,
  moved,
  nearest,
  note_place,
  range_of,
  tick_label,
  ticks_in,
  with_room,
  zoomed
} from "./plot_layout";

import type {Box, Mark, Numbers, Range} from "./plot_layout";
import {shown_number, significant, with_separators} from "../texts/numbers";

/** Colours after Okabe and Ito, lighter or darker so that each has a contrast of 3:1 in both themes. app.css defines them as --series-…. */
export type SeriesColour = "orange"|"sky"|"green"|"blue"|"vermilion"|"purple"|"grey";

export interface Series {
  kind: "line" // drawn with `dash`
    |"band" // an area between `low` and `y`
    |"stack" // bars on top of the preceding stacks; a column of pixels shows the mean of its numbers
    |"bars"; // bars that begin at the axis
  name: string; // empty: the legend and the note omit the series
  colour: SeriesColour;
  x: Numbers; // rising
  y: Numbers; // same length; numbers that are not finite are gaps
  low?: Numbers; // the lower edge of a band
  raw?: Numbers; // the numbers of which `y` is the running mean, drawn pale
  newest?: string; // text after the name in the legend
  in_legend?: boolean; // absent: true
  dash?: readonly number[]; // absent: solid
  thickness?: number; // CSS pixels; absent: 1.8
  bar_width?: number; // of stacks and bars, in units of x; absent: 1
  whole?: boolean; // the numbers are counts: the note shows all their digits
}

export interface Marks {
  marks: readonly(Mark&{label?: string})[]; // ordered by x; label: short text beside the line, if there is room
  name: string; // name of the history in the note; empty: there is only one
}

export interface PlotContent {
  title: string; // name of the plot for screen readers and images
  series: Series[]; // each is drawn over the ones after it, but stacks are drawn below all others
  x_label: string;
  y_label: string; // contains the unit
  marks?: Marks[];
  solid?: string; // what solid and dashed lines show in a comparison
  dashed?: string;
  smoothed?: string; // how the note names a running mean: "mean of 10"
  note_end?: string; // the last line of the note
  empty?: string; // shown instead of series if there are none
  from_zero?: boolean; // the y axis begins at 0 unless a number is negative
  counted_x?: boolean; // x contains whole numbers: no ticks between them
}

export interface PlotOptions {
  height: number; // CSS pixels, without the legend
  axes?: boolean; // false: only the lines and marks
  link?: LinkedX; // shared by plots that show the same part of the x axis
  on_click?: (x: number) => void; // the user chose these numbers
}

/** The visible part of the x axis of linked plots. */
export class LinkedX {
  range: Range|null = null; // null: the whole axis
  readonly plots = new Set<Plot>();

  set(range: Range|null): void {
    this.range = range;
    this.plots.forEach((plot) => plot.redraw());
  }
}

const colours: {[name in SeriesColour]: string} = {
  orange: "#b87700",
  sky: "#3a94cf",
  green: "#008a66",
  blue: "#005fa8",
  vermilion: "#cf5200",
  purple: "#b8568f",
  grey: "#6e6e74",
};
const raw_alpha = 0.38, band_alpha = 0.2, dense_alpha = 0.5, faded_alpha = 0.18;
const mark_pixels = 5; // marks nearer than this are drawn as one and read together
const marks_in_note = 8;
const x_units_min = 4; // least visible width of the x axis
const zoom_of_one_notch = 1.25;
const drag_pixels = 5; // a pointer that moves less is a click
const double_click_ms = 300;

/** What is drawn where. */
interface Frame {
  x: Range;
  y: Range;
  area: Box;
  groups: Map<Series, Uint32Array>;
}
interface Theme {
  text: string;
  quiet: string;
  grid: string;
  line: string;
  surface: string;
  mark: string;
  font: string;
  series: {[name in SeriesColour]: string};
}

const all_plots = new Set<Plot>();
function redraw_all(): void {
  all_plots.forEach((plot) => plot.redraw());
}
if (typeof document !== "undefined") {
  new MutationObserver(redraw_all)
    .observe(document.documentElement, {attributes: true, attributeFilter: ["data-theme", "class"]});
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", redraw_all);
}

export class Plot {
  readonly element: HTMLElement;
  readonly #legend = h("div", {class: "plot-legend"});
  readonly #base = h("canvas", {"aria-hidden": "true"});
  readonly #upper = h("canvas", {"aria-hidden": "true"});
  readonly #area = h("div", {class: "plot-area", tabindex: 0, role: "application", "aria-roledescription": "plot"});
  readonly #note = h("div", {class: "plot-note", role: "status", "aria-live": "polite", hidden: true});
  readonly #link: LinkedX;
  readonly #observer: ResizeObserver;
  #content: PlotContent = {title: "", series: [], x_label: "", y_label: ""};
  #frame: Frame|null = null;
  #width = 0; // CSS pixels
  #height = 0;
  #legend_of = ""; // the texts and styles in the legend
  #hidden = new Set<string>(); // names of series that the user has switched off
  #highlighted = ""; // name of the series whose entry in the legend is pointed at
  #cursor: number|null = null; // x
  #cursor_y = 0; // height of the pointer in the window
  #note_of = ""; // the numbers in the note
  #request = 0; // of the next animation frame
  #pointers = new Map < number, {
    x: number;
    y: number
  }
  > ();
  #drag: {from: number; at: number; x: Range; pan: boolean; moved: boolean; cursor: number | null}|null = null;
  #pinch: {x: Range; middle: number; distance: number}|null = null;
  #click_timer = 0;

  readonly #options: PlotOptions;

  constructor(options: PlotOptions) {
    this.#options = options;
    this.#area.style.height = `${options.height}px`;
    this.#area.append(this.#base, this.#upper);
    this.element = h("div", {class: "plot"}, this.#legend, this.#area, this.#note);
    this.#link = options.link ?? new LinkedX();
    this.#link.plots.add(this);
    all_plots.add(this);
    this.#observer = new ResizeObserver((entries) => this.#resize(entries[entries.length - 1] as ResizeObserverEntry));
    try {
      this.#observer.observe(this.#base, {box: "device-pixel-content-box"});
    } catch {
      this.#observer.observe(this.#base);
    }
    this.#listen();
  }

  /** Ends the plot. */
  close(): void {
    this.#observer.disconnect();
    this.#link.plots.delete(this);
    all_plots.delete(this);
    cancelAnimationFrame(this.#request);
    clearTimeout(this.#click_timer);
    this.element.remove();
  }

  set_content(content: PlotContent): void {
    this.#content = content;
    const keys = this.#options.on_click !== undefined ? "Enter chooses a generation; " : "";
    this.#area.setAttribute(
      "aria-label",
      `${content.title}: ${
        content.series.length === 0 ?
          content.empty ?? "no numbers" :
          `left and right arrow keys read the numbers; ${keys}plus and minus zoom; 0 shows everything`}`);
    this.#build_legend();
    this.redraw();
  }

  set_height(pixels: number): void {
    this.#area.style.height = `${pixels}px`;
  }

  /** Shows the whole x axis. */
  fit(): void {
    this.#link.set(null);
  }

  /** Draws with the next animation frame. */
  redraw(): void {
    if (this.#request === 0) {
      this.#request = requestAnimationFrame(() => {
        this.#request = 0;
        this.#draw();
      });
    }
  }

  /** Draws the plot with title and legend as a PNG image of this size in pixels. */
  image(width: number, height: number): Promise<Blob|null> {
    const canvas = h("canvas", {width, height});
    const context = canvas.getContext("2d") as CanvasRenderingContext2D;
    const theme = this.#theme();
    context.fillStyle = theme.surface;
    context.fillRect(0, 0, width, height);
    const margin = 14;
    const top = this.#paint_legend(context, theme, {left: margin, top: margin, right: width - margin, bottom: height});
    this.#paint(context, theme, {left: margin, top, right: width - margin, bottom: height - margin});
    return new Promise((done) => canvas.toBlob(done, "image/png"));
  }

  /** The x range of all series of the linked plots. */
  whole_x(): Range {
    let whole: Range|null = null;
    for (const plot of this.#link.plots) {
      for (const series of plot.#content.series) {
        if (series.x.length > 0) {
          const half = series.kind === "stack" || series.kind === "bars" ? (series.bar_width ?? 1) / 2 : 0;
          whole =
            joined(whole, {min: (series.x[0] as number) - half, max: (series.x[series.x.length - 1] as number) + half});
        }
      }
    }
    if (whole === null) {
      return {min: 0, max: 1};
    }
    return whole.max > whole.min ? whole : {min: whole.min - 0.5, max: whole.max + 0.5};
  }

  #shown_x(): Range {
    return this.#link.range === null ? this.whole_x() : zoomed(this.#link.range, 0, 1, this.whole_x(), x_units_min);
  }

  #visible_series(): Series[] {
    return this.#content.series.filter((series) => !this.#hidden.has(series.name));
  }

  // ---- legend ------------------------------------------------------------------------------------------------------

  #build_legend(): void {
    const {series, solid, dashed} = this.#content;
    const listed = series.filter((one) => one.in_legend !== false && one.name !== "");
    const described = JSON.stringify([
      this.#options.axes, this.#content.title, solid, dashed,
      listed.map((one) => [one.name, one.colour, one.kind, one.dash, one.thickness])
    ]);
    if (described !== this.#legend_of) {
      this.#legend_of = described;
      const names = new Set(series.map((one) => one.name));
      this.#hidden = new Set([...this.#hidden].filter((name) => names.has(name)));
      const entries: HTMLElement[] = [];
      if (this.#options.axes === false) {
        entries.push(h("span", {class: "plot-title"}));
      }
      if (solid !== undefined && dashed !== undefined) {
        entries.push(
          h("span", {class: "plot-entry"}, swatch("grey", "line", [], 2), solid),
          h("span", {class: "plot-entry"}, swatch("grey", "line", compare_dash, 2), dashed));
      }
      entries.push(...listed.map((one) => this.#legend_entry(one)));
      this.#legend.replaceChildren(...entries);
    }
    this.#legend.querySelectorAll(".plot-title").forEach((title) => set_text(title, this.#content.title));
    this.#legend.querySelectorAll<HTMLElement>("[data-series]").forEach((entry) => {
      const one = listed.find((each) => each.name === entry.dataset.series);
      set_text(entry.querySelector(".plot-newest") as Element, one?.newest ?? "");
      entry.setAttribute("aria-pressed", String(!this.#hidden.has(entry.dataset.series as string)));
    });
  }

  #legend_entry(series: Series): HTMLElement {
    const {name} = series;
    const highlight = (which: string) => () => {
      this.#highlighted = which;
      this.redraw();
    };
    return h(
      "button", {
        type: "button",
        class: "plot-entry",
        "data-series": name,
        title: `Shows or hides ${name}`,
        onclick: () => {
          if (!this.#hidden.delete(name)) {
            this.#hidden.add(name);
          }
          this.#build_legend();
          this.redraw();
        },
        onpointerenter: highlight(name),
        onpointerleave: highlight(""),
        onfocus: highlight(name),
        onblur: highlight(""),
      },
      swatch(series.colour, series.kind, series.dash ?? [], series.thickness ?? 1.8), h("span", {}, name),
      h("span", {class: "plot-newest"}));
  }

  /** Paints title and legend of an image. Returns the y below them. */
  #paint_legend(context: CanvasRenderingContext2D, theme: Theme, box: Box): number {
    const letter = 13;
    let x = box.left, y = box.top + letter;
    context.fillStyle = theme.text;
    context.font = `bold ${letter + 2}px ${theme.font}`;
    context.fillText(this.#content.title, x, y);
    context.font = `${letter}px ${theme.font}`;
    y += letter + 10;
    const entries = this.#visible_series()
                      .filter((one) => one.in_legend !== false && one.name !== "")
                      .map((one) => ({
                             name: one.name,
                             colour: theme.series[one.colour],
                             dash: one.dash ?? [],
                             area: one.kind !== "line",
                             alpha: one.kind === "band" ? band_alpha * 1.6 : 1
                           }));
    if (this.#content.solid !== undefined && this.#content.dashed !== undefined) {
      entries.unshift(
        {name: this.#content.solid, colour: theme.quiet, dash: [], area: false, alpha: 1},
        {name: this.#content.dashed, colour: theme.quiet, dash: compare_dash, area: false, alpha: 1});
    }
    for (const entry of entries) {
      const width = context.measureText(entry.name).width + 44;
      if (x > box.left && x + width > box.right) {
        x = box.left;
        y += letter + 5;
      }
      context.strokeStyle = context.fillStyle = entry.colour;
      context.lineWidth = entry.area ? 9 : 2;
      context.setLineDash(entry.dash as number[]);
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

  // ---- drawing -----------------------------------------------------------------------------------------------------

  #resize(entry: ResizeObserverEntry): void {
    const device = entry.devicePixelContentBoxSize?.[0];
    const {width, height} = entry.contentRect;
    this.#width = width;
    this.#height = height;
    const ratio = devicePixelRatio;
    for (const canvas of [this.#base, this.#upper]) {
      canvas.width = device?.inlineSize ?? Math.round(width * ratio);
      canvas.height = device?.blockSize ?? Math.round(height * ratio);
    }
    if (this.#request !== 0) {
      cancelAnimationFrame(this.#request);
      this.#request = 0;
    }
    this.#draw(); // at once, because the canvas is empty now
  }

  #theme(): Theme {
    const style = getComputedStyle(this.element);
    const value = (name: string, otherwise: string) => style.getPropertyValue(name).trim() || otherwise;
    const series = {...colours};
    for (const name of Object.keys(colours) as SeriesColour[]) {
      series[name] = value(`--series-${name}`, colours[name]);
    }
    return {
      text: value("--text", "#1c1c22"),
      quiet: value("--text-2", "#5c5c66"),
      grid: value("--plot-grid", "#e2e2e6"),
      line: value("--line", "#b8b8c2"),
      surface: value("--plot-background", value("--surface", "#fcfcfd")),
      mark: value("--plot-mark", "#4a3a96"),
      font: style.fontFamily || "sans-serif",
      series,
    };
  }

  #scaled(canvas: HTMLCanvasElement): CanvasRenderingContext2D {
    // This option makes the browser draw without the graphics processor: lines of thousands of numbers would block it for seconds where
    // it is emulated.
    const context = canvas.getContext("2d", {willReadFrequently: true}) as CanvasRenderingContext2D;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.scale(canvas.width / this.#width, canvas.height / this.#height);
    return context;
  }

  #draw(): void {
    if (this.#width < 1 || this.#height < 1 || !this.element.isConnected) {
      return;
    }
    this.#frame =
      this.#paint(this.#scaled(this.#base), this.#theme(), {left: 0, top: 0, right: this.#width, bottom: this.#height});
    this.#draw_cursor();
  }

  /** Computes the groups of each series, the y range and the area that remains beside the labels. */
  #lay_out(context: CanvasRenderingContext2D, box: Box): Frame {
    const shown = this.#visible_series();
    const x = this.#shown_x();
    const columns = Math.max(Math.round(box.right - box.left), 1);
    const groups = new Map<Series, Uint32Array>();
    let y: Range|null = null;
    let tops: number[] = [];
    for (const series of shown) {
      const starts = groups_of(series.x, x, columns);
      groups.set(series, starts);
      if (starts.length < 2) {
        continue;
      }
      const begin = starts[0] as number, end = starts[starts.length - 1] as number;
      if (series.kind === "stack") {
        tops = Array.from(
          {length: starts.length - 1},
          (_, i) => (tops[i] ?? 0) + mean_of(series.y, starts[i] as number, starts[i + 1] as number));
        y = joined(y, range_of(tops));
        continue;
      }
      for (const numbers of [series.y, series.raw, series.low]) {
        if (numbers !== undefined) {
          y = joined(y, range_of(numbers, begin, end));
        }
      }
      y = series.kind === "bars" ? joined(y, {min: 0, max: 0}) : y;
    }
    const known: Range = y ?? {min: 0, max: 1};
    const from_zero = this.#content.from_zero === true && known.min >= 0;
    const room = with_room(from_zero ? {min: 0, max: known.max} : known, 0.04);
    if (known.min >= 0) { // no room below 0 for numbers that are never negative
      room.min = from_zero ? 0 : Math.max(room.min, 0);
      room.max = Math.max(room.max, 1e-9);
    }
    if (this.#options.axes === false) {
      return {
        x,
        y: room,
        area: {left: box.left + 1, top: box.top + 1, right: box.right - 1, bottom: box.bottom - 1},
        groups
      };
    }
    const area = {
      left: box.left,
      top: box.top + 18,
      right: Math.max(box.right - 8, box.left + 1),
      bottom: Math.max(box.bottom - 34, box.top + 19)
    };
    const ticks = this.#y_ticks(room, area);
    const widest = Math.max(0, ...ticks.at.map((tick) => context.measureText(tick_label(tick, ticks.step)).width));
    area.left = Math.min(box.left + Math.ceil(widest) + 8, area.right - 1);
    return {x, y: room, area, groups};
  }

  #y_ticks(y: Range, area: Box): {step: number; at: number[]} {
    return ticks_in(y, Math.max(2, Math.floor((area.bottom - area.top) / 24)));
  }

  #paint(context: CanvasRenderingContext2D, theme: Theme, box: Box): Frame {
    context.font = `12px ${theme.font}`;
    context.textBaseline = "alphabetic";
    const frame = this.#lay_out(context, box);
    const {area} = frame;
    const width = area.right - area.left, height = area.bottom - area.top;
    context.fillStyle = theme.surface;
    context.fillRect(area.left, area.top, width, height);
    if (this.#options.axes !== false) {
      this.#paint_axes(context, theme, frame, box);
    }
    context.save();
    context.beginPath();
    context.rect(area.left, area.top, width, height);
    context.clip();
    const shown = this.#visible_series();
    const stacks = shown.filter((series) => series.kind === "stack");
    let bottoms: number[] = [];
    for (const series of stacks) {
      bottoms = this.#paint_stack(context, theme, frame, series, bottoms);
    }
    for (const series of [...shown].reverse()) {
      const faded = this.#highlighted !== "" && this.#highlighted !== series.name;
      context.globalAlpha = faded ? faded_alpha : 1;
      this.#paint_series(context, theme, frame, series);
    }
    context.globalAlpha = 1;
    this.#paint_marks(context, theme, frame);
    context.restore();
    context.strokeStyle = theme.line;
    context.lineWidth = 1;
    context.strokeRect(area.left + 0.5, area.top + 0.5, width - 1, height - 1);
    if (this.#content.series.length === 0 && this.#content.empty !== undefined && this.#options.axes !== false) {
      context.fillStyle = theme.quiet;
      context.textAlign = "center";
      context.fillText(this.#content.empty, (area.left + area.right) / 2, (area.top + area.bottom) / 2);
      context.textAlign = "left";
    }
    return frame;
  }

  #paint_axes(context: CanvasRenderingContext2D, theme: Theme, frame: Frame, box: Box): void {
    const {area} = frame;
    context.lineWidth = 1;
    context.textAlign = "left";
    context.fillStyle = theme.quiet;
    context.fillText(this.#content.y_label, box.left, box.top + 11, box.right - box.left);
    const y_ticks = this.#y_ticks(frame.y, area);
    context.strokeStyle = theme.grid;
    context.beginPath();
    for (const tick of y_ticks.at) {
      const y = Math.round(row(frame, tick)) + 0.5;
      context.moveTo(area.left, y);
      context.lineTo(area.right, y);
    }
    const x_ticks = ticks_in(
      frame.x, Math.max(2, Math.floor((area.right - area.left) / 70)), this.#content.counted_x === true ? 1 : 0);
    for (const tick of x_ticks.at) {
      const x = Math.round(column(frame, tick)) + 0.5;
      context.moveTo(x, area.top);
      context.lineTo(x, area.bottom + 4);
    }
    context.stroke();
    context.fillStyle = theme.text;
    context.textAlign = "right";
    for (const tick of y_ticks.at) {
      context.fillText(tick_label(tick, y_ticks.step), area.left - 5, Math.round(row(frame, tick)) + 4);
    }
    context.textAlign = "center";
    for (const tick of x_ticks.at) {
      const label = tick_label(tick, x_ticks.step);
      const half = context.measureText(label).width / 2;
      context.fillText(label, Math.min(column(frame, tick), box.right - half), area.bottom + 16);
    }
    context.fillStyle = theme.quiet;
    context.fillText(this.#content.x_label, (area.left + area.right) / 2, area.bottom + 30);
    context.textAlign = "left";
  }

  #paint_series(context: CanvasRenderingContext2D, theme: Theme, frame: Frame, series: Series): void {
    const starts = frame.groups.get(series) as Uint32Array;
    const alpha = context.globalAlpha;
    const colour = theme.series[series.colour];
    context.strokeStyle = context.fillStyle = colour;
    if (series.kind === "line") {
      if (series.raw !== undefined) {
        context.globalAlpha = alpha * raw_alpha;
        this.#paint_line(context, frame, series.x, series.raw, starts, 1, []);
        context.globalAlpha = alpha;
      }
      this.#paint_line(context, frame, series.x, series.y, starts, series.thickness ?? 1.8, series.dash ?? []);
    } else if (series.kind === "band" && series.low !== undefined) {
      context.globalAlpha = alpha * band_alpha;
      paint_band(context, frame, series.x, series.low, series.y, starts);
    } else if (series.kind === "bars") {
      for (let i = 0; i + 1 < starts.length; ++i) {
        const begin = starts[i] as number;
        paint_bar(context, frame, series, begin, starts[i + 1] as number, 0, series.y[begin] as number);
      }
    }
  }

  #paint_line(
    context: CanvasRenderingContext2D, frame: Frame, x: Numbers, y: Numbers, starts: Uint32Array, thickness: number,
    dash: readonly number[]): void {
    const dense =
      starts.length > 1 && (starts[starts.length - 1] as number) - (starts[0] as number) > starts.length - 1;
    const points = line_of(x, y, starts);
    context.lineWidth = dense ? 1 : thickness;
    context.lineJoin = "round";
    context.setLineDash(
      dense ? [] :
              dash as number[]); // within a column of pixels a dense line moves up and down: dashes would be invisible
    const alpha = context.globalAlpha;
    context.globalAlpha = dense && dash.length > 0 ? alpha * dense_alpha : alpha;
    context.beginPath();
    for (let i = 0; i < points.length; i += 2) {
      const at_y = points[i + 1] as number;
      if (Number.isNaN(at_y)) {
        continue;
      }
      const begins = i === 0 || Number.isNaN(points[i - 1]),
            ends = i + 2 >= points.length || Number.isNaN(points[i + 3]);
      const at = column(frame, points[i] as number), height = row(frame, at_y);
      if (begins && ends) { // a single number between gaps
        context.fillRect(at - 1.5, height - 1.5, 3, 3);
      } else if (begins) {
        context.moveTo(at, height);
      } else {
        context.lineTo(at, height);
      }
    }
    context.stroke();
    context.setLineDash([]);
    context.globalAlpha = alpha;
  }

  #paint_stack(context: CanvasRenderingContext2D, theme: Theme, frame: Frame, series: Series, bottoms: number[]):
    number[] {
    const starts = frame.groups.get(series) as Uint32Array;
    context.fillStyle = theme.series[series.colour];
    context.globalAlpha = this.#highlighted !== "" && this.#highlighted !== series.name ? faded_alpha : 1;
    const tops: number[] = [];
    for (let i = 0; i + 1 < starts.length; ++i) {
      const begin = starts[i] as number, end = starts[i + 1] as number;
      const from = bottoms[i] ?? 0, to = from + mean_of(series.y, begin, end);
      paint_bar(context, frame, series, begin, end, from, to);
      tops.push(to);
    }
    context.globalAlpha = 1;
    return tops;
  }

  #paint_marks(context: CanvasRenderingContext2D, theme: Theme, frame: Frame): void {
    const {area} = frame;
    const distance = (mark_pixels / Math.max(area.right - area.left, 1)) * (frame.x.max - frame.x.min);
    (this.#content.marks ?? []).forEach(({marks}, index) => {
      const lines = mark_lines(marks, frame.x, distance);
      let labelled_until = area.left;
      context.strokeStyle = context.fillStyle = theme.mark;
      context.lineWidth = 1;
      lines.forEach((at, i) => {
        const x = Math.round(column(frame, at)) + 0.5, half = mark_pixels - 1;
        context.setLineDash([2, 3]);
        context.beginPath();
        context.moveTo(x, area.top + 2 * half);
        context.lineTo(x, area.bottom);
        context.stroke();
        context.setLineDash([]);
        context.beginPath();
        context.moveTo(x - half, area.top + 1);
        context.lineTo(x + half, area.top + 1);
        context.lineTo(x, area.top + 2 * half);
        context.closePath();
        if (index === 0) {
          context.fill();
        } else { // of the compared history
          context.stroke();
        }
        const label = index === 0 ? marks.find((mark) => mark.x === at)?.label : undefined;
        if (label !== undefined && this.#options.axes !== false) {
          context.font = `10px ${theme.font}`;
          const width = context.measureText(label).width + mark_pixels + 3;
          const right = i + 1 < lines.length ? column(frame, lines[i + 1] as number) - mark_pixels : area.right;
          const left =
            Math.max(labelled_until, i > 0 ? column(frame, lines[i - 1] as number) + mark_pixels : area.left);
          if (x + width <= right) {
            context.fillText(label, x + mark_pixels + 2, area.top + 10);
            labelled_until = x + width;
          } else if (x - width >= left) {
            context.fillText(label, x - width, area.top + 10);
          }
        }
      });
    });
  }

  // ---- cursor ------------------------------------------------------------------------------------------------------

  /** Returns the x of the numbers nearest to a column of the canvas; null if there are none. */
  #x_near(pixels: number): number|null {
    const frame = this.#frame;
    if (frame === null) {
      return null;
    }
    const at = value_at(frame, pixels);
    let found: number|null = null;
    for (const series of this.#content.series) {
      const index = nearest(series.x, at);
      if (index >= 0) {
        const x = series.x[index] as number;
        found = found === null || Math.abs(x - at) < Math.abs(found - at) ? x : found;
      }
    }
    return found !== null && found >= frame.x.min && found <= frame.x.max ? found : null;
  }

  #set_cursor(x: number|null): void {
    if (x !== this.#cursor) {
      this.#cursor = x;
      this.#draw_cursor();
    } else if (x !== null) {
      this.#place_note();
    }
  }

  #draw_cursor(): void {
    const frame = this.#frame;
    if (frame === null || this.#width < 1) {
      return;
    }
    const context = this.#scaled(this.#upper);
    const theme = this.#theme();
    const {area} = frame;
    if (this.#drag !== null && this.#drag.moved && !this.#drag.pan) {
      context.fillStyle = theme.quiet;
      context.globalAlpha = 0.25;
      context.fillRect(
        Math.min(this.#drag.from, this.#drag.at), area.top, Math.abs(this.#drag.at - this.#drag.from),
        area.bottom - area.top);
      context.globalAlpha = 1;
    }
    const x = this.#cursor;
    if (x === null || x < frame.x.min || x > frame.x.max) {
      this.#note.hidden = true;
      this.#note_of = "";
      return;
    }
    const at = column(frame, x);
    context.strokeStyle = theme.quiet;
    context.lineWidth = 1;
    context.beginPath();
    context.moveTo(Math.round(at) + 0.5, area.top);
    context.lineTo(Math.round(at) + 0.5, area.bottom);
    context.stroke();
    const lines: {text: string; series?: Series; mark?: boolean}[] = [
      {text: `${this.#content.x_label} ${this.#content.counted_x === true ? shown_number(x) : significant(x)}`.trim()}
    ];
    for (const series of this.#visible_series()) {
      const index = nearest(series.x, x);
      if (index < 0 || series.x[index] !== x || series.name === "" || !Number.isFinite(series.y[index])) {
        continue;
      }
      if (series.kind === "line") {
        context.fillStyle = theme.series[series.colour];
        context.beginPath();
        context.arc(at, row(frame, series.y[index] as number), 3, 0, 2 * Math.PI);
        context.fill();
      }
      lines.push({text: `${series.name}: ${this.#value_text(series, index)}`, series});
    }
    const marks = (this.#content.marks ?? [])
                    .flatMap(
                      (group) => group.marks
                                   .filter(
                                     (mark) => mark.x >= frame.x.min && mark.x <= frame.x.max &&
                                       Math.abs(column(frame, mark.x) - at) <= mark_pixels)
                                   .map((mark) => mark.text + (group.name === "" ? "" : ` (${group.name})`)));
    lines.push(...marks.slice(0, marks_in_note).map((text) => ({text, mark: true})));
    if (marks.length > marks_in_note) {
      lines.push({text: `and ${with_separators(marks.length - marks_in_note)} more`});
    }
    if (this.#content.note_end !== undefined) {
      lines.push({text: this.#content.note_end});
    }
    const described = JSON.stringify(lines.map((line) => [line.text, line.series?.colour]));
    if (described !== this.#note_of) {
      this.#note_of = described;
      this.#note.replaceChildren(...lines.map(
        (line) =>
          h("div", {class: line.mark === true ? "plot-note-mark" : null},
            line.series !== undefined &&
              swatch(line.series.colour, line.series.kind, line.series.dash ?? [], line.series.thickness ?? 1.8),
            h("span", {}, line.text))));
    }
    this.#note.hidden = false;
    this.#place_note();
  }

  #value_text(series: Series, index: number): string {
    const text = (number: number) => (series.whole === true ? shown_number(number) : significant(number));
    if (series.kind === "band" && series.low !== undefined) {
      return `${text(series.low[index] as number)} to ${text(series.y[index] as number)}`;
    }
    const y = series.y[index] as number;
    return series.raw === undefined ?
      text(y) :
      `${text(series.raw[index] as number)} (${this.#content.smoothed ?? "mean"}: ${significant(y)})`;
  }

  #place_note(): void {
    const box = this.element.getBoundingClientRect();
    const size = this.#note.getBoundingClientRect();
    const place =
      note_place(box, size, this.#cursor_y, {width: document.documentElement.clientWidth, height: innerHeight});
    this.#note.style.left = `${Math.round(place.left)}px`;
    this.#note.style.top = `${Math.round(place.top)}px`;
  }

  // ---- input -------------------------------------------------------------------------------------------------------

  #listen(): void {
    const area = this.#area;
    area.addEventListener("pointerdown", (event) => this.#pointer_down(event));
    area.addEventListener("pointermove", (event) => this.#pointer_move(event));
    area.addEventListener("pointerup", (event) => this.#pointer_up(event));
    area.addEventListener("pointercancel", (event) => this.#forget_pointer(event));
    area.addEventListener("pointerleave", (event) => {
      if (event.pointerType === "mouse" && this.#drag === null) {
        this.#set_cursor(null);
      }
    });
    area.addEventListener("dblclick", () => {
      clearTimeout(this.#click_timer);
      this.#link.set(null);
    });
    area.addEventListener("wheel", (event) => this.#wheel(event), {passive: false});
    area.addEventListener("keydown", (event) => this.#key_down(event));
    area.addEventListener("blur", () => this.#set_cursor(null));
  }

  #place_of(event: MouseEvent): {x: number; y: number} {
    const box = this.#area.getBoundingClientRect();
    this.#cursor_y = event.clientY;
    return {x: event.clientX - box.left, y: event.clientY - box.top};
  }

  #pointer_down(event: PointerEvent): void {
    const frame = this.#frame;
    if (frame === null || event.button !== 0) {
      return;
    }
    const place = this.#place_of(event);
    this.#pointers.set(event.pointerId, place);
    this.#area.setPointerCapture(event.pointerId);
    const [first, second] = [...this.#pointers.values()];
    if (first !== undefined && second !== undefined) {
      this.#drag = null;
      this.#pinch = this.#options.axes === false ?
        null :
        {x: frame.x, middle: (first.x + second.x) / 2, distance: Math.max(Math.abs(first.x - second.x), 10)};
      return;
    }
    this.#drag = {
      from: place.x,
      at: place.x,
      x: frame.x,
      pan: event.shiftKey || this.#options.axes === false,
      moved: false,
      cursor: this.#cursor
    };
    if (event.pointerType !== "mouse") {
      this.#set_cursor(this.#x_near(place.x));
    }
  }

  #pointer_move(event: PointerEvent): void {
    const frame = this.#frame;
    if (frame === null) {
      return;
    }
    const place = this.#place_of(event);
    if (this.#pointers.has(event.pointerId)) {
      this.#pointers.set(event.pointerId, place);
    }
    const width = Math.max(frame.area.right - frame.area.left, 1);
    if (this.#pinch !== null) {
      const [first, second] = [...this.#pointers.values()];
      if (first !== undefined && second !== undefined) {
        const {x, middle, distance} = this.#pinch;
        const share = Math.min(Math.max((middle - frame.area.left) / width, 0), 1);
        const next =
          zoomed(x, share, Math.max(Math.abs(first.x - second.x), 10) / distance, this.whole_x(), x_units_min);
        const by = ((middle - (first.x + second.x) / 2) / width) * (next.max - next.min);
        this.#show_x(moved(next, by, this.whole_x()));
      }
      return;
    }
    if (this.#drag !== null) {
      this.#drag.at = Math.min(Math.max(place.x, frame.area.left), frame.area.right);
      this.#drag.moved = this.#drag.moved || Math.abs(place.x - this.#drag.from) > drag_pixels;
      if (this.#drag.moved && event.pointerType === "mouse" && this.#options.axes !== false) {
        if (this.#drag.pan) {
          const by = ((this.#drag.from - place.x) / width) * (this.#drag.x.max - this.#drag.x.min);
          this.#show_x(moved(this.#drag.x, by, this.whole_x()));
        }
        this.#cursor = this.#x_near(place.x);
        this.#draw_cursor();
        return;
      }
    }
    this.#set_cursor(this.#x_near(place.x));
  }

  #pointer_up(event: PointerEvent): void {
    const drag = this.#drag, frame = this.#frame;
    const was_pinch = this.#pinch !== null;
    this.#forget_pointer(event);
    if (drag === null || frame === null || was_pinch) {
      return;
    }
    if (!drag.moved) {
      this.#click(event, drag.cursor);
    } else if (event.pointerType === "mouse" && !drag.pan && this.#options.axes !== false) {
      const a = value_at(frame, drag.from), b = value_at(frame, drag.at);
      this.#show_x(zoomed({min: Math.min(a, b), max: Math.max(a, b)}, 0.5, 1, this.whole_x(), x_units_min));
    }
    this.#draw_cursor();
  }

  #forget_pointer(event: PointerEvent): void {
    this.#pointers.delete(event.pointerId);
    if (this.#pointers.size < 2) {
      this.#pinch = null;
    }
    this.#drag = null;
  }

  /** before: the cursor before the pointer went down. A finger reads the numbers first; a second tap on them chooses them. */
  #click(event: PointerEvent, before: number|null): void {
    const x = this.#x_near(this.#place_of(event).x);
    const choose = this.#options.on_click;
    if (x === null || choose === undefined || (event.pointerType !== "mouse" && before !== x)) {
      return;
    }
    clearTimeout(this.#click_timer);
    if (this.#link.range === null) {
      choose(x);
    } else { // a double click shows the whole axis
      this.#click_timer = window.setTimeout(() => choose(x), double_click_ms);
    }
  }

  #show_x(range: Range): void {
    const whole = this.whole_x();
    this.#link.set(range.min <= whole.min && range.max >= whole.max ? null : range);
  }

  #zoom(share: number, factor: number): void {
    if (this.#frame !== null) {
      this.#show_x(zoomed(this.#frame.x, share, factor, this.whole_x(), x_units_min));
    }
  }

  #wheel(event: WheelEvent): void {
    const frame = this.#frame;
    const zooms_out = event.deltaY > 0;
    if (
      frame === null || this.#options.axes === false || event.deltaY === 0 ||
      (zooms_out && this.#link.range === null)) {
      return; // the page scrolls
    }
    event.preventDefault();
    const share = (this.#place_of(event).x - frame.area.left) / Math.max(frame.area.right - frame.area.left, 1);
    const notches = Math.min(Math.abs(event.deltaY) / (event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 100 : 3), 3);
    this.#zoom(Math.min(Math.max(share, 0), 1), Math.pow(zoom_of_one_notch, zooms_out ? -notches : notches));
  }

  #key_down(event: KeyboardEvent): void {
    const frame = this.#frame;
    if (
      frame === null || event.ctrlKey || event.altKey || event.metaKey ||
      !this.#key(event.key, event.shiftKey, frame)) {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  }

  /** Returns whether the plot uses this key. */
  #key(key: string, fast: boolean, frame: Frame): boolean {
    const share = this.#cursor === null ? 0.5 : (this.#cursor - frame.x.min) / (frame.x.max - frame.x.min);
    switch (key) {
      case "ArrowLeft":
        return this.#step(fast ? -10 : -1, frame);
      case "ArrowRight":
        return this.#step(fast ? 10 : 1, frame);
      case "Home":
        return this.#step(-Infinity, frame);
      case "End":
        return this.#step(Infinity, frame);
      case "Enter":
        if (this.#cursor !== null && this.#options.on_click !== undefined) {
          this.#options.on_click(this.#cursor);
        }
        return this.#cursor !== null;
      case "Escape": {
        const had_cursor = this.#cursor !== null;
        this.#set_cursor(null);
        return had_cursor;
      }
      case "+":
      case "=":
      case "-":
        if (this.#options.axes !== false) {
          this.#zoom(share, key === "-" ? 1 / zoom_of_one_notch : zoom_of_one_notch);
        }
        return this.#options.axes !== false;
      case "0":
        this.fit();
        return true;
      default:
        return false;
    }
  }

  /** Moves the cursor by this many numbers of the longest series, and the visible part with it. */
  #step(by: number, frame: Frame): boolean {
    const x = this.#content.series.reduce<Numbers>(
      (longest, series) => (series.x.length > longest.length ? series.x : longest), []);
    if (x.length === 0) {
      return false;
    }
    const now = this.#cursor === null ? (by < 0 ? x.length : -1) : nearest(x, this.#cursor);
    const next = x[Math.min(Math.max(now + by, 0), x.length - 1)] as number;
    const box = this.#area.getBoundingClientRect();
    this.#cursor_y = (box.top + box.bottom) / 2;
    this.#cursor = next;
    if (next < frame.x.min || next > frame.x.max) {
      this.#show_x(moved(frame.x, next < frame.x.min ? next - frame.x.min : next - frame.x.max, this.whole_x()));
    } else {
      this.#draw_cursor();
    }
    return true;
  }
}

/** A sample of the style of a series. */
function swatch(colour: SeriesColour, kind: Series["kind"], dash: readonly number[], thickness: number): SVGElement {
  const sample = svg("svg", {class: "plot-swatch", width: 18, height: 10, "aria-hidden": "true"});
  sample.style.color = `var(--series-${colour}, ${colours[colour]})`;
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
        {x: 0, y: 0, width: 18, height: 10, fill: "currentColor", opacity: kind === "band" ? band_alpha * 1.6 : 1}));
  return sample;
}

function column(frame: Frame, x: number): number {
  const share = (x - frame.x.min) / (frame.x.max - frame.x.min);
  return frame.area.left + Math.min(Math.max(share, -1), 2) * (frame.area.right - frame.area.left);
}

function row(frame: Frame, y: number): number {
  const share = (y - frame.y.min) / (frame.y.max - frame.y.min);
  return frame.area.bottom - Math.min(Math.max(share, -1), 2) * (frame.area.bottom - frame.area.top);
}

function value_at(frame: Frame, pixels: number): number {
  return frame.x.min +
    ((pixels - frame.area.left) / Math.max(frame.area.right - frame.area.left, 1)) * (frame.x.max - frame.x.min);
}

/** Paints the area between the least `low` and the greatest `high` of each group. A group without a finite number interrupts the area. */
function paint_band(
  context: CanvasRenderingContext2D, frame: Frame, x: Numbers, low: Numbers, high: Numbers, starts: Uint32Array): void {
  let points: {x: number; low: number; high: number}[] = [];
  const finish = () => {
    context.beginPath();
    points.forEach((point) => context.lineTo(point.x, point.high));
    points.reverse().forEach((point) => context.lineTo(point.x, point.low));
    context.fill();
    points = [];
  };
  for (let i = 0; i + 1 < starts.length; ++i) {
    const begin = starts[i] as number, end = starts[i + 1] as number;
    const lows = range_of(low, begin, end), highs = range_of(high, begin, end);
    if (lows === null || highs === null) {
      finish();
    } else {
      points.push({x: column(frame, x[begin] as number), low: row(frame, lows.min), high: row(frame, highs.max)});
    }
  }
  finish();
}

/** Paints a bar from y `from` to `to` for the numbers with indices begin to end - 1. */
function paint_bar(
  context: CanvasRenderingContext2D, frame: Frame, series: Series, begin: number, end: number, from: number,
  to: number): void {
  const half = (series.bar_width ?? 1) / 2;
  let left = column(frame, (series.x[begin] as number) - half),
      right = column(frame, (series.x[end - 1] as number) + half);
  if (right - left > 6) {
    left += 0.5; // a gap between wide bars
    right -= 0.5;
  } else { // narrow bars begin and end at whole pixels, so that no stripes appear between them
    left = Math.round(left);
    right = Math.max(Math.round(right), left + 1);
  }
  const top = row(frame, to);
  context.fillRect(left, top, right - left, row(frame, from) - top);
}
