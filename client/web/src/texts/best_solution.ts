// Texts about the best organism of a run.
import {fitness_text, with_separators} from "./numbers";

export const best_solution_texts = {
  title: "Best solution",
  fitness: (fitness: number) => `fitness ${fitness_text(fitness)}`,
  place: (organism: number, island: number|null, generation: number) =>
    `organism ${with_separators(organism)}${island === null ? "" : ` of island ${island}`}, ` +
    `generation ${with_separators(generation)}`,
  genes: "Genes",
  table: "Genes of the best solution",
  headings: ["gene", "value"],
  ancestors: "Ancestors",
  ancestors_help: "Shows the ancestors of this organism in the family tree.",
  loading: "Loading the genes …",
  missing: (generation: number) =>
    `The run file does not contain this organism of generation ${with_separators(generation)}.`,
};
