// Texts of the drawing of a population without bodies.
import {fitness_text, with_separators} from "./numbers";

export const population_texts = {
  name: "Population",
  loading: "Loading the population …",
  /** drawn: lines; read: organisms of which they are a sample; all: organisms of the island. */
  shown: (drawn: number, read: number, all: number) =>
    drawn === all ? `Each line is one of ${with_separators(all)} organisms.` :
                    `${with_separators(drawn)} lines: a sample of ` +
        (read === all ? `${with_separators(all)} organisms.` :
                        `the first ${with_separators(read)} of ${with_separators(all)} organisms.`),
  best: (organism: number, fitness: number) => `Best: organism ${organism}, fitness ${fitness_text(fitness)}`,
  unrated: "The fitness of this generation is not known yet.",
  objectives: "There are several objectives, so no organism is the best in all.",
  genes: (first: number, last: number, count: number) =>
    `genes ${with_separators(first)}–${with_separators(last)} of ${with_separators(count)}`,
  before: "Earlier genes",
  after: "Later genes",
  fitness: "fitness",
  canvas: (genes: number, generation: number, best: string) =>
    `The genes of generation ${with_separators(generation)} as lines across ${genes} axes. ${best}`,
};
