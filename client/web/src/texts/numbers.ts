// Numbers and durations as text, in the format of all programs of evod, with the separators of the language.
import {separators} from "./separators";

/** 1234567 → "1,234,567". */
export function with_separators(number: number|bigint|string): string {
  const text = String(typeof number === "number" ? (Number.isInteger(number) ? number : Math.round(number)) : number);
  return separated(text);
}

function separated(text: string): string {
  const [, sign, whole, rest] = /^(-?)(\d*)(.*)$/s.exec(text)!;
  return (sign ? "−" : "") + whole!.replace(/\B(?=(\d{3})+$)/g, separators.thousands) + localised(rest!);
}

/** "0.15", as programs write it, with the decimal separator of the language. */
export function localised(number: string): string {
  return number.replace(".", separators.decimal);
}

/** Up to 6 significant digits, without trailing zeros: 0.15, 12.5, 1,234.5; "–" unless the number is finite. */
export function shown_number(number: number): string {
  if (!Number.isFinite(number)) {
    return "–";
  }
  const size = Math.abs(number);
  if (size !== 0 && (size >= 1e12 || size < 1e-4)) {
    return separated(String(Number(number.toPrecision(6))).replace(/e([+-])(\d)$/, "e$10$2"));
  }
  const digits = size >= 1 ? Math.floor(Math.log10(size)) + 1 : 1;
  const text = number.toFixed(Math.max(0, 6 - digits)).replace(/(\.\d*?)0+$/, "$1").replace(/\.$/, "");
  return separated(text === "-0" ? "0" : text);
}

/** Three significant digits: 0.123, 12.3, 1,230. */
export function significant(number: number): string {
  if (number === 0 || !Number.isFinite(number)) {
    return shown_number(number);
  }
  return shown_number(Number(number.toPrecision(3)));
}

/** Three digits, but whole numbers of more digits stay whole: 0.123, 12.3, 12,345. */
export function three_digits(number: number): string {
  const size = Math.abs(number);
  if (!Number.isFinite(number) || size >= 1e12) {
    return shown_number(number);
  }
  return size >= 999.5 ? separated(number.toFixed(0)) : shown_number(Number(number.toPrecision(3)));
}

/** A fitness with separators and "−": plain_fitness(), or "–" unless it is finite. */
export function fitness_text(fitness: number): string {
  return Number.isFinite(fitness) ? separated(plain_fitness(fitness)) : "–";
}

/** A finite fitness, by the rule of `fitness_text` in proto/text/number_text.h. */
export function plain_fitness(fitness: number): string {
  const size = Math.abs(fitness);
  if (size >= 10 && size < 1e7) {
    return rounded_to_even(fitness, Math.floor(Math.log10(size)) + 2).toFixed(1);
  }
  const rounded = fitness === 0 ? 0 : rounded_to_even(fitness, 4);
  const has_exponent = fitness !== 0 && (size >= 1e7 || Math.abs(rounded) < 1e-4);
  const text = has_exponent ? rounded.toExponential().replace(/e([+-])(\d)$/, "e$10$2") : String(rounded);
  return /[.e]/.test(text) ? text : `${text}.0`;
}

/** Rounds to significant digits, and ties to even as printf does; toPrecision rounds ties away from zero. */
function rounded_to_even(number: number, digits: number): number {
  const [mantissa, exponent] = Math.abs(number).toExponential(40).split("e"), all = mantissa!.replace(".", "");
  const kept = Number(all.slice(0, digits)), rest = all.slice(digits);
  const up = rest[0]! >= "5" && (kept % 2 === 1 || !/^50*$/.test(rest));
  return Math.sign(number) * Number(`${kept + Number(up)}e${Number(exponent) - digits + 1}`);
}

export function with_unit(number: number, unit: string): string {
  return shown_number(number) + (unit ? " " : "") + unit;
}

export function with_sign(number: number): string {
  return (number >= 0 ? "+" : "") + three_digits(number);
}

export function tenths(number: number): string {
  return separated(number.toFixed(1));
}

/** "12.3 s", "4:05 min", "2:00:00 h". */
export function duration(seconds: number): string {
  if (!(seconds >= 60 && seconds < 1e15)) {
    return localised(seconds.toFixed(1)) + " s";
  }
  const whole = Math.round(seconds);
  const two = (value: number): string => String(value).padStart(2, "0");
  return whole < 3600 ? `${Math.floor(whole / 60)}:${two(whole % 60)} min` :
                        `${Math.floor(whole / 3600)}:${two(Math.floor(whole / 60) % 60)}:${two(whole % 60)} h`;
}

/** Reads a whole number from a field. Returns the number, or a sentence that says what is allowed. */
export function number_in(field: string, text: string, least: number, most: number): number|string {
  const number = /^\d+$/.test(text.trim()) ? Number(text) : NaN;
  return number >= least && number <= most ?
    number :
    `${field}: got "${text}", allowed whole numbers from ${with_separators(least)} to ${with_separators(most)}`;
}

/** At most this many significant digits, without separators or trailing zeros: "0.15", "1e-7", "1250". */
export function rounded(number: number, digits = 10): string {
  return localised(String(Number(number.toPrecision(digits))));
}

/** Returns the smallest of 1, 2 or 5 times a power of ten that is at least `least`. */
export function nice_step(least: number): number {
  if (!(least > 0)) {
    return 1;
  }
  const ten = Math.pow(10, Math.floor(Math.log10(least) + 1e-9));
  for (const factor of [1, 2, 5]) {
    if (least <= factor * ten * (1 + 1e-9)) {
      return factor * ten;
    }
  }
  return 10 * ten;
}

/** The text with a capital letter at its beginning. */
export function capitalised(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}
