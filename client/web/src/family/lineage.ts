// Lineage: organisms and their parents, read from the CSV that ExportRun sends. No DOM.
//
// The table contains only numbers and words of the protocol, so no cell is quoted.
import {family_texts} from "../texts/family";

/** An organism of the run: its generation, its island and its id there. */
export interface OrganismName {
  generation: number;
  island: number;
  organism: number;
}

export interface Ancestor extends OrganismName {
  parents: OrganismName[]; // the first parent first; one if both are the same; none if unknown or placed
  origin: string; // "child", "survivor", "elite", "initial", "placed"
  fitness: number|null; // null: its generation has not ended
  child_count: number; // in the next generation; 0 before it has begun
  kept_count: number; // of these, how often it survived
}

export function name_key(name: OrganismName): string {
  return `${name.generation}/${name.island}/${name.organism}`;
}

/** Whether the organism is a copy of its only parent. */
export function is_copy(ancestor: Ancestor): boolean {
  return ancestor.origin === "survivor" || ancestor.origin === "elite";
}

const columns = [
  "generation", "island", "organism", "parent_first_generation", "parent_first_island", "parent_first",
  "parent_second_generation", "parent_second_island", "parent_second", "origin", "fitness", "child_count", "kept_count"
];

export class LineageReader {
  readonly ancestors = new Map<string, Ancestor>();
  #places: number[]|null = null; // of `columns` in a line; null before the heading
  #passed = false;

  /** last_generation  ignores organisms of later generations */
  constructor(readonly last_generation: number) {}

  /** Whether a later generation has begun. Generations rise in a table of all organisms, so the rest is not needed. */
  get has_passed(): boolean {
    return this.#passed;
  }

  /** Throws an Error if a line is not a row of the lineage table. */
  add(lines: readonly string[]): void {
    for (const line of lines) {
      const cells = line.split(",");
      if (!this.#places) {
        this.#places = columns.map((column) => cells.indexOf(column));
        const missing = columns.find((_, i) => this.#places![i] === -1);
        if (missing !== undefined) {
          throw new Error(family_texts.no_column(missing));
        }
        continue;
      }
      const ancestor = ancestor_of(this.#places.map((place) => cells[place] ?? ""), line);
      if (ancestor.generation <= this.last_generation) {
        this.ancestors.set(name_key(ancestor), ancestor);
      } else {
        this.#passed = true;
      }
    }
  }
}

/** cells  in the order of `columns` */
function ancestor_of(cells: readonly string[], line: string): Ancestor {
  const number = (column: number): number|null => cells[column] === "" ? null : Number(cells[column]);
  const [generation, island, organism] = [number(0), number(1), number(2)];
  if (!Number.isInteger(generation) || !Number.isInteger(island) || !Number.isInteger(organism)) {
    throw new Error(family_texts.wrong_row(line.slice(0, 80)));
  }
  const parents = [3, 6].flatMap((first): OrganismName[] => {
    const parent = {generation: number(first), island: number(first + 1) ?? 0, organism: number(first + 2)};
    return parent.generation === null || parent.organism === null ?
      [] :
      [{generation: parent.generation, island: parent.island, organism: parent.organism}];
  });
  return {
    generation: generation!,
    island: island!,
    organism: organism!,
    origin: cells[9]!,
    fitness: number(10),
    parents: parents.length === 2 && name_key(parents[0]!) === name_key(parents[1]!) ? [parents[0]!] : parents,
    child_count: number(11) ?? 0,
    kept_count: number(12) ?? 0,
  };
}
