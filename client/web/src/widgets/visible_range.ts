// visible_range: the part of an axis that a drawing shows: zooms it and moves it. Pure functions.

export interface Range {
  min: number;
  max: number;
}

/** Shifts the range by `by`, limited to `whole`. */
export function moved(shown: Range, by: number, whole: Range): Range {
  const least = whole.min - shown.min;
  const shift = Math.min(Math.max(by, least), Math.max(whole.max - shown.max, least));
  return {min: shown.min + shift, max: shown.max + shift};
}

/** Zooms a range; factor > 1 shows a smaller part. The point at `share` of the range keeps its place. The result is
 *  inside `whole`. */
export function zoomed(shown: Range, share: number, factor: number, whole: Range, width_min: number): Range {
  const full = whole.max - whole.min, now = shown.max - shown.min;
  const at = shown.min + share * now;
  const width = Math.min(Math.max(now / factor, Math.min(width_min, full)), full);
  const begin = at - share * width;
  return moved({min: begin, max: begin + width}, 0, whole);
}

/** Moves the range so that the number is in its middle, unless the number is at least `margin` inside it. */
export function revealed(shown: Range, number: number, margin: number, whole: Range): Range {
  const is_visible = number >= shown.min + margin && number <= shown.max - margin;
  return is_visible ? shown : moved(shown, number - (shown.min + shown.max) / 2, whole);
}
