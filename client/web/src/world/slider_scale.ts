// slider_scale: where the slider of a parameter stands for a number, and the steps of its number field. Pure functions.
import type {ParameterDescription} from "../core/protocol";
import {nice_step} from "../texts/numbers";

const decades_min = 100; // if max / min is above this ratio, the slider is logarithmic

/** Returns whether the range is so large that its slider needs a logarithmic scale. */
export function spans_decades(about: ParameterDescription): boolean {
  const {min = 0, max = 0} = about;
  const least = about.kind === "PARAMETER_KIND_COUNT" || min <= 0 ? Math.max(min, 1) : min;
  return max / least > decades_min;
}

/** A logarithmic scale that also contains 0 and negative numbers: linear near 0, logarithmic beyond the size
 * `linear`. */
function log_scale(number: number, linear: number): number {
  return Math.sign(number) * Math.log1p(Math.abs(number) / linear);
}

/** Returns the size up to which the scale of the slider is linear; 0 for a range above 0, which is purely
 * logarithmic. */
function linear_size(about: ParameterDescription): number {
  const {min = 0, max = 0} = about;
  if (min > 0) {
    return 0;
  }
  return about.kind === "PARAMETER_KIND_COUNT" ? 1 : Math.min(1, Math.max(Math.abs(min), max) / 10000);
}

/** Returns where the slider stands, 0 to 1. Numbers outside the range stand at its ends. */
export function share_of(about: ParameterDescription, number: number): number {
  const {min = 0, max = 0} = about;
  const inside = Math.min(Math.max(number, min), max);
  if (!(max > min)) {
    return 0;
  }
  if (!spans_decades(about)) {
    return (inside - min) / (max - min);
  }
  const linear = linear_size(about);
  if (linear === 0) {
    return Math.log(inside / min) / Math.log(max / min);
  }
  const least = log_scale(min, linear);
  return (log_scale(inside, linear) - least) / (log_scale(max, linear) - least);
}

/** Returns the number at a place of the slider: the ends exactly, between them a number with few digits. */
export function number_at(about: ParameterDescription, share: number): number {
  const {min = 0, max = 0} = about;
  if (share <= 0 || share >= 1) {
    return share <= 0 ? min : max;
  }
  const clamp = (number: number): number => Math.min(Math.max(number, min), max);
  const is_count = about.kind === "PARAMETER_KIND_COUNT";
  if (!spans_decades(about)) {
    const step = Math.max(nice_step((max - min) / 200), is_count ? 1 : 0);
    return clamp(Number((Math.round((min + share * (max - min)) / step) * step).toPrecision(12)));
  }
  const linear = linear_size(about);
  let number: number;
  if (linear === 0) {
    number = min * Math.pow(max / min, share);
  } else {
    const least = log_scale(min, linear), at = least + share * (log_scale(max, linear) - least);
    number = Math.sign(at) * Math.expm1(Math.abs(at)) * linear;
  }
  return clamp(is_count ? Math.round(Number(number.toPrecision(2))) : Number(number.toPrecision(2)));
}

/** Returns the number one step up or down, as the arrow keys of a number field set it. The steps of a real are 1, 2
 * or 5 times a power of ten. */
export function stepped(about: ParameterDescription, number: number, up: boolean, large: boolean): number {
  const {min = 0, max = 0} = about;
  const is_count = about.kind === "PARAMETER_KIND_COUNT";
  const size = spans_decades(about) && number !== 0 ? Math.abs(number) / 20 : (max - min) / 100;
  const fine = is_count && !large ? 1 : nice_step(size);
  const step = (is_count ? Math.max(1, Math.round(fine)) : fine) * (large ? 10 : 1);
  return Math.min(Math.max(Number((number + (up ? step : -step)).toPrecision(10)), min), max);
}
