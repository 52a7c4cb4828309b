// parameters: the registry of the server: groups of parameters, search, and names for people. Pure functions.
import type {ParameterDescription} from "../core/protocol";
import {parameter_words} from "../texts/parameter_words";
import {
  choice_helps, choice_labels, parameter_helps, parameter_labels, topic_titles, unit_words,
  unit_words_of_one} from "../texts/registry";

const unit_length_max = 10; // longer units do not fit next to a field

export interface ParameterGroup {
  title: string;
  members: number[]; // indices in the registry
}

/** Returns the registry with the texts of the language of the page. A text that this language lacks stays English. */
export function in_language(registry: readonly ParameterDescription[]): ParameterDescription[] {
  return registry.map((about) => {
    const {name = "", topic = "", help = "", unit = "", choices = [], choice_help = []} = about;
    const choices_of = name.replace(/^predator_/, "");
    return {
      ...about,
      topic: topic_titles[topic.toLowerCase().replace(/ /g, "_")] ?? topic,
      help: parameter_helps[name] ?? help,
      unit: unit_words[unit] ?? unit,
      choice_help: choice_help.map((text, n) => choice_helps[`${choices_of} ${choices[n]}`] ?? text),
    };
  });
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
    about.name ?? "", label_of(about), about.unit ?? "", about.help ?? "", group, ...(about.choices ?? []),
    ...(about.choices ?? []).map(label_of_choice), ...(about.choice_help ?? [])
  ].join(" "));
  return plain(search).split(" ").every((word) => all.includes(word));
}

/** Returns the name for people, without the unit at its end: "Mutation chance", "Tick" for tick_s. */
export function label_of(about: ParameterDescription): string {
  let name = about.name ?? "";
  const known = parameter_labels[name];
  if (known !== undefined) {
    return known;
  }
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
  return choice_labels[choice] ?? plain(choice);
}

/** Returns the unit after a number: "px", "island" after 1, "islands" after 2. Empty if there is none, or if it is
 * too long. */
export function unit_text(about: ParameterDescription, number: number): string {
  const unit = about.unit ?? "";
  const is_one = about.kind === "PARAMETER_KIND_COUNT" && number === 1;
  const text = is_one ? unit_words_of_one[unit] ?? (unit.endsWith("s") ? unit.slice(0, -1) : unit) : unit;
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
    return (about.choices ?? []).map((choice) => choice_labels[choice] ?? choice).join(", ");
  }
  return parameter_words.range(about.min ?? 0, about.max ?? 0);
}
