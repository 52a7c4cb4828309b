// HistoryTable: the GenerationStatistics of a run as columns, for each island and for all islands together.
//
// Columns are computed when they are needed, and extended when generations are added. For all islands together, means
// are weighted by the number of organisms, and deviations are those of the combined population. The median of all
// islands is NaN: it does not follow from the medians of the islands.
import type {ColonyStatistics, GeneAccount, GenerationStatistics, GeneStatistics} from "../core/protocol";

export type Island = number|null; // null: all islands together

/** The numbers of GenerationStatistics. */
export type NumberColumn = Exclude<keyof GenerationStatistics, "genes"|"colony"|"predators">;
export type GenePart = Exclude<keyof GeneStatistics, "account">;
export type AccountPart = keyof GeneAccount;
export type ColonyPart = keyof ColonyStatistics;
/** A column of a table: "fitness_best", "gene:0:mean"; of a colony: "colony:count_mean", "predators:count_mean". */
export type Column =
  NumberColumn|`gene:${number}:${GenePart | AccountPart}`|`${"colony" | "predators"}:${ColonyPart}`;

const sums = new Set<Column>([
  "organism_count", "alive_count", "starved_count", "poisoned_count", "food_eaten", "poison_eaten", "clamp_count",
  "too_fast_count", "speed_limit_count"
]);
const greatest = new Set<Column>(["generation", "end_tick", "simulated_s", "fitness_best"]);

export class HistoryTable {
  revision = 0; // changes whenever the table changes
  island_count = 0;
  gene_count = 0;
  #rows: GenerationStatistics[][] = []; // by generation, then by island; entries of a missing island are absent
  #columns = new Map<string, number[]>();
  #taken_count = 0; // messages of the history that was taken last
  #last: GenerationStatistics|undefined;

  get generation_count(): number {
    return this.#rows.length;
  }

  /** 0: the table is empty. */
  get last_generation(): number {
    return this.#rows.length > 0 ? this.#generation_at(this.#rows.length - 1) : 0;
  }

  clear(): void {
    this.#rows = [];
    this.#columns.clear();
    this.#taken_count = this.island_count = this.gene_count = 0;
    this.#last = undefined;
    ++this.revision;
  }

  /** Takes a history, ordered by generation. Reads only the new messages if the rest is the same as before, or lacks
   *  the first generations, which the server no longer keeps. */
  set_history(history: readonly GenerationStatistics[]): void {
    const dropped = this.#taken_count === 0 ? 0 : this.#leading_count(history[0]);
    const known = this.#taken_count - dropped;
    if (dropped < 0 || known > history.length || (known > 0 && history[known - 1] !== this.#last)) {
      this.clear();
      this.add(history);
    } else {
      this.#drop(dropped);
      if (history.length > known) {
        this.add(history.slice(known));
      }
    }
    this.#taken_count = history.length;
    this.#last = history[history.length - 1];
  }

  /** Returns the number of messages in the generations before that of `first`; -1 if the table does not contain it. */
  #leading_count(first: GenerationStatistics|undefined): number {
    let count = 0;
    for (const row of this.#rows) {
      if (first !== undefined && row.includes(first)) {
        return count;
      }
      count += row.filter((one) => one !== undefined).length;
    }
    return -1;
  }

