// Texts about how a generation was bred: captions of the glass box, the law of the selection, and where the genes of an
// organism come from.
import type * as english from "../texts/breeding";

import {fitness_text, localised, three_digits, with_separators} from "./numbers";
import {choice_labels} from "./registry";

export const counted: typeof english.counted = (count, one, many) =>
  `${with_separators(count)} ${count === 1 ? one : many}`;

function capital(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

export const choice_text: typeof english.choice_text = (choice) => choice_labels[choice] ?? choice.replace(/_/g, " ");

export const gene_text: typeof english.gene_text = (value) =>
  localised(String(Number(value.toPrecision(4)))).replace("-", "−");

export const delta_text: typeof english.delta_text = (delta) => (delta < 0 ? "−" : "+") + gene_text(Math.abs(delta));

export const breeding_texts: typeof english.breeding_texts = {
  contender: (id, rank, fitness, own_fitness, from_island) =>
    `Organismus ${id} (Rang ${with_separators(rank + 1)}, Fitness ${fitness_text(fitness)}` +
    (own_fitness === null ? "" : ` durch Mischen zugeteilt, eigene Fitness ${fitness_text(own_fitness)}`) +
    (from_island === null ? "" : `, eingewandert von Insel ${from_island}`) + ")",
  unknown_contender: (id) => `Organismus ${id}`,

  pick: (pick, count) => `Ziehung ${with_separators(pick + 1)} von ${with_separators(count)}. `,
  pick_loading: "Wird geladen …",
  by_pointer: (winner, slot) => `Der Zeiger blieb im Feld von ${winner} stehen` +
    (slot === null ? "." : `, ${three_digits(100 * slot)} % des Rads.`),
  by_tournament: (tournament, contestants, winner) =>
    `Turnier ${with_separators(tournament + 1)} mit ${counted(contestants, "Teilnehmer", "Teilnehmern")}: ` +
    `${winner} hat gewonnen.`,
  by_unseen_tournament: (tournament, winner) =>
    `Turnier ${with_separators(tournament + 1)} ist zu groß, um es zu zeigen. ${capital(winner)} hat gewonnen.`,
  by_chance: (winner) => `${capital(winner)}.`,

  descendant: (id) => `Organismus ${with_separators(id)} der nächsten Generation: `,
  descendant_loading: "wird geladen …",
  elite: (parent) => `aus der Elite, ${parent}, unverändert übernommen.`,
  survivor: (parent, mutated) => `überlebt, ${parent}${mutated ? ", mutiert." : "."}`,
  child: (first, second, second_share, crossed) => `Kind der Organismen ${first} und ${second}` +
    (first === second ? ", zweimal derselbe Organismus" : "") +
    (second_share > 0 ? `, gemischt mit den Gewichten ${localised((1 - second_share).toFixed(3))} und ${
                          localised(second_share.toFixed(3))}` :
       crossed          ? "" :
                          ", ohne Rekombination"),
  reordered: (method) => `, Reihenfolge der Gene geändert (${choice_text(method)})`,
  mutations: (count) => count === 0 ? ", keine Mutation." : `, ${counted(count, "Mutation", "Mutationen")}.`,

  done: (survivors, children) => `Die nächste Generation: ${counted(survivors, "Überlebender", "Überlebende")} und ` +
    `${counted(children, "Kind", "Kinder")}. Ein Punkt markiert jeden Organismus, der gezogen wurde.`,

  law_tournament: (size, winners) =>
    `Turnier: ${three_digits(size)} Organismen werden zufällig ausgelost; ` +
    (winners > 1 ? `die ${three_digits(winners)} fittesten von ihnen werden gezogen.` :
                   "der fitteste von ihnen wird gezogen.") +
    " Je größer das Turnier, desto größer der Vorteil der fittesten.",
  law_random: "Zufall: Jeder Organismus hat bei jeder Ziehung dieselbe Chance. Die Fitness spielt keine Rolle.",
  law_truncation:
    "Kappungsselektion: Die besten Organismen werden der Reihe nach gezogen, dann wieder vom ersten an, bis alle " +
    "Ziehungen gemacht sind. Glück gibt es nicht.",
  law_stochastic_universal:
    "Universelle Stichprobe: Eine einzige Drehung stellt alle Zeiger in gleichen Abständen. Jeder Organismus wird " +
    "so oft gezogen wie erwartet, auf- oder abgerundet.",
  law_roulette:
    "Glücksrad: Das Rad wird für jede Ziehung gedreht. Ein Organismus mit doppeltem Gewicht wird im Mittel doppelt " +
    "so oft gezogen.",
  weight_is_fitness: " Das Gewicht ist die Fitness.",
  weight_is_difference: " Das Gewicht ist die Fitness minus die kleinste Fitness.",
  weight_is_of_rank: " Das Gewicht hängt nur vom Rang ab.",

  summary: (breeding) => capital(choice_text(breeding.method)) +
    (breeding.tournament_size !== null ? ` mit ${breeding.tournament_size}` :
       breeding.scaling !== ""         ? ` mit Skalierung: ${choice_text(breeding.scaling)}` :
                                         "") +
    ` · ${choice_text(breeding.population_model)} · ${counted(breeding.organisms, "Organismus", "Organismen")}, ` +
    `${counted(breeding.picks, "Ziehung", "Ziehungen")}: ${
      counted(breeding.survivors, "Überlebender", "Überlebende")}` +
    (breeding.elite > 0 ? ` (${with_separators(breeding.elite)} aus der Elite)` : "") +
    ` und ${counted(breeding.children, "Kind", "Kinder")}` +
    (breeding.shuffled ? " · Fitness unter den Organismen gemischt" : ""),

  contender_note: (id, {rank, fitness, weight, slot, expected, observed, migrant}) =>
    `Organismus ${id}: Rang ${with_separators(rank + 1)}, Fitness ${fitness_text(fitness)}` +
    (slot > 0 ? `, Gewicht ${three_digits(weight)}: ${three_digits(100 * slot)} % des Rads` : "") +
    `; erwartete Ziehungen ${three_digits(expected)}` +
    (observed === null ? "" : `, beobachtet ${with_separators(observed)}`) +
    (migrant ? `; kam von Insel ${migrant.island ?? 0}, dort Organismus ${migrant.organism ?? 0}` : ""),

  mutation: {
    MUTATION_KIND_UNSPECIFIED: "Mutation",
    MUTATION_KIND_CREEP: "kleiner Schritt",
    MUTATION_KIND_RESET: "neu ausgelost",
    MUTATION_KIND_SCALE: "multipliziert",
    MUTATION_KIND_BIT_FLIP: "Bit gekippt",
    MUTATION_KIND_CLAMP: "begrenzt",
    MUTATION_KIND_REFLECT: "gespiegelt",
    MUTATION_KIND_REDRAW: "erneut ausgelost",
  },
  gene_origin: (gene, value, parent, moved_from, changes) =>
    `${gene}: ${gene_text(value)}${parent === null ? ", Mittel beider Eltern" : ` von Elternteil ${parent}`}` +
    (moved_from === null ? "" : `, von Gen ${moved_from + 1} hierher`) +
    changes.map(({how, after}) => `, ${how} auf ${gene_text(after)}`).join(""),
  other_genes: (count, {first, second, blended, from_second, mutated}) => `${count} weitere Gene: ` +
    [
      blended ? `Mittel der Eltern ${first} und ${second}` : `${count - from_second} von Elternteil ${first}`,
      from_second > 0 ? `${from_second} von Elternteil ${second}` : "",
      mutated > 0 ? `${mutated} mutiert` : "",
    ].filter((part) => part !== "")
      .join(", "),
};
