// Theory: the numbers that the theory of selection predicts for one breeding, next to the observed numbers. They are
// derived from the expected copies, which the server computes from the law of the selection method. Ranks count from 0,
// the fittest. No DOM.
//
// Source  Blickle & Thiele 1996, "A comparison of selection schemes used in evolutionary algorithms", Evol. Comput.
//         4(4)
//         Goldberg & Deb 1991, "A comparative analysis of selection schemes used in genetic algorithms"
//         Motoki 2002, "Calculating the expected loss of diversity of selection schemes", Evol. Comput. 10(4)
import {theory_texts} from "../texts/breeding_theory";
import {type Comparison, deviation} from "./comparison";
import type {BreedingRecord} from "./record";

/** The properties of a selection that decide which predictions are possible. */
export interface Selection {
  method: "roulette"|"stochastic_universal"|"tournament"|"random"|"truncation";
  pressure: "fitness"|"windowed_fitness"|"rank"; // what decides the chance of an organism
  independent_picks: boolean; // a pick does not change the chances in other picks
  overlapping: boolean; // steady_state, nsga2: most organisms survive into the next generation
  picks: number;
}

/** A number that theory predicts, with the observed number. */
export interface Prediction {
  name: string;
  sentence: string;
  source: string;
  unit: string; // "": dimensionless
  expected: number|null; // null: never, or no theory predicts it; see `sentence`
  observed: number|null; // null: cannot be observed in one breeding
  standard_error: number|null; // of the observed number; null: unknown
}

export function selection_of(record: BreedingRecord): Selection {
  const methods = ["roulette", "stochastic_universal", "tournament", "random", "truncation"] as const;
  const method = methods.find((name) => name === record.choice("selection")) ?? "roulette";
  const scaling = record.choice("fitness_scaling"), picks = record.head?.pick_count ?? 0;
  const wheel = method === "roulette" || method === "stochastic_universal";
  return {
    method,
    picks,
    pressure: !wheel || scaling === "linear_ranking" || scaling === "exponential_ranking" ? "rank" :
      scaling === "windowing"                                                             ? "windowed_fitness" :
                                                                                            "fitness",
    independent_picks: method === "roulette" ||
      (method === "tournament" && Math.min(record.number("tournament_winners") ?? 1, picks) === 1),
    overlapping: ["steady_state", "nsga2"].includes(record.choice("population_model") ?? ""),
  };
}

/** (observed − expected) / standard error; null if one of the three is unknown. */
export function deviation_of(prediction: Prediction): number|null {
  const {observed, expected, standard_error} = prediction;
  return observed === null || expected === null || standard_error === null ?
    null :
    deviation(observed, expected, standard_error);
}

function sum(numbers: readonly number[]): number {
  return numbers.reduce((total, number) => total + number, 0);
}

/** (fitness − mean) / standard deviation for each organism; all 0 if all fitness values are equal. */
export function standard_scores(fitness: readonly number[]): number[] {
  const mean = sum(fitness) / fitness.length;
  const square = sum(fitness.map((value) => (value - mean) ** 2)) / fitness.length;
  return fitness.map((value) => square > 0 && Number.isFinite(square) ? (value - mean) / Math.sqrt(square) : 0);
}

/** The value that a standard normal variable exceeds with the probability `above`, 0 to 1, both excluded. Its relative
 *  error is less than 1.2e-9. Source: P. J. Acklam 2003, "An algorithm for computing the inverse normal cumulative
 *  distribution function". */
export function upper_normal_quantile(above: number): number {
  if (above > 0.5) {
    return -upper_normal_quantile(1 - above);
  }
  const polynomial = (x: number, coefficients: readonly number[]): number =>
    coefficients.reduce((value, coefficient) => value * x + coefficient, 0);
  if (above < 0.02425) {
    const q = Math.sqrt(-2 * Math.log(above));
    return -polynomial(
             q,
             [
               -7.784894002430293e-3, -3.223964580411365e-1, -2.400758277161838, -2.549732539343734, 4.374664141464968,
               2.938163982698783
             ]) /
      polynomial(q, [7.784695709041462e-3, 3.224671290700398e-1, 2.445134137142996, 3.754408661907416, 1]);
  }
  const q = 0.5 - above, r = q * q;
  return q *
    polynomial(
           r,
           [
             -3.969683028665376e1, 2.209460984245205e2, -2.759285104469687e2, 1.38357751867269e2, -3.066479806614716e1,
             2.506628277459239
           ]) /
    polynomial(r, [
           -5.447609879822406e1, 1.615858368580409e2, -1.556989798598866e2, 6.680131188771972e1, -1.328068155288572e1, 1
         ]);
}

