// parallel_axes: which organisms and genes a plot of parallel axes shows, and where their values lie. No DOM.
import type {GeneAxis} from "../world/gene_axes";

export const lines_max = 1000, axes_max = 40;
const axis_pixels_min = 24;

/** Returns up to `most` of `count` indices at equal distances, and always the one of the best. */
export function sample_of(count: number, most: number, best: number|null): number[] {
  const size = Math.min(count, most), sample = Array.from({length: size}, (_, i) => Math.floor(i * count / size));
  if (best !== null && !sample.includes(best)) {
    sample[Math.floor(best * size / count)] = best;
  }
  return sample;
}

/** How many of the genes have room next to each other. */
export function axes_with_room(gene_count: number, width: number): number {
  return Math.max(Math.min(gene_count, axes_max, Math.floor(width / axis_pixels_min)), 1);
}

/** The first index of the greatest value; null without values. */
export function best_of(values: ArrayLike<number>|null): number|null {
  let best: number|null = null;
  for (let i = 0; i < (values?.length ?? 0); ++i) {
    best = best === null || values![i]! > values![best]! ? i : best;
  }
  return best;
}

/** Returns the axis with bounds: without known ones, those of the values. Both are different. */
export function bounded(axis: GeneAxis, values: ArrayLike<number>): GeneAxis&{min: number; max: number} {
  let {min, max} = axis;
  if (min === null || max === null) {
    min = Infinity;
    max = -Infinity;
    for (let i = 0; i < values.length; ++i) {
      min = Math.min(min, values[i]!);
      max = Math.max(max, values[i]!);
    }
  }
  return !(min < max) ? {...axis, min: Number.isFinite(min) ? min : 0, max: Number.isFinite(min) ? min + 1 : 1} :
                        {...axis, min, max};
}

/** The place of a value on its axis: 0 at the lower bound, 1 at the upper. */
export function place_on({min, max, logarithmic}: {min: number; max: number; logarithmic: boolean}, value: number):
  number {
  const is_log = logarithmic && min > 0, of = (number: number): number => is_log ? Math.log(number) : number;
  return Math.min(Math.max((of(value) - of(min)) / (of(max) - of(min)), 0), 1);
}
