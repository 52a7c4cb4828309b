// comparison: what distinguishes a kept organism from another one, gene by gene. Pure functions.
import type {Population} from "./population_csv";

export interface ComparedGene {
  name: string;
  kept: number;
  other: number|null; // null: the other organism has no gene of this name, or there is no other one
}

/** The genes of the kept organism, in order, with those of the same name of the other organism. */
export function compared_genes(
  names: readonly string[], kept: ArrayLike<number>, other_names: readonly string[],
  other: ArrayLike<number>): ComparedGene[] {
  const places = new Map(other_names.map((name, i) => [name, i]));
  return names.map((name, i) => ({name, kept: kept[i]!, other: other[places.get(name) ?? -1] ?? null}));
}

/** The number of genes that both have, and of those that differ. */
export function difference_counts(genes: readonly ComparedGene[]): {common: number; different: number} {
  const common = genes.filter((gene) => gene.other !== null);
  return {common: common.length, different: common.filter((gene) => gene.other !== gene.kept).length};
}

/** The lowest and the highest value of a gene in a population, and its mean. */
export function range_of_gene(population: Population, gene: number): {min: number; mean: number; max: number} {
  let min = Infinity, max = -Infinity, sum = 0, count = 0;
  for (const island of population.islands) {
    for (let at = gene; at < island.length; at += population.gene_names.length) {
      min = Math.min(min, island[at]!);
      max = Math.max(max, island[at]!);
      sum += island[at]!;
      count += 1;
    }
  }
  return {min, mean: sum / count, max};
}
