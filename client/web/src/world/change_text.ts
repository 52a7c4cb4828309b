// change_text: changes of parameters as text.
import type {AppliedChange, ParameterValue} from "../core/protocol";
import {rounded} from "../texts/numbers";
import {choice_labels, parameter_labels} from "../texts/registry";

/** Returns a ParameterValue as text: "0.15", "25", "true", "roulette"; "-" if there is none. */
export function change_value_text(value: ParameterValue|undefined): string {
  const choice = choice_labels[value?.choice ?? ""] ?? value?.choice;
  const one = value?.real ?? value?.count ?? value?.flag ?? choice;
  return one === undefined ? "-" : typeof one === "number" ? rounded(one) : String(one);
}

/** "food_health 20 → 30, poison_count 5 → 6": the values that an AppliedChange has changed. */
export function values_text(change: AppliedChange): string {
  return (change.values ?? [])
    .map(({name = "", before, after}) =>
      `${parameter_labels[name] ?? name} ${change_value_text(before)} → ${change_value_text(after)}`)
    .join(", ");
}