/** Divides the normal distribution into as many intervals of equal probability as there are ranks. Returns the mean
 *  within each interval, for the best rank first. The sum is 0. */
export function normal_scores(population: number): number[] {
  const density_above = (ranks: number): number => ranks === 0 || ranks === population ?
    0 :
    Math.exp(-(upper_normal_quantile(ranks / population) ** 2) / 2) / Math.sqrt(2 * Math.PI);
  return Array.from({length: population}, (_, rank) => population * (density_above(rank + 1) - density_above(rank)));
}

/** The mean of the scores, weighted by the copies. */
export function weighted_mean(copies: readonly number[], scores: readonly number[]): number {
  const all = sum(copies);
  return all > 0 ? sum(copies.map((number, rank) => number * scores[rank]!)) / all : 0;
}

/** The share of the population that copies of fitter organisms replace if every number of copies equals its
 *  expectation. */
export function loss_of_diversity(copies: readonly number[]): number {
  const all = sum(copies), each = 1 / copies.length;
  return all > 0 ? sum(copies.map((number) => Math.max(each - number / all, 0))) : 0;
}

/** The standard error of the mean score of the picked organisms; null if no simple formula exists, because the picks
 *  depend on each other. */
function error_of_intensity(selection: Selection, comparison: Comparison, scores: readonly number[]): number|null {
  const population = scores.length, picks = selection.picks;
  if (selection.method === "truncation") {
    return 0;
  }
  if (selection.method === "random") { // picks in full rounds do not vary: each round picks every organism once
    const rest = picks % population, square = sum(scores.map((score) => score * score)) / population;
    return population > 1 ? Math.sqrt(square * rest * (population - rest) / (population - 1)) / picks : 0;
  }
  if (!selection.independent_picks) {
    return null;
  }
  const mean = weighted_mean(comparison.expected, scores);
  return Math.sqrt(sum(scores.map((score, rank) => comparison.expected[rank]! / picks * (score - mean) ** 2)) / picks);
}

/** The standard error of the share of organisms that are not picked. For independent picks it follows from the variance
 *  of the number of empty cells in large populations: Σ(q − q²) − (Σ λq)²/picks, with the expected copies λ and the
 *  chance q of none. */
function error_of_unpicked(selection: Selection, comparison: Comparison): number|null {
  if (selection.method === "truncation" || selection.method === "random") {
    return 0;
  }
  if (!selection.independent_picks) {
    return null;
  }
  const common = sum(comparison.expected.map((copies, rank) => copies * comparison.unpicked_chance[rank]!));
  const variance =
    sum(comparison.unpicked_chance.map((chance) => chance * (1 - chance))) - common * common / selection.picks;
  return Math.sqrt(Math.max(variance, 0)) / comparison.expected.length;
}

const generations_max = 10_000_000; // a longer takeover counts as never

/** On a wheel with unscaled fitness, an organism's share after t generations is f^t / Σ f^t, where f is its fitness. */
function takeover_on_wheel(fitness: readonly number[]): number|null {
  const best = fitness[0]!, goal = 1 - 1 / fitness.length;
  if (fitness[fitness.length - 1]! < 0 || best <= 0) {
    return null;
  }
  const share = (generations: number): number => {
    let first = 0, all = 0;
    for (const value of fitness) {
      const weight = value > 0 ? Math.exp(generations * Math.log(value / best)) : 0;
      all += weight;
      first += value === best ? weight : 0;
    }
    return first / all;
  };
  let after = 1;
  while (share(after) < goal) {
    if (after > generations_max) {
      return null; // takeover never happens, because all fitness values are equal
    }
    after *= 2;
  }
  let before = Math.floor(after / 2);
  while (after - before > 1) {
    const middle = before + Math.floor((after - before) / 2);
    if (share(middle) < goal) {
      before = middle;
    } else {
      after = middle;
    }
  }
  return after;
}

/** Generations until copies of the fittest occupy all places but one, by selection alone, if each number of copies
 *  equals its expectation; null if that never happens or theory gives no value. Source: Goldberg & Deb 1991. */
