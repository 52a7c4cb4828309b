// parameters: the registry of the server: groups of parameters, search, names for people, values as texts and numbers,
// and where the slider of a parameter stands. Pure functions.
import type {ParameterDescription, ParameterValue} from "../core/protocol";
import {nice_step, rounded, with_separators} from "../texts/numbers";
import {parameter_words} from "../texts/parameter_words";

const unit_length_max = 10; // longer units do not fit next to a field

export interface ParameterGroup {
  title: string;
  members: number[]; // indices in the registry
}

/** Returns the parameters that users change most often, in the order of the registry. */
export function most_used(registry: readonly ParameterDescription[]): ParameterGroup {
  return {title: parameter_words.most_used, members: registry.flatMap((about, i) => (about.is_most_used ? [i] : []))};
}

/** Groups the registry by topic, in its order. */
export function grouped(registry: readonly ParameterDescription[]): ParameterGroup[] {
  const groups: ParameterGroup[] = [];
  registry.forEach((about, i) => {
    const title = about.topic ?? "";
    if (groups.at(-1)?.title !== title) {
      groups.push({title, members: []});
    }
    groups.at(-1)!.members.push(i);
  });
  return groups;
}

function plain(text: string): string {
  return text.toLowerCase().replace(/_/g, " ");
}

/** Returns whether the parameter or the title of its group contains every word of `search`: in the name, the unit, the
 *  help, the choices or their help. Case is ignored; _ counts as a space. */
export function matches(about: ParameterDescription, group: string, search: string): boolean {
  const all = plain([
    about.name ?? "", about.unit ?? "", about.help ?? "", group, ...(about.choices ?? []), ...(about.choice_help ?? [])
  ].join(" "));
  return plain(search).split(" ").every((word) => all.includes(word));
}

/** Returns the name for people, without the unit at its end: "Mutation chance", "Tick" for tick_s. */
export function label_of(about: ParameterDescription): string {
  let name = about.name ?? "";
  for (const [unit, end] of [["s", "_s"], ["px", "_px"], ["px/s", "_px_s"], ["kg", "_kg"]] as const) {
    if (about.unit === unit && name.endsWith(end)) {
      name = name.slice(0, -end.length);
    }
  }
  const label = plain(name);
  return label.charAt(0).toUpperCase() + label.slice(1);
}

/** Returns the name of a choice for people: "stochastic universal". */
export function label_of_choice(choice: string): string {
  return plain(choice);
}

/** Returns the unit beside a number: "px", "island" after 1, "islands" after 2. Empty if there is none, or if it is
 * too long. */
export function unit_text(about: ParameterDescription, number: number): string {
  const unit = about.unit ?? "";
  const text = about.kind === "PARAMETER_KIND_COUNT" && number === 1 && unit.endsWith("s") ? unit.slice(0, -1) : unit;
  return text.length > unit_length_max ? "" : text;
}

export function is_number(about: ParameterDescription): boolean {
  return about.kind === "PARAMETER_KIND_REAL" || about.kind === "PARAMETER_KIND_COUNT";
}

/** Returns the allowed values as text: "0.01 to 1", "roulette, tournament", "on or off". */
export function allowed_text(about: ParameterDescription): string {
  if (about.kind === "PARAMETER_KIND_FLAG") {
    return parameter_words.on_or_off;
  }
  if (about.kind === "PARAMETER_KIND_CHOICE") {
    return (about.choices ?? []).join(", ");
  }
  return parameter_words.range(about.min ?? 0, about.max ?? 0);
}

export function same(a: ParameterValue, b: ParameterValue): boolean {
  return a.real === b.real && a.count === b.count && a.flag === b.flag && a.choice === b.choice;
}

/** Returns the value as text: "0.15", "25", "on", "roulette". */
export function value_text(value: ParameterValue): string {
  if (value.real !== undefined) {
    return rounded(value.real);
  }
  if (value.count !== undefined) {
    return with_separators(value.count);
  }
  return value.flag !== undefined ? (value.flag ? parameter_words.on : parameter_words.off) : value.choice ?? "";
}

export function number_of(value: ParameterValue): number {
  return value.real ?? value.count ?? 0;
}

/** Converts a number to a real or a count. A count is rounded and limited to 32 bits. The server rejects a value out
 * of range. */
export function value_of(about: ParameterDescription, number: number): ParameterValue {
  return about.kind === "PARAMETER_KIND_COUNT" ? {count: Math.min(Math.max(Math.round(number), 0), 0xffffffff)} :
                                                 {real: number};
}

/** Reads a number that a user has typed; null if it is none. In a real, a comma may stand for the point; in a count,
 *  commas may separate thousands, as value_text() prints them. */
export function typed_number(about: ParameterDescription, text: string): number|null {
  const clean = text.trim().replace("−", "-");
  if (about.kind === "PARAMETER_KIND_COUNT") {
    const number = /^(\d+|\d{1,3}(,\d{3})+)$/.test(clean) ? Number(clean.replace(/,/g, "")) : NaN;
    return number <= 0xffffffff ? number : null;
  }
  const number = /^[+-]?(\d+[.,]?\d*|[.,]\d+)(e[+-]?\d+)?$/i.test(clean) ? Number(clean.replace(",", ".")) : NaN;
  return Number.isFinite(number) ? number : null;
}

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
