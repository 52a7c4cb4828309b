// plot_content: what a plot shows, as data.
import type {Mark, Numbers} from "./plot_layout";

/** The names of colours. app.css defines their values. */
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
  thickness?: number; // CSS pixels; absent: thickness_default
  bar_width?: number; // of stacks and bars, in units of x; absent: 1
  whole?: boolean; // the numbers are counts: the note shows all their digits
}

export const thickness_default = 1.8; // CSS pixels, of a line

export interface Marks {
  marks: readonly(Mark&{label?: string})[]; // ordered by x; label: short text next to the line, if there is room
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

/** What is drawn of a content. */
export interface PlotView {
  content: PlotContent;
  visible: Series[]; // those that the user has not switched off
  highlighted: string; // name of the series whose entry in the legend is pointed at; empty: none
  axes: boolean; // false: the axes have only numbers, and nothing zooms
}

/** Returns the series that the legend lists. */
export function listed_series(series: readonly Series[]): Series[] {
  return series.filter((one) => one.in_legend !== false && one.name !== "");
}
