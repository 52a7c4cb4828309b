// parameter_values: values of parameters as texts and numbers. Pure functions.
import type {ParameterDescription, ParameterSet, ParameterValue} from "../core/protocol";
import {rounded, with_separators} from "../texts/numbers";
import {parameter_words} from "../texts/parameter_words";
import {choice_labels} from "../texts/registry";

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
  const {flag, choice = ""} = value;
  return flag !== undefined ? (flag ? parameter_words.on : parameter_words.off) : choice_labels[choice] ?? choice;
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
 *  commas or points may separate thousands, as value_text() prints them. */
export function typed_number(about: ParameterDescription, text: string): number|null {
  const clean = text.trim().replace("−", "-");
  if (about.kind === "PARAMETER_KIND_COUNT") {
    const number = /^(\d+|\d{1,3}([,.]\d{3})+)$/.test(clean) ? Number(clean.replace(/[,.]/g, "")) : NaN;
    return number <= 0xffffffff ? number : null;
  }
  const number = /^[+-]?(\d+[.,]?\d*|[.,]\d+)(e[+-]?\d+)?$/i.test(clean) ? Number(clean.replace(",", ".")) : NaN;
  return Number.isFinite(number) ? number : null;
}

/** The value of a parameter that is in effect; undefined if the set does not contain it. */
export function value_in_effect(set: ParameterSet|null, name: string): ParameterValue|undefined {
  return set?.parameters?.find((parameter) => parameter.name === name)?.value;
}
