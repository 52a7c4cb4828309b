// BestOrganism: the organism with the greatest fitness of all ended generations, the first one of several, as `evoctl
// best` and history.best() of Python find it.
import type {EndedGeneration} from "./history";

export class BestOrganism {
  #generations: readonly EndedGeneration[] = [];
  #read = 0; // of #generations, which only grows
  #best: EndedGeneration|null = null;

  /** Returns the statistics of its generation and island, whose best_organism it is; null without an ended generation.
   *
   *  generations  oldest first */
  in(generations: readonly EndedGeneration[]): EndedGeneration|null {
    if (generations !== this.#generations || generations.length < this.#read) {
      this.#generations = generations;
      this.#read = 0;
      this.#best = null;
    }
    for (; this.#read < generations.length; ++this.#read) {
      const row = generations[this.#read]!;
      if (this.#best === null || (row.fitness_best ?? 0) > (this.#best.fitness_best ?? 0)) {
        this.#best = row;
      }
    }
    return this.#best;
  }
}
