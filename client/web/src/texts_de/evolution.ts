// What people read about evolution: generation 1 next to the present.
import type * as english from "../texts/evolution";

import {fitness_text, significant, with_separators} from "./numbers";

function generations(count: number): string {
  return count === 1 ? "1 Generation" : `${with_separators(count)} Generationen`;
}

export const evolution_texts: typeof english.evolution_texts = {
  asks: (generation) =>
    `Diese Welt ist in Generation ${with_separators(generation)}: Von Evolution ist noch wenig zu sehen.`,
  run: (count) => `${generations(count)} mit vollem Tempo laufen lassen`,
  take_part_and_run: (count) => `Mitmachen und ${generations(count)} mit vollem Tempo laufen lassen`,
  at_once: "Sofort zeigen",
  cancel: "Abbrechen",
  runs: (done, count) => `Evolution läuft: ${with_separators(done)} von ${generations(count)}`,
  interrupted: "Der Lauf mit vollem Tempo wurde unterbrochen.",
  stands: (world, why) => `${world} läuft nicht: ${why}`,
  fitness: (mean, best) => `mittlere Fitness ${fitness_text(mean)}, beste ${fitness_text(best)}`,
  then: (generation, fitness) => `Generation ${with_separators(generation)}: ${fitness}`,
  now: (generation, fitness) => `Jetzt, nach Generation ${with_separators(generation)}: ${fitness}`,
  in_progress: "die erste Runde ist noch nicht zu Ende",
  times: (factor) => ` – das ${significant(factor)}-Fache des Mittelwerts der Generation 1`,
};
