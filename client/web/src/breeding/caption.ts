// Captions: the sentence that explains the moment that the glass box shows. No DOM.
import type {Contender} from "../core/protocol";
import {breeding_texts} from "../texts/breeding";
import {brings_back} from "./inheritance";
import {type BreedingRecord, rank_of, slot_of} from "./record";
import type {Moment} from "./stepper";

function organism_text(record: BreedingRecord, organism: number): string {
  const contender = record.contenders[organism];
  return contender ? breeding_texts.contender(
                       organism, rank_of(contender), contender.fitness ?? 0, contender.own_fitness ?? null,
                       contender.migrant ? contender.migrant.island ?? 0 : null) :
                     breeding_texts.unknown_contender(organism);
}

function picking_caption(record: BreedingRecord, index: number): string {
  const text = breeding_texts.pick(index, record.head?.pick_count ?? 0), pick = record.picks[index];
  if (!pick) {
    return text + breeding_texts.pick_loading;
  }
  const winner = organism_text(record, pick.organism ?? 0);
  if (pick.turns !== undefined) {
    const contender = record.contenders[pick.organism ?? 0];
    return text + breeding_texts.by_pointer(winner, contender ? slot_of(contender) : null);
  }
  if (pick.tournament !== undefined) {
    const contestants = pick.contestants?.length ?? 0;
    return text +
      (contestants === 0 ? breeding_texts.by_unseen_tournament(pick.tournament, winner) :
                           breeding_texts.by_tournament(pick.tournament, contestants, winner));
  }
  return text + breeding_texts.by_chance(winner);
}

function breeding_caption(record: BreedingRecord, id: number): string {
  const text = breeding_texts.descendant(id), descendant = record.descendants[id];
  if (!descendant) {
    return text + breeding_texts.descendant_loading;
  }
  const first = descendant.first_parent ?? 0, mutations = descendant.mutations ?? [];
  switch (descendant.kind) {
    case "DESCENDANT_KIND_ELITE":
      return text + breeding_texts.elite(organism_text(record, first));
    case "DESCENDANT_KIND_SURVIVOR":
      return text +
        breeding_texts.survivor(
          organism_text(record, first), mutations.length > 0 || descendant.order_mutation !== undefined);
    default:
      return text +
        breeding_texts.child(
          first, descendant.second_parent ?? 0, descendant.second_share ?? 0, descendant.crossed === true) +
        (descendant.order_mutation ? breeding_texts.reordered(descendant.order_mutation.method ?? "") : "") +
        breeding_texts.mutations(mutations.filter((mutation) => !brings_back(mutation.kind)).length);
  }
}

/** The law of the selection method: "Roulette wheel: … An organism with twice the weight is picked twice as often on
 *  average." */
export function selection_law_text(record: BreedingRecord): string {
  const scaling = record.choice("fitness_scaling");
  const any_negative = record.contenders.some((contender) => (contender.fitness ?? 0) < 0);
  const weight = scaling === "none" && !any_negative ? breeding_texts.weight_is_fitness :
    scaling === "none" || scaling === "windowing"    ? breeding_texts.weight_is_difference :
                                                       breeding_texts.weight_is_of_rank;
  switch (record.choice("selection")) {
    case "tournament":
      return breeding_texts.law_tournament(
        record.number("tournament_size") ?? 0, record.number("tournament_winners") ?? 1);
    case "random":
      return breeding_texts.law_random;
    case "truncation":
      return breeding_texts.law_truncation;
    case "stochastic_universal":
      return breeding_texts.law_stochastic_universal + weight;
    default:
      return breeding_texts.law_roulette + weight;
  }
}

/** "Roulette with windowing · hybrid · 50 organisms, 25 picks: 25 survivors and 25 children" */
export function breeding_summary(record: BreedingRecord): string {
  const head = record.head;
  if (!head) {
    return "";
  }
  const method = record.choice("selection"), scaling = record.choice("fitness_scaling");
  const has_wheel = method === "roulette" || method === "stochastic_universal";
  return breeding_texts.summary({
    method,
    tournament_size: method === "tournament" ? record.number("tournament_size") ?? 0 : null,
    scaling: has_wheel && scaling !== "none" ? scaling : "",
    population_model: record.choice("population_model"),
    organisms: head.contender_count ?? 0,
    picks: head.pick_count ?? 0,
    survivors: record.survivor_count,
    elite: record.elite_count,
    children: (head.descendant_count ?? 0) - record.survivor_count,
    shuffled: record.number("shuffle_fitness") === 1,
  });
}

export function caption(record: BreedingRecord, moment: Moment): string {
  switch (moment.stage) {
    case "scaling":
      return selection_law_text(record);
    case "picking":
      return picking_caption(record, moment.index);
    case "breeding":
      return breeding_caption(record, moment.index);
    case "done":
      return breeding_texts.done(record.survivor_count, (record.head?.descendant_count ?? 0) - record.survivor_count);
  }
}

/** What is known about an organism at the time of selection.
 *
 *  complete  all picks are shown; otherwise the number of its picks is left out */
export function contender_text(organism: number, contender: Contender, complete: boolean): string {
  return breeding_texts.contender_note(organism, {
    rank: rank_of(contender),
    fitness: contender.fitness ?? 0,
    weight: contender.weight ?? 0,
    slot: slot_of(contender),
    expected: contender.expected_copies ?? 0,
    observed: complete ? contender.copies ?? 0 : null,
    migrant: contender.migrant,
  });
}
