// first_population: the fields of CreateWorld that give a new world its first generation. Pure functions.
import type {CreateWorld, ParameterDescription} from "../core/protocol";
import {new_world_texts} from "../texts/new_world";

import {is_organism, type Population} from "./population_csv";

type FirstPopulation = Pick<CreateWorld, "population"|"population_gene_names"|"parameters">;

/** Returns the fields; or, if islands differ in size, a sentence without a full stop. The parameters population_size
 *  and island_count follow from a population. A single organism is copied for all places that the experiment has.
 */
export function first_population(
  population: Population, experiment_json: string, registry: readonly ParameterDescription[]): FirstPopulation|string {
  const {gene_names} = population;
  if (is_organism(population)) {
    const size = count_in("population_size", experiment_json, registry);
    const count = count_in("island_count", experiment_json, registry);
    const island = {genes: copies([...population.islands[0]!], size)};
    return {population: Array.from({length: count}, () => island), population_gene_names: gene_names, parameters: []};
  }
  const counts = population.islands.map((island) => island.length / gene_names.length), first = counts[0]!;
  const other = counts.find((count) => count !== first);
  if (other !== undefined) {
    return new_world_texts.unequal_islands(first, other);
  }
  return {
    population: population.islands.map((genes) => ({genes: [...genes]})),
    population_gene_names: gene_names,
    parameters:
      [{name: "population_size", value: {count: first}}, {name: "island_count", value: {count: counts.length}}]
  };
}

function copies(genes: readonly number[], count: number): number[] {
  return Array.from({length: count}, () => genes).flat();
}

/** The value of a parameter in generation 1. The server refuses a text that is not an experiment. */
function count_in(name: string, experiment_json: string, registry: readonly ParameterDescription[]): number {
  const usual = registry.find((parameter) => parameter.name === name)?.default_value?.count ?? 1;
  try {
    const value: unknown = JSON.parse(experiment_json)[name];
    const first: unknown =
      typeof value === "object" && value !== null ? (value as {[generation: string]: unknown})["1"] : value;
    return typeof first === "number" && Number.isInteger(first) && first > 0 ? first : usual;
  } catch {
    return usual;
  }
}
