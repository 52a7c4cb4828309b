// standing: how far the world of a student has come, and the order of the tiles. Pure functions.
import type {HistoryTable} from "../plots/history_table";

export interface Standing {
  generation: number; // the last one that has ended; 0: none
  best: number; // the greatest fitness of the run; NaN: none
  mean: number; // of the last generation that has ended; NaN: none
  stuck: number; // generations since `best` was reached
}

export type Order = "name"|"fitness"|"help";

export const no_standing: Standing = {
  generation: 0,
  best: NaN,
  mean: NaN,
  stuck: 0
};

export function standing_of(table: HistoryTable): Standing {
  if (table.generation_count === 0) {
    return no_standing;
  }
  const fitness = table.column(null, "fitness_best"), means = table.column(null, "fitness_mean");
  let best = NaN, stuck = 0;
  fitness.forEach((value) => {
    const is_better = Number.isFinite(value) && !(value <= best);
    best = is_better ? value : best;
    stuck = is_better ? 0 : stuck + 1;
  });
  return {generation: table.last_generation, best, mean: means[means.length - 1] ?? NaN, stuck};
}

interface Ranked {
  name: string;
  standing: Standing;
}

/** Sorts in place: by name; by fitness, the fittest first; or by need of help, the longest stuck first. */
export function sort_by<Of extends Ranked>(students: Of[], order: Order): Of[] {
  const by_name = (one: Of, other: Of): number => one.name.localeCompare(other.name, undefined, {numeric: true});
  const value = ({standing: {best, stuck}}: Of): number => order === "help" ? stuck :
    Number.isFinite(best)                                                   ? best :
                                                                              -Infinity;
  return students.sort((one, other) => {
    const [a, b] = order === "name" ? [0, 0] : [value(one), value(other)];
    return a === b ? by_name(one, other) : b - a;
  });
}
