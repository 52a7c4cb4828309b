// Plot: draws lines, bands, stacks and bars over axes on a canvas. The user can zoom and read numbers with mouse,
// fingers and keyboard.
//
// Two canvases lie over each other. The lower one is drawn after a change of the data, the size, the theme or the zoom;
// the upper one contains the cursor. Both have one pixel per pixel of the screen. A series with more numbers than
// pixels is drawn with the least and the greatest number of each column of pixels, so 100,000 numbers take a few
// milliseconds. Nothing is animated.
import {plot_texts} from "../texts/plot";
import {h} from "../widgets/dom";
import type {Frame} from "./plot_frame";
import {LinkedX, x_extent} from "./linked_x";
import type {LinkedPlot} from "./linked_x";
import type {PlotContent, PlotView} from "./plot_content";
import {PlotCursor} from "./plot_cursor";
import {PlotInput} from "./plot_input";
import type {Range} from "../widgets/visible_range";
import {paint_legend, PlotLegend} from "./plot_legend";
import {paint_plot} from "./plot_painter";
import {theme_of} from "./plot_theme";
import {on_theme_change} from "../widgets/theme";

const image_margin = 14; // pixels

export interface PlotOptions {
  height: number; // CSS pixels, without the legend
  axes?: boolean; // false: the axes have only numbers, the legend contains the title, and nothing zooms
  link?: LinkedX; // shared by plots that show the same part of the x axis
  on_click?: (x: number) => void; // the user chose these numbers
}

export class Plot implements LinkedPlot {
  readonly element: HTMLElement;
  readonly #base = h("canvas", {"aria-hidden": "true"});
  readonly #upper = h("canvas", {"aria-hidden": "true"});
  readonly #area =
    h("div", {class: "plot-area", tabindex: 0, role: "application", "aria-roledescription": plot_texts.role},
      this.#base, this.#upper);
  readonly #options: PlotOptions;
  readonly #link: LinkedX;
  readonly #legend: PlotLegend;
  readonly #cursor = new PlotCursor();
  readonly #input: PlotInput;
  readonly #observer: ResizeObserver;
  readonly #end_theme: () => void;
  #content: PlotContent = {title: "", series: [], x_label: "", y_label: ""};
  #frame: Frame|null = null;
  #width = 0; // CSS pixels
  #height = 0;
  #request = 0; // of the next animation frame

  constructor(options: PlotOptions) {
    this.#options = options;
    this.#area.style.minHeight = `${options.height}px`;
    this.#legend = new PlotLegend(options.axes === false, () => this.redraw());
    this.element = h("div", {class: "plot"}, this.#legend.element, this.#area, this.#cursor.note.element);
    this.#link = options.link ?? new LinkedX();
    this.#link.add(this);
    this.#end_theme = on_theme_change(() => this.redraw());
    this.#observer = new ResizeObserver((entries) => this.#resize(entries[entries.length - 1]!));
    try {
      this.#observer.observe(this.#base, {box: "device-pixel-content-box"});
    } catch {
      this.#observer.observe(this.#base);
    }
    this.#input = new PlotInput({
      area: this.#area,
      cursor: this.#cursor,
      link: this.#link,
      frame: () => this.#frame,
      view: () => this.#view(),
      draw_cursor: () => this.#draw_cursor(),
      place_note: () => this.#place_note(),
      ...(options.on_click === undefined ? {} : {choose: options.on_click}),
    });
  }

  /** Ends the plot. */
  close(): void {
    this.#observer.disconnect();
    this.#link.remove(this);
    this.#end_theme();
    this.#input.close();
    cancelAnimationFrame(this.#request);
    this.element.remove();
  }

  set_content(content: PlotContent): void {
    this.#content = content;
    const hint = content.series.length === 0 ? content.empty ?? plot_texts.no_numbers :
                                               plot_texts.keys(this.#options.on_click !== undefined);
    this.#area.setAttribute("aria-label", plot_texts.described(content.title, hint));
    this.#legend.update(content);
    this.redraw();
  }

  /** Shows the whole x axis. */
  fit(): void {
    this.#link.fit();
  }

  x_extent(): Range|null {
    return x_extent(this.#content.series);
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
    const context = canvas.getContext("2d")!;
    const theme = theme_of(this.element), view = this.#view();
    context.fillStyle = theme.surface;
    context.fillRect(0, 0, width, height);
    const box = {left: image_margin, top: image_margin, right: width - image_margin, bottom: height - image_margin};
    const top = paint_legend(context, theme, view, box);
    paint_plot(context, theme, view, this.#link.shown(), {...box, top});
    return new Promise((done) => canvas.toBlob(done, "image/png"));
  }

  #view(): PlotView {
    return {
      content: this.#content,
      visible: this.#content.series.filter((series) => this.#legend.shows(series)),
      highlighted: this.#legend.highlighted,
      axes: this.#options.axes !== false,
    };
  }

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

  /** Clears a canvas. Returns its context, in CSS pixels. */
  #cleared(canvas: HTMLCanvasElement): CanvasRenderingContext2D {
    // This option makes the browser draw without the graphics processor: lines of thousands of numbers would block it
    // for seconds where it is emulated.
    const context = canvas.getContext("2d", {willReadFrequently: true})!;
    context.setTransform(1, 0, 0, 1, 0, 0);
    context.clearRect(0, 0, canvas.width, canvas.height);
    context.scale(canvas.width / this.#width, canvas.height / this.#height);
    return context;
  }

  #draw(): void {
    if (this.#width < 1 || this.#height < 1 || !this.element.isConnected) {
      return;
    }
    const box = {left: 0, top: 0, right: this.#width, bottom: this.#height};
    this.#frame = paint_plot(this.#cleared(this.#base), theme_of(this.element), this.#view(), this.#link.shown(), box);
    this.#draw_cursor();
  }

  #draw_cursor(): void {
    if (this.#frame === null || this.#width < 1) {
      return;
    }
    this.#cursor.draw(
      this.#cleared(this.#upper), theme_of(this.element), this.#view(), this.#frame, this.#input.selection);
    this.#place_note();
  }

  #place_note(): void {
    if (!this.#cursor.note.element.hidden) {
      this.#cursor.note.place(this.element, this.#cursor.pointer_y);
    }
  }
}
