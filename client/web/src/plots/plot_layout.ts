// plot_layout: ticks, ranges, running means, the points with which a long series is drawn, and groups of marks.
// Pure functions.
import {nice_step, with_separators} from "../texts/numbers";
import type {Range} from "../widgets/visible_range";

export type Numbers = ArrayLike<number>;

/** Dashes of the compared history. */
export const compare_dash: readonly number[] = [6, 4];

/** Returns the smallest range that contains the finite numbers of indices begin to end - 1; null if there is none. */
export function range_of(numbers: Numbers, begin = 0, end = numbers.length): Range|null {
  let min = Infinity, max = -Infinity;
  for (let i = begin; i < end; ++i) {
    const number = numbers[i] as number;
    if (number < min && number !== -Infinity) {
      min = number;
    }
    if (number > max && number !== Infinity) {
      max = number;
    }
  }
  return min <= max ? {min, max} : null;
}

export function joined(a: Range|null, b: Range|null): Range|null {
  return a === null ? b : b === null ? a : {min: Math.min(a.min, b.min), max: Math.max(a.max, b.max)};
}

/** Widens a range by `share` of its width at each end, and at least so much that it is not empty. */
export function with_room(range: Range, share: number): Range {
  const middle = range.min / 2 + range.max / 2;
  const least = Math.max(Math.abs(middle) * 1e-9, 1e-12);
  const half = Math.max((range.max / 2 - range.min / 2) * (1 + 2 * share), least);
  return {min: middle - half, max: middle + half};
}

/** Returns at most `count_max` round numbers inside the range. Their distance `step` is 1, 2 or 5 times a power of ten.
 *
 *  step_min  least distance of two ticks; 1 for counts */
export function ticks_in(range: Range, count_max: number, step_min = 0): {step: number; at: number[]} {
  const rough = (range.max - range.min) / Math.max(count_max, 1);
  if (!(rough > 0) || !Number.isFinite(rough)) {
    return {step: 1, at: []};
  }
  for (let step = nice_step(Math.max(rough / 2, step_min));; step = nice_step(1.5 * step)) {
    const first = Math.ceil(range.min / step - 1e-9), last = Math.floor(range.max / step + 1e-9);
    if (last - first + 1 <= count_max) {
      const at = [];
      for (let number = first; number <= last; ++number) {
        at.push(number === 0 ? 0 : number * step);
      }
      return {step, at};
    }
  }
}

/** Returns the text of a tick, with as many decimals as `step` requires: "1,500", "0.25", "1.5e+20". */
export function tick_label(tick: number, step: number): string {
  const size = Math.max(Math.abs(tick), step);
  if (size >= 1e9 || size < 1e-5) {
    return with_separators(String(Number(tick.toPrecision(6))));
  }
  const decimals = Math.max(0, Math.ceil(-Math.log10(step) - 1e-9));
  return with_separators(tick.toFixed(Math.min(decimals, 12)));
}

/** Returns the index of the first number that is >= `at`, or > `at` if `after`. `x` rises. */
export function lower_bound(x: Numbers, at: number, after = false): number {
  let begin = 0, end = x.length;
  while (begin < end) {
    const middle = (begin + end) >>> 1;
    const number = x[middle] as number;
    if (number < at || (after && number === at)) {
      begin = middle + 1;
    } else {
      end = middle;
    }
  }
  return begin;
}

/** Returns the index of the number in `x` that is nearest to `at`; -1 if `x` is empty. `x` rises. */
export function nearest(x: Numbers, at: number): number {
  const after = lower_bound(x, at);
  if (after === 0) {
    return x.length === 0 ? -1 : 0;
  }
  return after < x.length && (x[after] as number) - at < at - (x[after - 1] as number) ? after : after - 1;
}

/** Returns the indices at which groups begin, and the end of the last group. All numbers of a group are drawn in one
 *  column of pixels. The groups contain the visible part of a series and one more number at each end. If a column has
 *  at most two numbers on average, every number is a group of its own. `x` rises. */
export function groups_of(x: Numbers, shown: Range, columns: number): Uint32Array {
  const begin = Math.max(lower_bound(x, shown.min) - 1, 0);
  const end = Math.min(lower_bound(x, shown.max, true) + 1, x.length);
  const count = Math.max(end - begin, 0);
  const starts = new Uint32Array(count + 1);
  if (count <= 2 * columns || !(shown.max > shown.min)) {
    for (let i = 0; i <= count; ++i) {
      starts[i] = begin + i;
    }
    return starts;
  }
  const per_column = columns / (shown.max - shown.min);
  let used = 0, column = NaN;
  for (let i = begin; i < end; ++i) {
    const here = Math.floor(((x[i] as number) - shown.min) * per_column);
    if (here !== column) {
      starts[used++] = i;
      column = here;
    }
  }
  starts[used++] = end;
  return starts.subarray(0, used);
}

