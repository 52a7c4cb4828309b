// Sentences about one organism: its fate, its next action, its parents, why they were picked, and its offspring. The
// words are those of evoview. No DOM.
import type {Message} from "../core/messages";
import {tenths, three_digits, with_separators} from "../texts/numbers";
import type {Child, OrganismHistory, Origin, Picks} from "./history";

export function fate_text(history: OrganismHistory): string {
  const info = history.info;
  if (!info) {
    return "";
  }
  const lived = `${tenths(info.lived_s ?? 0)} s`;
  if (!info.alive) {
    return info.cause_of_death === "CAUSE_OF_DEATH_REMOVED" ? `removed by a user after ${lived}` :
      info.cause_of_death === "CAUSE_OF_DEATH_POISONED" ? `died of poison after ${lived}` :
                                                          `died of hunger after ${lived}`;
  }
  return history.ended ? `alive when last seen after ${lived}; its generation has ended` :
                         `alive for ${lived}, health ${tenths(info.health ?? 0)}`;
}

export function choice_text(info: Message): string {
  const place = ` at (${with_separators(info.target_x_px ?? 0)}, ${with_separators(info.target_y_px ?? 0)})`;
  switch (info.choice) {
    case "CHOICE_WANDER":
      return "about to wander";
    case "CHOICE_SEEK":
      return "about to seek food" + place;
    case "CHOICE_FLEE":
      return "about to flee from poison" + place;
    case "CHOICE_STEER":
      return "steered by its network";
    default:
      return "";
  }
}

export function parents_text(info: Message, origin: Origin): string {
  if (info.placed_tick !== undefined) {
    return `No parents: placed by a user after tick ${with_separators(info.placed_tick)} of the generation`;
  }
  const parents: number[] = info.parents ?? [];
  if (parents.length === 0) {
    return "No parents: founder of generation 1, or loaded from a file";
  }
  const generation = with_separators(Number(info.generation) - 1);
  if (parents.length === 1 || parents[0] === parents[1]) {
    const why = origin === "elite" ? ": this organism belongs to the elite" :
      origin === "survivor"        ? ": this organism is a survivor" :
      origin === "child"           ? ", which was both parents" :
                                     "";
    return `One parent: ${parents[0]} (generation ${generation})${why}`;
  }
  return `Parents: ${parents[0]} and ${parents[1]} (generation ${generation})`;
}

/** "Its parent 45 was picked 3 of 25 times, expected 1.71." */
export function picks_text(subject: string, picks: Picks): string {
  const copy = picks.migrant ? ` (a copy of organism ${picks.migrant.organism} of island ${picks.migrant.island})` : "";
  return `${subject}${copy} was picked ${with_separators(picks.count)} of ${with_separators(picks.all)} ` +
    `${picks.all === 1 ? "time" : "times"}, ` +
    `expected ${three_digits(picks.expected)}.`;
}

/** "12 (with 45)", "7 (unchanged)", "9 (single parent)" */
export function child_text(child: Child): string {
  return child.id +
    (child.other_parent !== null ? ` (with ${child.other_parent})` :
       child.unchanged ? " (unchanged)" :
                         " (single parent)");
}

/** A gene's name for readers: "normal_speed" → "normal speed". */
export function gene_label(name: string): string {
  return name.replace(/_/g, " ");
}

/** "Range in this generation: 83.6 to 131.2, mean 104.9" */
export function range_text(range: {min: number; mean: number; max: number}): string {
  return `Range in this generation: ${gene_number(range.min)} to ${gene_number(range.max)}, mean ` +
    `${gene_number(range.mean)}`;
}

/** Genes of the body are about 100, weights and free genes about 1. */
export function gene_number(value: number): string {
  return Math.abs(value) >= 10 ? tenths(value) : value.toFixed(2).replace("-", "−");
}
