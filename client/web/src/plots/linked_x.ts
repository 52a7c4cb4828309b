// LinkedX: the visible part of the x axis. Plots that share it show the same part.
import {moved, type Range, zoomed} from "../widgets/visible_range";
import {joined} from "./plot_layout";
import type {Series} from "./plot_content";

const units_min = 4; // least visible width

export interface LinkedPlot {
  /** The range of x of all its series; null: it has no numbers. */
  x_extent(): Range|null;
  redraw(): void;
}

export class LinkedX {
  readonly #plots = new Set<LinkedPlot>();
  #range: Range|null = null; // null: the whole axis

  add(plot: LinkedPlot): void {
    this.#plots.add(plot);
  }

  remove(plot: LinkedPlot): void {
    this.#plots.delete(plot);
  }

  /** Whether only a part of the axis is shown. */
  get is_zoomed(): boolean {
    return this.#range !== null;
  }

  /** The range of x of all linked plots. */
  whole(): Range {
    let whole: Range|null = null;
    for (const plot of this.#plots) {
      whole = joined(whole, plot.x_extent());
    }
    if (whole === null) {
      return {min: 0, max: 1};
    }
    return whole.max > whole.min ? whole : {min: whole.min - 0.5, max: whole.max + 0.5};
  }

  shown(): Range {
    return this.#range === null ? this.whole() : zoomed(this.#range, 0, 1, this.whole(), units_min);
  }

  /** Shows a part of the axis. */
  show(range: Range): void {
    const whole = this.whole();
    this.#set(range.min <= whole.min && range.max >= whole.max ? null : range);
  }

  /** Shows the whole axis. */
  fit(): void {
    this.#set(null);
  }

  /** Shows `from`, zoomed by a factor; the point at `share` of the range keeps its place. */
  zoom(from: Range, share: number, factor: number, moved_by: (zoomed: Range) => number = () => 0): void {
    const next = zoomed(from, share, factor, this.whole(), units_min);
    this.show(moved(next, moved_by(next), this.whole()));
  }

  /** Shows `from`, moved along the axis. */
  move(from: Range, by: number): void {
    this.show(moved(from, by, this.whole()));
  }

  #set(range: Range|null): void {
    this.#range = range;
    this.#plots.forEach((plot) => plot.redraw());
  }
}

/** Returns the range of x that the series need, with the halves of the outer bars; null if there are no numbers. */
export function x_extent(series: readonly Series[]): Range|null {
  let extent: Range|null = null;
  for (const {x, kind, bar_width} of series) {
    if (x.length > 0) {
      const half = kind === "stack" || kind === "bars" ? (bar_width ?? 1) / 2 : 0;
      extent = joined(extent, {min: x[0]! - half, max: x[x.length - 1]! + half});
    }
  }
  return extent;
}
