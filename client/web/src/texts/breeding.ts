// Texts about how a generation was bred: captions of the glass box, the law of the selection, and where the genes of an
// organism come from.
import {fitness_text, three_digits, with_separators} from "./numbers";

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

/** Four significant digits: "119.6", "0.4231", "−0.07". */
export function gene_text(value: number): string {
  return String(Number(value.toPrecision(4))).replace("-", "−");
}

/** "+7.31", "−0.4" */
export function delta_text(delta: number): string {
  return (delta < 0 ? "−" : "+") + gene_text(Math.abs(delta));
}

export const breeding_texts = {
  /** "organism 17 (rank 3, fitness 182)". For users, the fittest has rank 1. */
  contender: (id: number, rank: number, fitness: number, own_fitness: number|null, from_island: number|null): string =>
    `organism ${id} (rank ${with_separators(rank + 1)}, fitness ${fitness_text(fitness)}` +
    (own_fitness === null ? "" : ` assigned by shuffling, own fitness ${fitness_text(own_fitness)}`) +
    (from_island === null ? "" : `, migrated from island ${from_island}`) + ")",
  unknown_contender: (id: number): string => `organism ${id}`,

  // ---- picks ----
  pick: (pick: number, count: number): string =>
    `Pick ${with_separators(pick + 1)} of ${with_separators(count)}. `,
  pick_loading: "Loading …",
  by_pointer: (winner: string, slot: number|null): string =>
    `The pointer stopped in the slot of ${winner}` +
    (slot === null ? "." : `, ${three_digits(100 * slot)} % of the wheel.`),
  by_tournament: (tournament: number, contestants: number, winner: string): string =>
    `Tournament ${with_separators(tournament + 1)} of ${counted(contestants, "contestant", "contestants")}: ` +
    `${winner} won.`,
  // Without contestants there were too many of them, or the server drew the winner directly.
  by_unseen_tournament: (tournament: number, winner: string): string =>
    `Tournament ${with_separators(tournament + 1)} is too large to show. ${capital(winner)} won.`,
  by_chance: (winner: string): string => `${capital(winner)}.`,

  // ---- descendants ----
  descendant: (id: number): string => `Organism ${with_separators(id)} of the next generation: `,
  descendant_loading: "loading …",
  elite: (parent: string): string => `of the elite, ${parent}, kept unchanged.`,
  survivor: (parent: string, mutated: boolean): string => `a survivor, ${parent}${mutated ? ", mutated." : "."}`,
  child: (first: number, second: number, second_share: number, crossed: boolean): string =>
    `a child of organisms ${first} and ${second}` + (first === second ? ", the same organism twice" : "") +
    (second_share > 0 ? `, blended with weights ${(1 - second_share).toFixed(3)} and ${second_share.toFixed(3)}` :
       crossed          ? "" :
                          ", not crossed"),
  reordered: (method: string): string => `, ${choice_text(method)} reordered genes`,
  mutations: (count: number): string =>
    count === 0 ? ", no mutation." : `, ${counted(count, "mutation", "mutations")}.`,

  done: (survivors: number, children: number): string =>
    `The next generation: ${counted(survivors, "survivor", "survivors")} and ` +
    `${counted(children, "child", "children")}. A dot marks each organism that was picked.`,

  // ---- the law of the selection ----
  law_tournament: (size: number, winners: number): string =>
    `Tournament: ${three_digits(size)} organisms are drawn at random, and the fittest ` +
    (winners > 1 ? `${three_digits(winners)} of them are picked.` : "of them is picked.") +
    " Larger tournaments favour the fittest more.",
  law_random: "Random: every organism has the same chance in every pick. Fitness does not matter.",
  law_truncation:
    "Truncation: the best organisms are picked in order of rank, then again from the first, until all picks are " +
    "made. There is no luck.",
  law_stochastic_universal:
    "Universal sampling: one spin sets all pointers at equal distances, so each organism is picked its expected " +
    "number of times, rounded up or down.",
  law_roulette:
    "Roulette wheel: the wheel is spun for each pick. An organism with twice the weight is picked twice as often on " +
    "average.",
  weight_is_fitness: " The weight is the fitness.",
  weight_is_difference: " The weight is the fitness minus the lowest fitness.",
  weight_is_of_rank: " The weight depends on the rank alone.",

  /** "Roulette with windowing · hybrid · 50 organisms, 25 picks: 25 survivors and 25 children" */
  summary: (breeding: {
    method: string;
    tournament_size: number|null; // null: no tournament
    scaling: string; // "": none, or no wheel
    population_model: string;
    organisms: number;
    picks: number;
    survivors: number;
    elite: number;
    children: number;
    shuffled: boolean;
  }): string => capital(choice_text(breeding.method)) +
    (breeding.tournament_size !== null ? ` of ${breeding.tournament_size}` :
       breeding.scaling !== ""         ? ` with ${choice_text(breeding.scaling)}` :
                                         "") +
    ` · ${choice_text(breeding.population_model)} · ${counted(breeding.organisms, "organism", "organisms")}, ` +
    `${counted(breeding.picks, "pick", "picks")}: ${counted(breeding.survivors, "survivor", "survivors")}` +
    (breeding.elite > 0 ? ` (${with_separators(breeding.elite)} of the elite)` : "") +
    ` and ${counted(breeding.children, "child", "children")}` +
    (breeding.shuffled ? " · fitness shuffled among organisms" : ""),

  /** What is known about an organism at the time of selection.
   *
   *  slot      its share of the wheel; 0: no wheel
   *  observed  the number of its picks; null: not all picks are shown */
  contender_note: (
    id: number, {rank, fitness, weight, slot, expected, observed, migrant}: {
      rank: number;
      fitness: number;
      weight: number;
      slot: number;
      expected: number;
      observed: number|null;
      migrant: {island?: number; organism?: number} | undefined;
    }): string => `organism ${id}: rank ${with_separators(rank + 1)}, fitness ${fitness_text(fitness)}` +
    (slot > 0 ? `, weight ${three_digits(weight)}: ${three_digits(100 * slot)} % of the wheel` : "") +
    `; expected picks ${three_digits(expected)}` +
    (observed === null ? "" : `, observed ${with_separators(observed)}`) +
    (migrant ? `; came from island ${migrant.island ?? 0}, organism ${migrant.organism ?? 0} there` : ""),

  // ---- genes ----
  mutation: {
    MUTATION_KIND_UNSPECIFIED: "mutation",
    MUTATION_KIND_CREEP: "creep",
    MUTATION_KIND_RESET: "reset",
    MUTATION_KIND_SCALE: "scale",
    MUTATION_KIND_BIT_FLIP: "bit flip",
    MUTATION_KIND_CLAMP: "clamped",
    MUTATION_KIND_REFLECT: "mirrored",
    MUTATION_KIND_REDRAW: "drawn afresh",
  },
  /** "hidden3<bias: 0.42 of parent 12, creep to 0.5"
   *
   *  parent      null: a mean of both parents
   *  moved_from  the index of the gene from which it moved; null: it did not */
  gene_origin: (
    gene: string, value: number, parent: number|null, moved_from: number|null,
    changes: readonly {how: string; after: number}[]): string =>
    `${gene}: ${gene_text(value)}${parent === null ? ", a mean of both parents" : ` of parent ${parent}`}` +
    (moved_from === null ? "" : `, moved from gene ${moved_from + 1}`) +
    changes.map(({how, after}) => `, ${how} to ${gene_text(after)}`).join(""),
  /** "66 other genes: 35 of parent 12, 31 of parent 45, 4 mutated" */
  other_genes: (
    count: number, {first, second, blended, from_second, mutated}:
      {first: number; second: number; blended: boolean; from_second: number; mutated: number}): string =>
    `${count} other genes: ` +
    [
      blended ? `means of parents ${first} and ${second}` : `${count - from_second} of parent ${first}`,
      from_second > 0 ? `${from_second} of parent ${second}` : "",
      mutated > 0 ? `${mutated} mutated` : "",
    ].filter((part) => part !== "")
      .join(", "),
};
