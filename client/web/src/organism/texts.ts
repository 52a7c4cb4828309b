// Sentences about one organism: its fate, its next action, its parents, why they were picked, and its offspring. The
// words are in texts/organism. No DOM.
import {none_left} from "../core/messages";
import type {OrganismInfo} from "../core/protocol";
import {organism_texts as texts} from "../texts/organism";
import {age_of} from "./history";
import type {Child, OrganismHistory, Origin, Picks} from "./history";

export {gene_label, gene_number} from "../texts/genes";

export function fate_text(history: OrganismHistory): string {
  const {info} = history;
  if (!info) {
    return "";
  }
  const lived_s = age_of(info);
  if (info.alive) {
    return history.ended ?
      texts.alive_when_last_seen(lived_s, history.has_births) :
      texts.alive(lived_s, info.health ?? 0);
  }
  switch (info.cause_of_death) {
    case "CAUSE_OF_DEATH_REMOVED":
      return texts.removed(lived_s);
    case "CAUSE_OF_DEATH_POISONED":
      return texts.poisoned(lived_s);
    case "CAUSE_OF_DEATH_EATEN":
      return texts.eaten_by_predator(lived_s);
    case "CAUSE_OF_DEATH_OLD":
      return texts.old(lived_s);
    case "CAUSE_OF_DEATH_STARVED":
    case "CAUSE_OF_DEATH_UNSPECIFIED":
    case undefined:
      return texts.starved(lived_s);
    default:
      none_left(info.cause_of_death);
      return "";
  }
}

export function choice_text(info: OrganismInfo): string {
  const x_px = info.target_x_px ?? 0, y_px = info.target_y_px ?? 0;
  if (info.handling_s) {
    return texts.handles(info.handling_s);
  }
  switch (info.choice) {
    case "CHOICE_WANDER":
      return texts.wanders;
    case "CHOICE_SEEK":
      return info.species === "SPECIES_PREDATOR" ? texts.hunts(x_px, y_px) : texts.seeks(x_px, y_px);
    case "CHOICE_FLEE":
      return info.flees_predator ? texts.flees_predator(x_px, y_px) : texts.flees(x_px, y_px);
    case "CHOICE_STEER":
      return texts.steers;
    case "CHOICE_UNSPECIFIED":
    case undefined:
      return "";
    default:
      none_left(info.choice);
      return "";
  }
}

export function parents_text(info: OrganismInfo, origin: Origin): string {
  if (info.placed_tick !== undefined) {
    return texts.placed(info.placed_tick);
  }
  const [first, second] = info.parents ?? [];
  if (first === undefined) {
    return texts.founder;
  }
  const generation = (info.generation ?? 0) - 1;
  if (second !== undefined && first !== second) {
    return texts.parents(first, second, generation);
  }
  const why: {[from in Origin]:
                string} = {elite: texts.of_elite, survivor: texts.of_survivors, child: texts.both_parents, unknown: ""};
  return texts.one_parent(first, generation, why[origin]);
}

/** With births. */
export function birth_text({info, is_older}: OrganismHistory): string {
  const [first, second] = info?.parents ?? [];
  return info === null ? "" :
    is_older           ? texts.born_before :
    first === undefined ? (info.placed_tick === undefined ? texts.arrived : parents_text(info, "unknown")) :
    first === (second ?? first) ? texts.child_of_parent(first) :
                                  texts.child_of_parents(first, second!);
}

/** "Its parent 45 was picked 3 of 25 times, expected 1.71." */
export function picks_text(subject: string, {migrant, count, all, expected}: Picks): string {
  const whole = migrant ? texts.copy_of(subject, migrant.organism, migrant.island) : subject;
  return texts.picked(whole, count, all, expected);
}

/** "12 (with 45)", "7 (unchanged)", "9 (single parent)" */
export function child_text({id, other_parent, unchanged}: Child): string {
  return other_parent !== null ? texts.child_with(id, other_parent) :
    unchanged                  ? texts.child_unchanged(id) :
                                 texts.child_of_one(id);
}
