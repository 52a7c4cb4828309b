// parameters: the registry of the server: groups of parameters, search, and names for people. Pure functions.
import type {ParameterDescription} from "../core/protocol";
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

/** Returns the unit after a number: "px", "island" after 1, "islands" after 2. Empty if there is none, or if it is
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
