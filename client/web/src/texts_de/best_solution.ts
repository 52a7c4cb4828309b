// Texts about the best organism of a run.
import type * as english from "../texts/best_solution";

import {fitness_text, with_separators} from "./numbers";

export const best_solution_texts: typeof english.best_solution_texts = {
  title: "Beste Lösung",
  fitness: (fitness) => `Fitness ${fitness_text(fitness)}`,
  place: (organism, island, generation) =>
    `Organismus ${with_separators(organism)}${island === null ? "" : ` der Insel ${island}`}, ` +
    `Generation ${with_separators(generation)}`,
  genes: "Gene",
  table: "Gene der besten Lösung",
  headings: ["Gen", "Wert"],
  ancestors: "Vorfahren",
  ancestors_help: "Zeigt die Vorfahren dieses Organismus im Stammbaum.",
  loading: "Gene werden geladen …",
  missing: (generation) =>
    `Die Laufdatei enthält diesen Organismus der Generation ${with_separators(generation)} nicht.`,
};
