// Texts of the drawing of a population without bodies.
import type * as english from "../texts/population";

import {fitness_text, with_separators} from "./numbers";

export const population_texts: typeof english.population_texts = {
  name: "Population",
  loading: "Population wird geladen …",
  shown: (drawn, read, all) => drawn === all ? `Jede Linie ist einer von ${with_separators(all)} Organismen.` :
                                               `${with_separators(drawn)} Linien: eine Stichprobe ` +
      (read === all ? `der ${with_separators(all)} Organismen.` :
                      `der ersten ${with_separators(read)} von ${with_separators(all)} Organismen.`),
  best: (organism, fitness) => `Bester: Organismus ${organism}, Fitness ${fitness_text(fitness)}`,
  unrated: "Die Fitness dieser Generation ist noch nicht bekannt.",
  objectives: "Es gibt mehrere Ziele, daher ist kein Organismus in allen der beste.",
  genes: (first, last, count) =>
    `Gene ${with_separators(first)}–${with_separators(last)} von ${with_separators(count)}`,
  before: "Vorige Gene",
  after: "Nächste Gene",
  fitness: "Fitness",
  canvas: (genes, generation, best) =>
    `Die Gene der Generation ${with_separators(generation)} als Linien über ${genes} Achsen. ${best}`,
};
