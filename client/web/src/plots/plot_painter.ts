// plot_painter: paints a plot on the context of a canvas: axes, series and marks.
import {column, lay_out, row, stack_tops, width_of_area, y_ticks} from "./plot_frame";
import type {Frame} from "./plot_frame";
import {thickness_default} from "./plot_content";
import type {PlotView, Series} from "./plot_content";
import {line_of, mark_lines, range_of, tick_label, ticks_in} from "./plot_layout";
import type {Box, Numbers} from "./plot_layout";
import type {Range} from "../widgets/visible_range";
import {band_alpha} from "./plot_theme";
import type {PlotTheme} from "./plot_theme";

const raw_alpha = 0.38, dense_alpha = 0.5, faded_alpha = 0.18;
export const mark_pixels = 5; // marks nearer than this are drawn as one and read together

/** A plot while it is painted. */
interface Sheet {
  context: CanvasRenderingContext2D;
  theme: PlotTheme;
  view: PlotView;
  frame: Frame;
}

/** Paints the part `x` of a plot into the box. Returns what was painted where. */
export function paint_plot(
  context: CanvasRenderingContext2D, theme: PlotTheme, view: PlotView, x: Range, box: Box): Frame {
  context.font = `12px ${theme.font}`;
  context.textBaseline = "alphabetic";
  const frame = lay_out(view, x, box, (text) => context.measureText(text).width);
  const sheet: Sheet = {context, theme, view, frame};
  const {area} = frame;
  const width = area.right - area.left, height = area.bottom - area.top;
  context.fillStyle = theme.surface;
  context.fillRect(area.left, area.top, width, height);
  if (view.axes || view.visible.length > 0) {
    paint_axes(sheet, box);
  }
  context.save();
  context.beginPath();
  context.rect(area.left, area.top, width, height);
  context.clip();
  let bottoms: number[] = [];
  for (const series of view.visible.filter((one) => one.kind === "stack")) {
    bottoms = paint_stack(sheet, series, bottoms);
  }
  for (const series of [...view.visible].reverse()) {
    context.globalAlpha = alpha_of(view, series);
    paint_series(sheet, series);
  }
  context.globalAlpha = 1;
  paint_marks(sheet);
  context.restore();
  context.strokeStyle = theme.line;
  context.lineWidth = 1;
  context.strokeRect(area.left + 0.5, area.top + 0.5, width - 1, height - 1);
  if (view.content.series.length === 0 && view.content.empty !== undefined && view.axes) {
    context.fillStyle = theme.quiet;
    context.textAlign = "center";
    context.fillText(view.content.empty, (area.left + area.right) / 2, (area.top + area.bottom) / 2);
    context.textAlign = "left";
  }
  return frame;
}

function alpha_of(view: PlotView, series: Series): number {
  return view.highlighted !== "" && view.highlighted !== series.name ? faded_alpha : 1;
}

// ---- axes ----

function paint_axes({context, theme, view, frame}: Sheet, box: Box): void {
  const {area} = frame;
  context.lineWidth = 1;
  context.textAlign = "left";
  context.fillStyle = theme.quiet;
  if (view.axes) {
    context.fillText(view.content.y_label, box.left, box.top + 11, box.right - box.left);
    context.textAlign = "center";
    context.fillText(view.content.x_label, (area.left + area.right) / 2, area.bottom + 30);
  }
  const of_y = y_ticks(frame.y, area);
  context.strokeStyle = theme.grid;
  context.beginPath();
  for (const tick of of_y.at) {
    const y = Math.round(row(frame, tick)) + 0.5;
    context.moveTo(area.left, y);
    context.lineTo(area.right, y);
  }
  const of_x =
    ticks_in(frame.x, Math.max(2, Math.floor((area.right - area.left) / 70)), view.content.counted_x === true ? 1 : 0);
  for (const tick of of_x.at) {
    const x = Math.round(column(frame, tick)) + 0.5;
    context.moveTo(x, area.top);
    context.lineTo(x, area.bottom + 4);
  }
  context.stroke();
  context.fillStyle = theme.text;
  context.textAlign = "right";
  for (const tick of of_y.at) {
    context.fillText(tick_label(tick, of_y.step), area.left - 5, Math.round(row(frame, tick)) + 4);
  }
  context.textAlign = "center";
  for (const tick of of_x.at) {
    const label = tick_label(tick, of_x.step);
    const half = context.measureText(label).width / 2;
    context.fillText(label, Math.min(column(frame, tick), box.right - half), area.bottom + 16);
  }
  context.textAlign = "left";
}

// ---- series ----

function paint_series(sheet: Sheet, series: Series): void {
  const {context, theme, frame} = sheet;
  const starts = frame.groups.get(series)!;
  const alpha = context.globalAlpha;
  context.strokeStyle = context.fillStyle = theme.series[series.colour];
  if (series.kind === "line") {
    if (series.raw !== undefined) {
      context.globalAlpha = alpha * raw_alpha;
      paint_line(sheet, {x: series.x, y: series.raw, starts}, 1, []);
      context.globalAlpha = alpha;
    }
    paint_line(
      sheet, {x: series.x, y: series.y, starts}, series.thickness ?? thickness_default, [...series.dash ?? []]);
  } else if (series.kind === "band" && series.low !== undefined) {
    context.globalAlpha = alpha * band_alpha;
    paint_band(sheet, series.x, series.low, series.y, starts);
  } else if (series.kind === "bars") {
    for (let i = 0; i + 1 < starts.length; ++i) {
      const begin = starts[i]!;
      paint_bar(sheet, series, begin, starts[i + 1]!, 0, series.y[begin]!);
    }
  }
}