/** Returns the points x, y, x, y, … of the line through the numbers. A y of NaN interrupts the line. A group
 *  contributes at most four points, which are the first, the least, the greatest and the last number, so no peak is
 *  lost. */
export function line_of(x: Numbers, y: Numbers, starts: Uint32Array): number[] {
  const points: number[] = [];
  const add = (i: number) => {
    const length = points.length;
    if (length === 0 || points[length - 2] !== x[i] || points[length - 1] !== y[i]) {
      points.push(x[i] as number, y[i] as number);
    }
  };
  for (let group = 0; group + 1 < starts.length; ++group) {
    const begin = starts[group] as number, end = starts[group + 1] as number;
    let first = -1, last = -1, least = -1, greatest = -1;
    let split = false;
    for (let i = begin; i < end; ++i) {
      const number = y[i] as number;
      if (!Number.isFinite(number)) {
        split = split || first < 0;
        continue;
      }
      if (first < 0) {
        first = least = greatest = i;
      }
      last = i;
      least = number < (y[least] as number) ? i : least;
      greatest = number > (y[greatest] as number) ? i : greatest;
    }
    if (split && points.length > 0 && !Number.isNaN(points[points.length - 1])) {
      points.push(x[begin] as number, NaN);
    }
    if (first >= 0) {
      add(first);
      add(Math.min(least, greatest));
      add(Math.max(least, greatest));
      add(last);
    }
  }
  return points;
}

/** Returns the mean of the finite numbers of indices begin to end - 1; 0 if there is none. */
export function mean_of(y: Numbers, begin: number, end: number): number {
  let sum = 0, count = 0;
  for (let i = begin; i < end; ++i) {
    if (Number.isFinite(y[i])) {
      sum += y[i] as number;
      ++count;
    }
  }
  return count > 0 ? sum / count : 0;
}

/** Returns, for each finite number, the mean of the finite numbers among it and the `window` - 1 numbers before it; NaN
 *  for other numbers. Later numbers have no influence, so an effect never appears before its cause. */
export function running_mean(y: Numbers, window: number): Float64Array {
  const means = new Float64Array(y.length);
  for (let i = 0; i < y.length; ++i) {
    means[i] = Number.isFinite(y[i]) ? mean_of(y, Math.max(0, i + 1 - window), i + 1) : NaN;
  }
  return means;
}

/** Counts the numbers in each of `count` bins of equal width. The upper end of the range belongs to the last bin. */
export function histogram(numbers: Numbers, range: Range, count: number): number[] {
  const bins = new Array<number>(count).fill(0);
  const width = range.max - range.min;
  for (let i = 0; i < numbers.length; ++i) {
    const number = numbers[i] as number;
    if (number >= range.min && number <= range.max) {
      const bin = Math.min(Math.floor(width > 0 ? ((number - range.min) / width) * count : 0), count - 1);
      bins[bin] = (bins[bin] as number) + 1;
    }
  }
  return bins;
}

/** A vertical line in a plot, with the text that explains it. */
export interface Mark {
  x: number;
  text: string;
}

/** Returns the x of each line that represents the visible marks: marks nearer than `distance` to the first one of a
 *  line share this line. */
export function mark_lines(marks: readonly Mark[], shown: Range, distance: number): number[] {
  const lines: number[] = [];
  for (const {x} of marks) {
    if (
      x >= shown.min && x <= shown.max && (lines.length === 0 || x - (lines[lines.length - 1] as number) >= distance)) {
      lines.push(x);
    }
  }
  return lines;
}

export interface Box {
  left: number;
  top: number;
  right: number;
  bottom: number;
}

/** Returns the upper left corner of a note of this size next to a box: on its left side, or else where there is room:
 *  on
 *  the right, above or below. y: the height at which the note is centred. */
export function note_place(
  box: Box, size: {width: number; height: number}, y: number,
  window: {width: number; height: number}): {left: number; top: number} {
  const gap = 4;
  const clamp = (number: number, most: number) => Math.min(Math.max(number, 0), Math.max(most, 0));
  const beside = clamp(y - size.height / 2, window.height - size.height);
  if (box.left - gap >= size.width) {
    return {left: box.left - gap - size.width, top: beside};
  }
  if (window.width - box.right - gap >= size.width) {
    return {left: box.right + gap, top: beside};
  }
  const left = clamp(box.left, window.width - size.width);
  if (box.top - gap >= size.height) {
    return {left, top: box.top - gap - size.height};
  }
  return {left, top: clamp(box.bottom + gap, window.height - size.height)};
}
