// plot_frame: which numbers a drawn plot shows, and where. Computes it from the content; draws nothing.
import {groups_of, joined, mean_of, nearest, range_of, tick_label, ticks_in, with_room} from "./plot_layout";
import type {Box} from "./plot_layout";
import type {Range} from "../widgets/visible_range";
import type {PlotView, Series} from "./plot_content";

export interface Frame {
  x: Range;
  y: Range;
  area: Box; // of the lines, inside the labels
  groups: Map<Series, Uint32Array>; // see groups_of()
}

const y_range_unknown: Range = {
  min: 0,
  max: 1
};

/** Computes the groups of each series, the y range and the area that remains next to the labels.
 *
 *  width_of  the width of a text in pixels */
export function lay_out(view: PlotView, x: Range, box: Box, width_of: (text: string) => number): Frame {
  const columns = Math.max(Math.round(box.right - box.left), 1);
  const groups = new Map(view.visible.map((series) => [series, groups_of(series.x, x, columns)]));
  const y = y_range(view, groups);
  const [above, below] = view.axes ? [18, 34] : [5, 20];
  const area = {
    left: box.left,
    top: box.top + above,
    right: Math.max(box.right - 8, box.left + 1),
    bottom: Math.max(box.bottom - below, box.top + above + 1)
  };
  const ticks = y_ticks(y, area);
  const widest = Math.max(0, ...ticks.at.map((tick) => width_of(tick_label(tick, ticks.step))));
  area.left = Math.min(box.left + Math.ceil(widest) + 8, area.right - 1);
  return {x, y, area, groups};
}

function y_range({visible, content}: PlotView, groups: Map<Series, Uint32Array>): Range {
  let known: Range|null = null;
  let tops: number[] = [];
  for (const series of visible) {
    const starts = groups.get(series)!;
    if (starts.length < 2) {
      continue;
    }
    if (series.kind === "stack") {
      tops = stack_tops(series, starts, tops);
      known = joined(known, range_of(tops));
      continue;
    }
    const begin = starts[0]!, end = starts[starts.length - 1]!;
    for (const numbers of [series.y, series.raw, series.low]) {
      known = numbers === undefined ? known : joined(known, range_of(numbers, begin, end));
    }
    known = series.kind === "bars" ? joined(known, {min: 0, max: 0}) : known;
  }
  const range = known ?? y_range_unknown;
  const from_zero = content.from_zero === true && range.min >= 0;
  const room = with_room(from_zero ? {min: 0, max: range.max} : range, 0.04);
  if (range.min >= 0) { // no room below 0 for numbers that are never negative
    room.min = from_zero ? 0 : Math.max(room.min, 0);
    room.max = Math.max(room.max, 1e-9);
  }
  return room;
}

/** Returns the upper end of each bar of a stack on top of the bars that end at `bottoms`. */
export function stack_tops(series: Series, starts: Uint32Array, bottoms: readonly number[]): number[] {
  return Array.from(
    {length: Math.max(starts.length - 1, 0)},
    (_, i) => (bottoms[i] ?? 0) + mean_of(series.y, starts[i]!, starts[i + 1]!));
}

export function y_ticks(y: Range, area: Box): {step: number; at: number[]} {
  return ticks_in(y, Math.max(2, Math.floor((area.bottom - area.top) / 24)));
}

export function column(frame: Frame, x: number): number {
  const share = (x - frame.x.min) / (frame.x.max - frame.x.min);
  return frame.area.left + Math.min(Math.max(share, -1), 2) * (frame.area.right - frame.area.left);
}

export function row(frame: Frame, y: number): number {
  const share = (y - frame.y.min) / (frame.y.max - frame.y.min);
  return frame.area.bottom - Math.min(Math.max(share, -1), 2) * (frame.area.bottom - frame.area.top);
}

export function x_at(frame: Frame, pixels: number): number {
  return frame.x.min + ((pixels - frame.area.left) / width_of_area(frame)) * (frame.x.max - frame.x.min);
}

export function width_of_area(frame: Frame): number {
  return Math.max(frame.area.right - frame.area.left, 1);
}

/** Returns the visible x of the numbers nearest to a column of pixels; null if there are none. */
export function x_near(frame: Frame, series: readonly Series[], pixels: number): number|null {
  const at = x_at(frame, pixels);
  let found: number|null = null;
  for (const {x} of series) {
    const index = nearest(x, at);
    if (index >= 0) {
      const here = x[index]!;
      found = found === null || Math.abs(here - at) < Math.abs(found - at) ? here : found;
    }
  }
  return found !== null && found >= frame.x.min && found <= frame.x.max ? found : null;
}
