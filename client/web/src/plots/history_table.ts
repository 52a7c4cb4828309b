// HistoryTable: the GenerationStatistics of a run as columns, for each island and for all islands together.
//
// Columns are computed when they are needed, and extended when generations are added. A column is named "generation", "fitness_best" or
// as any other number of GenerationStatistics, or "gene:INDEX:PART" with the parts mean, deviation, min, max, selection, transmission,
// migration and change. For all islands together, means are weighted by the number of organisms, and deviations are those of the
// combined population. The median of all islands is NaN: it does not follow from the medians of the islands.
import type {Message} from "../core/messages";

export type Island = number|null; // null: all islands together

const sums = new Set([
  "organism_count", "alive_count", "starved_count", "poisoned_count", "food_eaten", "poison_eaten", "clamp_count",
  "too_fast_count", "speed_limit_count"
]);
const greatest = new Set(["generation", "end_tick", "simulated_s", "fitness_best"]);
const account_parts = new Set(["selection", "transmission", "migration", "change"]);

export class HistoryTable {
  revision = 0; // changes whenever the table changes
  island_count = 0;
  gene_count = 0;
  #rows: Message[][] = []; // by generation, then by island; entries of a missing island are absent
  #columns = new Map<string, number[]>();
  #taken_count = 0; // messages of the history that was taken last
  #last: Message|undefined;

  get generation_count(): number {
    return this.#rows.length;
  }

  clear(): void {
    this.#rows = [];
    this.#columns.clear();
    this.#taken_count = this.island_count = this.gene_count = 0;
    this.#last = undefined;
    ++this.revision;
  }

  /** Takes a history, ordered by generation. Reads only the new messages if the rest is the same as before, or lacks the first generations,
   *  which the server no longer keeps. */
  set_history(history: readonly Message[]): void {
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

  /** Returns the number of messages in the generations before that of `first`; -1 if the table does not contain `first`. */
  #leading_count(first: Message|undefined): number {
    let count = 0;
    for (const row of this.#rows) {
      if (row.includes(first as Message)) {
        return count;
      }
      count += row.filter((one) => one !== undefined).length;
    }
    return -1;
  }

  /** Removes the first generations if there are more than `most`, rarely, because this takes time. */
  limit(most: number): void {
    if (this.#rows.length > most * 1.1) {
      this.#drop_generations(this.#rows.length - most);
    }
  }

  /** Removes the first generations, which contain `count` messages. */
  #drop(count: number): void {
    let generations = 0;
    for (let left = count; left > 0; ++generations) {
      left -= this.#rows[generations]!.filter((one) => one !== undefined).length;
    }
    if (generations > 0) {
      this.#drop_generations(generations);
    }
  }

  #drop_generations(count: number): void {
    this.#rows.splice(0, count);
    this.#columns.forEach((column) => column.splice(0, count));
    ++this.revision;
  }

  /** Adds statistics, ordered by generation. Statistics of a generation that is known replace it; earlier ones are inserted. */
  add(statistics: readonly Message[]): void {
    for (const one of statistics) {
      const generation = Number(one.generation ?? 0), island = Number(one.island ?? 0);
      let place = this.#rows.length;
      while (place > 0 && this.#generation_at(place - 1) > generation) {
        --place;
      }
      if (place > 0 && this.#generation_at(place - 1) === generation) {
        (this.#rows[place - 1] as Message[])[island] = one;
        this.#shorten(place - 1);
      } else {
        const row: Message[] = [];
        row[island] = one;
        this.#rows.splice(place, 0, row);
        this.#shorten(place);
      }
      this.island_count = Math.max(this.island_count, island + 1);
      this.gene_count = Math.max(this.gene_count, one.genes?.length ?? 0);
    }
    this.revision += statistics.length > 0 ? 1 : 0;
  }

  /** Returns a column; of all islands together if there is no such island. The array is extended by later calls. */
  column(island: Island, name: string): number[] {
    const which = island !== null && island < this.island_count ? island : null;
    const key = `${which ?? "all"} ${name}`;
    let column = this.#columns.get(key);
    if (column === undefined) {
      column = [];
      this.#columns.set(key, column);
    }
    for (let i = column.length; i < this.#rows.length; ++i) {
      const row = this.#rows[i] as Message[];
      column.push(
        which === null             ? all_islands(row, name) :
          row[which] === undefined ? (name === "generation" ? this.#generation_at(i) : NaN) :
                                     number_of(row[which] as Message, name));
    }
    return column;
  }

  #generation_at(index: number): number {
    return Number((this.#rows[index] as Message[]).find((one) => one !== undefined)?.generation ?? 0);
  }

  /** Forgets the numbers of the columns from this row on. */
  #shorten(count: number): void {
    this.#columns.forEach((column) => {
      column.length = Math.min(column.length, count);
    });
  }
}

/** Returns a number of one island; NaN if it is unknown. Fields of the value 0 are absent in messages. */
function number_of(statistics: Message, name: string): number {
  if (!name.startsWith("gene:")) {
    return Number(statistics[name] ?? 0);
  }
  const [, index, part] = name.split(":") as [string, string, string];
  const gene: Message|undefined = statistics.genes?.[Number(index)];
  if (gene === undefined) {
    return NaN;
  }
  if (account_parts.has(part)) {
    return gene.account === undefined ? NaN : Number(gene.account[part] ?? 0);
  }
  return Number(gene[part] ?? 0);
}

function all_islands(row: readonly Message[], name: string): number {
  const islands = row.filter((one) => one !== undefined);
  if (islands.length === 1) {
    return number_of(islands[0] as Message, name);
  }
  const numbers = islands.map((one) => number_of(one, name));
  const part = name.startsWith("gene:") ? name.slice(name.lastIndexOf(":") + 1) : "";
  if (sums.has(name)) {
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
  const counts = islands.map((one) => Number(one.organism_count ?? 0));
  const total = counts.reduce((sum, count) => sum + count, 0);
  const mean = (of: (i: number) => number) =>
    counts.reduce((sum, count, i) => sum + (total > 0 ? count / total : 1 / counts.length) * of(i), 0);
  if (name !== "fitness_deviation" && part !== "deviation") {
    return mean((i) => numbers[i] as number);
  }
  const means = islands.map(
    (one) => number_of(one, name.replace(/deviation$/, "mean"))); // variance within the islands and between them
  const centre = mean((i) => means[i] as number);
  return Math.sqrt(mean((i) => (numbers[i] as number) ** 2 + ((means[i] as number) - centre) ** 2));
}
