// What people read about evolution: generation 1 next to the present.
import {fitness_text, significant, with_separators} from "./numbers";

function generations(count: number): string {
  return count === 1 ? "1 generation" : `${with_separators(count)} generations`;
}

export const evolution_texts = {
  asks: (generation: number) =>
    `This world is in generation ${with_separators(generation)}: there is little evolution to see yet.`,
  run: (count: number) => `Run ${generations(count)} at full speed`,
  take_part_and_run: (count: number) => `Take part, and run ${generations(count)} at full speed`,
  at_once: "Show it at once",
  cancel: "Cancel",
  runs: (done: number, count: number) => `Evolving: ${with_separators(done)} of ${generations(count)}`,
  interrupted: "The run at full speed was interrupted.",
  stands: (world: string, why: string) => `${world} does not run: ${why}`,
  fitness: (mean: number, best: number) => `mean fitness ${fitness_text(mean)}, best ${fitness_text(best)}`,
  then: (generation: number, fitness: string) => `Generation ${with_separators(generation)}: ${fitness}`,
  now: (generation: number, fitness: string) => `Now, after generation ${with_separators(generation)}: ${fitness}`,
  in_progress: "its first round is not over yet",
  /** The mean has become so many times the one of generation 1. */
  times: (factor: number) => ` – ${significant(factor)} times the mean of generation 1`,
};