export function takeover_generations(
  selection: Selection, copies: readonly number[], fitness: readonly number[]): number|null {
  const population = copies.length;
  if (population <= 1) {
    return 0;
  }
  if (selection.overlapping || selection.pressure === "windowed_fitness") {
    return null;
  }
  if (selection.pressure === "fitness") {
    return takeover_on_wheel(fitness);
  }
  if (copies[0]! - copies[population - 1]! <= 1e-12 * copies[0]!) {
    return null; // all organisms have the same chance
  }
  const picks_up_to = [0]; // entry n: expected picks of the n best ranks together
  for (const number of copies) {
    picks_up_to.push(picks_up_to[picks_up_to.length - 1]! + number);
  }
  const each = picks_up_to[population]! / population;
  let places = 1;
  for (let generation = 0; generation < generations_max; ++generation) {
    if (places >= population - 1 - 1e-9) {
      return generation;
    }
    const rank = Math.floor(places), part = places - rank;
    places = Math.min((picks_up_to[rank]! * (1 - part) + picks_up_to[rank + 1]! * part) / each, population);
  }
  return null;
}

/** Pearson's chi-square of all copies, divided by the number of ranks. Its mean and standard deviation are exact for
 *  small numbers of picks, too. Source: Haldane 1937, "The exact value of the moments of the distribution of χ²",
 *  Biometrika 29. */
function agreement(selection: Selection, comparison: Comparison): Prediction {
  const picks = selection.picks;
  let square = 0, inverse = 0, ranks = 0;
  comparison.expected.forEach((expected, rank) => {
    // Ignore ranks this rare: the rounding error of their probability would outweigh the effect of the picks.
    if (expected < 1e-6 * picks / comparison.expected.length) {
      return;
    }
    ranks += 1;
    inverse += picks / expected;
    square += (comparison.copies[rank]! - expected) ** 2 / expected;
  });
  return {
    name: theory_texts.agreement,
    unit: "",
    source: theory_texts.sources.pearson_haldane,
    sentence: theory_texts.agreement_sentence,
    expected: (ranks - 1) / ranks,
    observed: square / ranks,
    standard_error: Math.sqrt(Math.max(2 * (ranks - 1) + (inverse - ranks * ranks - 2 * ranks + 2) / picks, 0)) / ranks,
  };
}

/** Predicts the copies of the fittest, selection intensity, the share not selected, loss of diversity, takeover time,
 *  and how well all copies together agree with the law. Returns an empty list if there are no picks. */
export function predictions(selection: Selection, comparison: Comparison): Prediction[] {
  if (selection.picks === 0) {
    return [];
  }
  const population = comparison.organisms.length, {sources} = theory_texts;
  const takeover = takeover_generations(selection, comparison.expected, comparison.fitness);
  const intensity = (name: string, sentence: string, of: readonly number[]): Prediction => ({
    name,
    sentence,
    unit: theory_texts.unit_deviations,
    source: sources.blickle_thiele,
    expected: weighted_mean(comparison.expected, of),
    observed: weighted_mean(comparison.copies, of),
    standard_error: error_of_intensity(selection, comparison, of),
  });
  const all: Prediction[] = [
    {
      name: theory_texts.fittest,
      sentence: theory_texts.fittest_sentence,
      unit: "",
      source: selection.method === "stochastic_universal" ? sources.baker :
        selection.method === "tournament"                 ? sources.goldberg_deb :
                                                            sources.blickle_thiele,
      expected: comparison.expected[0]!,
      observed: comparison.copies[0]!,
      standard_error: comparison.standard_error[0]!,
    },
    intensity(theory_texts.intensity, theory_texts.intensity_sentence, standard_scores(comparison.fitness)),
    ...(
      selection.pressure === "rank" ?
        [intensity(theory_texts.normal_intensity, theory_texts.normal_intensity_sentence, normal_scores(population))] :
        []),
    {
      name: theory_texts.unpicked,
      unit: "",
      source: sources.motoki,
      sentence: theory_texts.unpicked_sentence,
      expected: sum(comparison.unpicked_chance) / population,
      observed: comparison.copies.filter((copies) => copies === 0).length / population,
      standard_error: error_of_unpicked(selection, comparison),
    },
    {
      name: theory_texts.diversity,
      unit: "",
      source: sources.blickle_thiele,
      sentence: theory_texts.diversity_sentence,
      expected: loss_of_diversity(comparison.expected),
      observed: null,
      standard_error: null,
    },
    {
      name: theory_texts.takeover,
      unit: theory_texts.unit_generations,
      source: sources.goldberg_deb,
      expected: takeover,
      observed: null,
      standard_error: null,
      sentence: selection.overlapping ? theory_texts.takeover_overlapping :
        takeover !== null             ? theory_texts.takeover_sentence :
        selection.pressure !== "rank" ? theory_texts.takeover_of_fitness :
                                        theory_texts.takeover_never,
    }
  ];
  return selection.independent_picks ? [...all, agreement(selection, comparison)] : all;
}
