// organism: the panel "Organism".
import {gene_label, gene_number} from "./genes";
import {duration, tenths, three_digits, with_separators} from "./numbers";

export const organism_texts = {
  title: "Organism",
  loading: "Loading …",

  choose: "Click an organism to inspect it: its genes, its parents and why they were picked.",
  healthiest: "The healthiest organisms now",
  offer: (id: number, health: number) => `Organism ${id}, health ${three_digits(health)}`,
  none_alive: "No organism is alive.",
  waiting: "Waiting for the first snapshot …",

  heading: (id: number, generation: number) => `Organism ${id} of generation ${with_separators(generation)}`,
  predator: (id: number, generation: number) => `Predator ${id} of generation ${with_separators(generation)}`,
  /** With births: an organism has one number in its whole life. */
  numbered: (number: number, is_predator: boolean) =>
    `${is_predator ? "Predator" : "Organism"} number ${with_separators(number)}`,
  back: "Back to live",
  back_help: "Returns to the live world.",
  deselect: "Deselect",
  family: "Family tree",
  follow: "keep it centred",
  eaten: (food: number, poison: number) => `eaten: ${with_separators(food)} food, ${with_separators(poison)} poison`,
  eaten_prey: (count: number) => `eaten: ${with_separators(count)} prey`,
  children: (count: number) => `children: ${with_separators(count)}`,
  body: (radius_px: number, mass_kg: number) => `radius ${tenths(radius_px)} px, mass ${mass_kg.toFixed(2)} kg`,

  alive: (lived_s: number, health: number) => `alive for ${tenths(lived_s)} s, health ${tenths(health)}`,
  alive_when_last_seen: (lived_s: number, births: boolean) =>
    `alive when last seen after ${tenths(lived_s)} s; ${births ? "the interval" : "its generation"} has ended`,
  starved: (lived_s: number) => `died of hunger after ${tenths(lived_s)} s`,
  poisoned: (lived_s: number) => `died of poison after ${tenths(lived_s)} s`,
  eaten_by_predator: (lived_s: number) => `eaten by a predator after ${tenths(lived_s)} s`,
  old: (lived_s: number) => `died of old age after ${tenths(lived_s)} s`,
  removed: (lived_s: number) => `removed by a user after ${tenths(lived_s)} s`,
  wanders: "about to wander",
  seeks: (x_px: number, y_px: number) => `about to seek food at ${place(x_px, y_px)}`,
  flees: (x_px: number, y_px: number) => `about to flee from poison at ${place(x_px, y_px)}`,
  flees_predator: (x_px: number, y_px: number) => `about to flee from the predator at ${place(x_px, y_px)}`,
  hunts: (x_px: number, y_px: number) => `about to hunt prey at ${place(x_px, y_px)}`,
  handles: (seconds: number) => `handles its prey for another ${tenths(seconds)} s`,
  steers: "steered by its network",

  why: "Why it exists",
  placed: (tick: number) => `No parents: placed by a user after tick ${with_separators(tick)} of the generation`,
  founder: "No parents: founder of generation 1, or loaded from a file",
  one_parent: (parent: number, generation: number, why: string) =>
    `One parent: ${parent} (generation ${with_separators(generation)})${why}`,
  of_elite: ": this organism belongs to the elite",
  of_survivors: ": this organism is a survivor",
  both_parents: ", which was both parents",
  parents: (first: number, second: number, generation: number) =>
    `Parents: ${first} and ${second} (generation ${with_separators(generation)})`,
  arrived: "No parents: it came at the beginning of this interval",
  born_before: "It was born before this interval",
  child_of_parent: (parent: number) => `Child of organism ${parent} of this interval`,
  child_of_parents: (first: number, second: number) => `Child of organisms ${first} and ${second} of this interval`,
  go_to_parent: (parent: number) => `Go to parent ${parent}`,
  go_to_parent_help: "Shows the parent alive, in a replay of its generation.",
  why_parent: (parent: number) => `Why ${parent}?`,
  why_parent_help: "Opens the glass box at the first pick of this parent.",
  its_parent: (parent: number) => `Its parent ${parent}`,
  it: "It",
  copy_of: (subject: string, organism: number, island: number) =>
    `${subject} (a copy of organism ${organism} of island ${island})`,
  picked: (subject: string, count: number, all: number, expected: number) =>
    `${subject} was picked ${with_separators(count)} of ${with_separators(all)} ${
      all === 1 ? "time" : "times"}, expected ${three_digits(expected)}.`,
  show_picks: "Show its picks",
  show_picks_help: "Opens the glass box at its first pick.",
  not_bred: "Its generation has not bred yet.",
  no_picks: "Its picks are unknown.",
  picks_problem: (why: string) => `The picks are unknown: ${why}.`,

  health_axis: (most: number) => `Health, axis from 0 to ${three_digits(most)}`,
  health_curve: (first: number, last: number) =>
    `Health since you selected it: from ${tenths(first)} to ${tenths(last)}`,
  health_unknown: "Health: unknown",
  selected: "since you selected it",
  selected_ago: (seconds: number) => `since you selected it, ${duration(seconds)} ago`,

  network: "Network",
  genes: "Genes",
  genes_hint: "Bar: from the least to the greatest value in this generation. Line: the mean.",
  gene_range: (min: number, max: number, mean: number) =>
    `Range in this generation: ${gene_number(min)} to ${gene_number(max)}, mean ${gene_number(mean)}`,
  gene_of_range: (value: number, range: string) => `${gene_number(value)}. ${range}`,
  free_genes: (count: number) => `${with_separators(count)} free genes, without effect in the simulation`,
  free_gene: (name: string, value: number) => `${gene_label(name)} ${gene_number(value)}`,

  offspring: "Offspring",
  offspring_in: (generation: number, count: number) =>
    `Offspring in generation ${with_separators(generation)}: ${with_separators(count)}`,
  offspring_later: "Offspring appear when the next generation starts.",
  offspring_too_many: "Offspring unknown: the next generation is too large to search it.",
  no_offspring: "none",
  child_with: (id: number, other: number) => `${id} (with ${other})`,
  child_unchanged: (id: number) => `${id} (unchanged)`,
  child_of_one: (id: number) => `${id} (single parent)`,
  child_help: (id: number, generation: number) => `Shows organism ${id} of generation ${generation}.`,
  more: (count: number) => `and ${with_separators(count)} more`,
};

function place(x_px: number, y_px: number): string {
  return `(${with_separators(x_px)}, ${with_separators(y_px)})`;
}
