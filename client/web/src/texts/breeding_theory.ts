// Texts about the theory of selection, the bets on picks, and why the means of genes changed.
import {three_digits, with_separators, with_sign} from "./numbers";

const sources = {
  baker: "Baker 1987",
  goldberg_deb: "Goldberg & Deb 1991",
  blickle_thiele: "Blickle & Thiele 1996",
  motoki: "Motoki 2002",
  pearson_haldane: "Pearson 1900; Haldane 1937",
};

function signed(number: number): string {
  return number === 0 ? "0" : with_sign(number);
}

export const theory_texts = {
  sources,
  unit_deviations: "deviations",
  unit_generations: "generations",
  fittest: "Copies of the fittest",
  fittest_sentence: "How often the organism with the best fitness is picked.",
  intensity: "Selection intensity",
  intensity_sentence:
    "By how many standard deviations the mean fitness of the picked organisms exceeds the mean fitness of all " +
    "organisms.",
  normal_intensity: "Intensity, normal fitness",
  normal_intensity_sentence:
    "The selection intensity if the fitness had a normal distribution: it would depend only on the ranks.",
  unpicked: "Share not selected",
  unpicked_sentence: "The share of organisms that are never picked; genes that only these organisms had are lost.",
  diversity: "Loss of diversity",
  diversity_sentence:
    "The share of the population that copies of fitter organisms replace if every organism has its expected number " +
    "of copies: the least possible loss.",
  takeover: "Takeover time",
  takeover_sentence:
    "Generations of selection alone, without mutation and crossover, until copies of the fittest fill all places " +
    "but one.",
  takeover_overlapping:
    "Generations until copies of the fittest fill all places but one; not predicted if most of a generation " +
    "survives.",
  takeover_of_fitness:
    "Generations until copies of the fittest fill all places but one; not predicted if each generation subtracts its " +
    "lowest fitness, or if all fitness values are equal.",
  takeover_never:
    "Generations until copies of the fittest fill all places but one: never, because every organism has the same " +
    "chance.",
  agreement: "Agreement of all copies",
  agreement_sentence:
    "Squared differences between observed and expected copies, each divided by the expected copies (chi-square per " +
    "organism): about 1 if the law holds.",
};

export const bet_texts = {
  /** "4 of 25 picks hit your 5 bets. Random bets: 2.5 expected." */
  hits: (hits: number, picks: number, bets: number, random: number): string =>
    `${with_separators(hits)} of ${with_separators(picks)} ${picks === 1 ? "pick" : "picks"} hit your ${bets} ` +
    `${bets === 1 ? "bet" : "bets"}. Random bets: ${three_digits(random)} expected.`,
  /** ratio  hits compared with random bets; null: random bets hit nothing */
  result: (law: number, most: number, ratio: number|null): string =>
    ` Your bets: ${three_digits(law)} expected by the law of the selection. The best possible bets: ` +
    `${with_separators(most)}.` + (ratio === null ? "" : ` Score: ${three_digits(ratio)} times random betting.`),
};

export const account_texts = {
  unnamed_gene: (gene: number): string => `gene ${gene}`,
  /** "The mean of normal speed rose by 0.3: selection +0.4, transmission −0.1, migration 0." */
  change: ({name, change, selection, transmission, migration}:
             {name: string; change: number; selection: number; transmission: number; migration: number}): string =>
    `The mean of ${name} ${
      change > 0   ? "rose by " :
        change < 0 ? "fell by " :
                     "did not change"}` +
    (change === 0 ? "" : with_sign(Math.abs(change)).slice(1)) +
    `: selection ${signed(selection)}, transmission ${signed(transmission)}, migration ${signed(migration)}.`,
  // The largest part as a sentence for pupils.
  by_selection: (more: boolean): string => `Organisms with ${more ? "more" : "less"} of it had more descendants.`,
  by_transmission: (more: boolean): string =>
    `Crossover and mutation gave the descendants ${more ? "more" : "less"} of it than their parents had.`,
  by_migration: (more: boolean): string => `The migrants had ${more ? "more" : "less"} of it.`,
};
