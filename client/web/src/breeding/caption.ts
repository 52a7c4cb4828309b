// Captions: sentences that explain the moment that the glass box shows. No DOM.
import type {Message} from "../core/messages";
import {three_digits, with_separators} from "../texts/numbers";
import {type BreedingRecord, rank_of, slot_of} from "./record";
import type {Moment} from "./stepper";

export function counted(count: number, one: string, many: string): string {
  return `${with_separators(count)} ${count === 1 ? one : many}`;
}

function capital(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** The value of a parameter with named choices, as text for users: "stochastic universal". */
export function choice_text(choice: string): string {
  return choice.replace(/_/g, " ");
}

/** "organism 17 (rank 3, fitness 182)". For users, the fittest has rank 1. */
function organism_text(record: BreedingRecord, organism: number): string {
  const contender = record.contenders[organism];
  if (!contender) {
    return `organism ${organism}`;
  }
  let text = `organism ${organism} (rank ${with_separators(rank_of(contender) + 1)}, fitness ` +
    `${three_digits(contender.fitness ?? 0)}`;
  if (contender.own_fitness !== undefined) {
    text += ` assigned by shuffling, own fitness ${three_digits(contender.own_fitness)}`;
  }
  if (contender.migrant) {
    text += `, migrated from island ${contender.migrant.island ?? 0}`;
  }
  return text + ")";
}

function picking_caption(record: BreedingRecord, index: number): string {
  const text = `Pick ${with_separators(index + 1)} of ${with_separators(record.head?.pick_count ?? 0)}. `;
  const pick = record.picks[index];
  if (!pick) {
    return text + "Loading …";
  }
  const winner = organism_text(record, pick.organism ?? 0);
  if (pick.turns !== undefined) {
    const contender = record.contenders[pick.organism ?? 0];
    return `${text}The pointer stopped in the slot of ${winner}` +
      (contender ? `, ${three_digits(100 * slot_of(contender))} % of the wheel.` : ".");
  }
  if (pick.tournament !== undefined) {
    const contestants: number[] = pick.contestants ?? [];
    const tournament = `${text}Tournament ${with_separators(pick.tournament + 1)}`;
    // Without contestants there were too many of them, or the server drew the winner directly.
    return contestants.length === 0 ?
      `${tournament} is too large to show. ${capital(winner)} won.` :
      `${tournament} of ${counted(contestants.length, "contestant", "contestants")}: ${winner} won.`;
  }
  return `${text}${capital(winner)}.`;
}

function breeding_caption(record: BreedingRecord, id: number): string {
  const text = `Organism ${with_separators(id)} of the next generation: `;
  const descendant = record.descendants[id];
  if (!descendant) {
    return text + "loading …";
  }
  const first = descendant.first_parent ?? 0, second = descendant.second_parent ?? 0;
  const mutations: Message[] = descendant.mutations ?? [];
  if (descendant.kind === "DESCENDANT_KIND_ELITE") {
    return `${text}of the elite, ${organism_text(record, first)}, kept unchanged.`;
  }
  if (descendant.kind === "DESCENDANT_KIND_SURVIVOR") {
    const end = mutations.length === 0 && !descendant.order_mutation ? "." : ", mutated.";
    return `${text}a survivor, ${organism_text(record, first)}${end}`;
  }
  const share = descendant.second_share ?? 0;
  const mutated = mutations.filter((mutation) => mutation.kind !== "MUTATION_KIND_CLAMP").length;
  return `${text}a child of organisms ${first} and ${second}` + (first === second ? ", the same organism twice" : "") +
    (share > 0 ? `, blended with weights ${(1 - share).toFixed(3)} and ${share.toFixed(3)}` :
       descendant.crossed ? "" :
                            ", not crossed") +
    (descendant.order_mutation ? `, ${choice_text(descendant.order_mutation.method ?? "")} reordered genes` : "") +
    (mutated === 0 ? ", no mutation." : `, ${counted(mutated, "mutation", "mutations")}.`);
}

/** The law of the selection method: "Roulette wheel: … An organism with twice the weight is picked twice as often on
 *  average." */
export function selection_law_text(record: BreedingRecord): string {
  const method = record.choice("selection"), scaling = record.choice("fitness_scaling");
  if (method === "tournament") {
    const size = record.number("tournament_size") ?? 0, winners = record.number("tournament_winners") ?? 1;
    return `Tournament: ${three_digits(size)} organisms are drawn at random, and the fittest ` +
      (winners > 1 ? `${three_digits(winners)} of them are picked.` : "of them is picked.") +
      " Larger tournaments favour the fittest more.";
  }
  if (method === "random") {
    return "Random: every organism has the same chance in every pick. Fitness does not matter.";
  }
  if (method === "truncation") {
    return "Truncation: the best organisms are picked in order of rank, then again from the first, until all picks " +
      "are made. There is no luck.";
  }
  const law = method === "stochastic_universal" ?
    "Universal sampling: one spin sets all pointers at equal distances, so each organism is picked its expected " +
      "number of times, rounded up or down." :
    "Roulette wheel: the wheel is spun for each pick. An organism with twice the weight is picked twice as often " +
      "on average.";
  const any_negative = record.contenders.some((contender) => (contender.fitness ?? 0) < 0);
  return law +
    (scaling === "none" && !any_negative             ? " The weight is the fitness." :
       scaling === "none" || scaling === "windowing" ? " The weight is the fitness minus the lowest fitness." :
                                                       " The weight depends on the rank alone.");
}

/** "Roulette with windowing · hybrid · 50 organisms, 25 picks: 25 survivors and 25 children" */
export function breeding_summary(record: BreedingRecord): string {
  const head = record.head;
  if (!head) {
    return "";
  }
  const method = record.choice("selection"), scaling = record.choice("fitness_scaling");
  const wheel = method === "roulette" || method === "stochastic_universal";
  return capital(choice_text(method)) +
    (method === "tournament" ? ` of ${record.number("tournament_size") ?? 0}` :
       wheel && scaling !== "none" ? ` with ${choice_text(scaling)}` :
                                     "") +
    ` · ${choice_text(record.choice("population_model"))} · ` +
    `${counted(head.contender_count ?? 0, "organism", "organisms")}, ` +
    `${counted(head.pick_count ?? 0, "pick", "picks")}: ${counted(record.survivor_count, "survivor", "survivors")}` +
    (record.elite_count > 0 ? ` (${with_separators(record.elite_count)} of the elite)` : "") +
    ` and ${counted((head.descendant_count ?? 0) - record.survivor_count, "child", "children")}` +
    (record.number("shuffle_fitness") === 1 ? " · fitness shuffled among organisms" : "");
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
      return `The next generation: ${counted(record.survivor_count, "survivor", "survivors")} and ` +
        `${counted((record.head?.descendant_count ?? 0) - record.survivor_count, "child", "children")}. A dot marks ` +
        "each organism that was picked.";
  }
}

/** What is known about an organism at the time of selection.
 *
 *  complete  all picks are shown; otherwise the number of its picks is left out */
export function contender_text(organism: number, contender: Message, complete: boolean): string {
  const slot = slot_of(contender);
  return `organism ${organism}: rank ${with_separators(rank_of(contender) + 1)}, fitness ` +
    `${three_digits(contender.fitness ?? 0)}` +
    (slot > 0 ? `, weight ${three_digits(contender.weight ?? 0)}: ${three_digits(100 * slot)} % of the wheel` : "") +
    `; expected picks ${three_digits(contender.expected_copies ?? 0)}` +
    (complete ? `, observed ${with_separators(contender.copies ?? 0)}` : "") +
    (contender.migrant ?
       `; came from island ${contender.migrant.island ?? 0}, organism ${contender.migrant.organism ?? 0} there` :
       "");
}