function paint_line(
  {context, frame}: Sheet, {x, y, starts}: {x: Numbers; y: Numbers; starts: Uint32Array}, thickness: number,
  dash: number[]): void {
  const dense = starts.length > 1 && starts[starts.length - 1]! - starts[0]! > starts.length - 1;
  const points = line_of(x, y, starts);
  context.lineWidth = dense ? 1 : thickness;
  context.lineJoin = "round";
  // Within a column of pixels a dense line moves up and down: dashes would be invisible.
  context.setLineDash(dense ? [] : dash);
  const alpha = context.globalAlpha;
  context.globalAlpha = dense && dash.length > 0 ? alpha * dense_alpha : alpha;
  context.beginPath();
  for (let i = 0; i < points.length; i += 2) {
    const at_y = points[i + 1]!;
    if (Number.isNaN(at_y)) {
      continue;
    }
    const begins = i === 0 || Number.isNaN(points[i - 1]), ends = i + 2 >= points.length || Number.isNaN(points[i + 3]);
    const at = column(frame, points[i]!), height = row(frame, at_y);
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

/** Paints the area between the least `low` and the greatest `high` of each group. A group without a finite number
 *  interrupts the area. */
function paint_band({context, frame}: Sheet, x: Numbers, low: Numbers, high: Numbers, starts: Uint32Array): void {
  let points: {x: number; low: number; high: number}[] = [];
  const finish = () => {
    context.beginPath();
    points.forEach((point) => context.lineTo(point.x, point.high));
    points.reverse().forEach((point) => context.lineTo(point.x, point.low));
    context.fill();
    points = [];
  };
  for (let i = 0; i + 1 < starts.length; ++i) {
    const begin = starts[i]!, end = starts[i + 1]!;
    const lows = range_of(low, begin, end), highs = range_of(high, begin, end);
    if (lows === null || highs === null) {
      finish();
    } else {
      points.push({x: column(frame, x[begin]!), low: row(frame, lows.min), high: row(frame, highs.max)});
    }
  }
  finish();
}

/** Paints a stack on top of the bars that end at `bottoms`. Returns the upper ends of its bars. */
function paint_stack(sheet: Sheet, series: Series, bottoms: readonly number[]): number[] {
  const {context, theme, view, frame} = sheet;
  const starts = frame.groups.get(series)!;
  context.fillStyle = theme.series[series.colour];
  context.globalAlpha = alpha_of(view, series);
  const tops = stack_tops(series, starts, bottoms);
  tops.forEach((top, i) => paint_bar(sheet, series, starts[i]!, starts[i + 1]!, bottoms[i] ?? 0, top));
  context.globalAlpha = 1;
  return tops;
}

/** Paints a bar from y `from` to `to` for the numbers with indices begin to end - 1. */
function paint_bar(
  {context, frame}: Sheet, series: Series, begin: number, end: number, from: number, to: number): void {
  const half = (series.bar_width ?? 1) / 2;
  let left = column(frame, series.x[begin]! - half), right = column(frame, series.x[end - 1]! + half);
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

// ---- marks ----

function paint_marks(sheet: Sheet): void {
  const {context, theme, view, frame} = sheet;
  const {area} = frame;
  const distance = (mark_pixels / width_of_area(frame)) * (frame.x.max - frame.x.min);
  (view.content.marks ?? []).forEach(({marks}, index) => {
    const lines = mark_lines(marks, frame.x, distance);
    let labelled_until = area.left;
    context.strokeStyle = context.fillStyle = theme.mark;
    context.lineWidth = 1;
    lines.forEach((at, i) => {
      paint_mark(sheet, at, index === 0);
      const label = index === 0 ? marks.find((mark) => mark.x === at)?.label : undefined;
      if (label !== undefined) {
        const left = Math.max(labelled_until, i > 0 ? column(frame, lines[i - 1]!) + mark_pixels : area.left);
        const right = i + 1 < lines.length ? column(frame, lines[i + 1]!) - mark_pixels : area.right;
        labelled_until = paint_label(sheet, label, Math.round(column(frame, at)) + 0.5, left, right) ?? labelled_until;
      }
    });
  });
}

/** Paints a dotted line with a triangle at its top, which is hollow for a compared history. */
function paint_mark({context, frame}: Sheet, at: number, filled: boolean): void {
  const {area} = frame;
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
  if (filled) {
    context.fill();
  } else {
    context.stroke();
  }
}

/** Paints the label of the mark at x, to its right or else to its left, if it fits between `left` and `right`. Returns
 *  where a label on the right ends; null if there is none. */
function paint_label({context, theme, frame}: Sheet, label: string, x: number, left: number, right: number): number|
  null {
  context.font = `10px ${theme.font}`;
  const width = context.measureText(label).width + mark_pixels + 3;
  if (x + width <= right) {
    context.fillText(label, x + mark_pixels + 2, frame.area.top + 10);
    return x + width;
  }
  if (x - width >= left) {
    context.fillText(label, x - width, frame.area.top + 10);
  }
  return null;
}