  /** Removes the first generations, which contain `count` messages. */
  #drop(count: number): void {
    let generations = 0;
    for (let left = count; left > 0; ++generations) {
      left -= this.#rows[generations]!.filter((one) => one !== undefined).length;
    }
    if (generations > 0) {
      this.#rows.splice(0, generations);
      this.#columns.forEach((column) => column.splice(0, generations));
      ++this.revision;
    }
  }

  /** Adds statistics after those of the table, ordered by generation. */
  add(statistics: readonly GenerationStatistics[]): void {
    for (const one of statistics) {
      const island = one.island ?? 0;
      if (this.#rows.length === 0 || this.last_generation !== (one.generation ?? 0)) {
        this.#rows.push([]);
      }
      const last = this.#rows.length - 1;
      this.#rows[last]![island] = one;
      this.#columns.forEach((column) => column.splice(last)); // it may lack the other islands of this generation
      this.island_count = Math.max(this.island_count, island + 1);
      this.gene_count = Math.max(this.gene_count, one.genes?.length ?? 0);
    }
    this.revision += statistics.length > 0 ? 1 : 0;
  }

  /** Returns a column; of all islands together if there is no such island. The array is extended by later calls. */
  column(island: Island, name: Column): number[] {
    const which = island !== null && island < this.island_count ? island : null;
    const key = `${which ?? "all"} ${name}`;
    let column = this.#columns.get(key);
    if (column === undefined) {
      column = [];
      this.#columns.set(key, column);
    }
    for (let i = column.length; i < this.#rows.length; ++i) {
      const row = this.#rows[i]!;
      column.push(
        which === null             ? all_islands(row, name) :
          row[which] === undefined ? (name === "generation" ? this.#generation_at(i) : NaN) :
                                     number_of(row[which], name));
    }
    return column;
  }

  #generation_at(index: number): number {
    return this.#rows[index]!.find((one) => one !== undefined)?.generation ?? 0;
  }
}

/** Returns a number of one island; NaN if it is unknown. Fields of the value 0 are absent in messages. */
function number_of(statistics: GenerationStatistics, name: Column): number {
  if (is_of_colony(name)) {
    const {colony, predators} = statistics, [species, part] = name.split(":");
    return colony === undefined ? NaN : (species === "colony" ? colony : predators?.colony)?.[part as ColonyPart] ?? 0;
  }
  const gene_part = part_of(name);
  if (gene_part === null) {
    return statistics[name as NumberColumn] ?? 0;
  }
  const {index, part} = gene_part, gene = statistics.genes?.[index];
  switch (part) {
    case "mean":
    case "deviation":
    case "min":
    case "max":
      return gene === undefined ? NaN : gene[part] ?? 0;
    default:
      return gene?.account === undefined ? NaN : gene.account[part] ?? 0;
  }
}

function is_of_colony(name: Column): boolean {
  return name.startsWith("colony:") || name.startsWith("predators:");
}

/** Returns what a column shows of a gene; null if it is not about a gene. */
function part_of(name: Column): {index: number; part: GenePart | AccountPart}|null {
  if (!name.startsWith("gene:")) {
    return null;
  }
  const [, index, part] = name.split(":");
  return {index: Number(index), part: part as GenePart | AccountPart};
}

function all_islands(row: readonly GenerationStatistics[], name: Column): number {
  const islands = row.filter((one) => one !== undefined);
  if (islands.length === 1) {
    return number_of(islands[0]!, name);
  }
  const numbers = islands.map((one) => number_of(one, name)), part = part_of(name)?.part;
  if (sums.has(name) || is_of_colony(name)) {
    return numbers.reduce((sum, number) => sum + number, 0);
  }
  if (greatest.has(name) || part === "max") {
    return Math.max(...numbers);
  }
  if (name === "fitness_worst" || part === "min") {
    return Math.min(...numbers);
  }
  if (name === "fitness_median" || name === "best_organism") {
    return NaN;
  }
  const counts = islands.map((one) => one.organism_count ?? 0);
  const total = counts.reduce((sum, count) => sum + count, 0);
  const mean = (of: readonly number[]): number =>
    counts.reduce((sum, count, i) => sum + (total > 0 ? count / total : 1 / counts.length) * of[i]!, 0);
  if (name !== "fitness_deviation" && part !== "deviation") {
    return mean(numbers);
  }
  const means = islands.map((one) => number_of(one, name.replace(/deviation$/, "mean") as Column));
  const centre = mean(means); // the variance is that within the islands and between them
  return Math.sqrt(mean(numbers.map((number, i) => number ** 2 + (means[i]! - centre) ** 2)));
}
