// change_text: changes of parameters as text, and as marks in plots over generations.
import type { Message } from "../messages";
import type { Mark } from "./plot_layout";
import { rounded } from "./numbers";
import { actor_text } from "./texts";

/** Returns a ParameterValue as text: "0.15", "25", "true", "roulette"; "-" if there is none. */
export function change_value_text(value: Message | undefined): string {
  const one = value?.real ?? value?.count ?? value?.flag ?? value?.choice;
  return one === undefined ? "-" : typeof one === "number" ? rounded(one) : String(one);
}

function values_text(change: Message): string {
  return (change.values as Message[] | undefined ?? [])
    .map((value) => `${value.name} ${change_value_text(value.before)} → ${change_value_text(value.after)}`).join(", ");
}

/** Returns the marks of AppliedChange messages in a plot over generations. */
export function marks_of(changes: readonly Message[]): (Mark & { label: string })[] {
  return changes.map((change) => ({
    x: Number(change.generation ?? 0),
    text: `generation ${change.generation ?? 0}: ${values_text(change)} by ${actor_text(change.by)}`,
    label: values_text(change),
  }));
}
