// Lineage: an organism and its ancestors, read from the JSON lines that ExportRun sends in parts. No DOM.

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

/** Joins the parts of the table. A part may end within a row, and within a character. */
export class LineageReader {
  readonly ancestors = new Map<string, Ancestor>();
  #decoder = new TextDecoder();
  #rest = "";

  /** Adds a part; `last` completes the table. Throws an Error if a line is no row of the lineage table. */
  add(text: Uint8Array|undefined, last: boolean): void {
    const lines = (this.#rest + this.#decoder.decode(text ?? new Uint8Array(), {stream: !last})).split("\n");
    this.#rest = last ? "" : lines.pop()!;
    for (const line of lines) {
      if (line !== "") {
        const ancestor = ancestor_of(line);
        this.ancestors.set(name_key(ancestor), ancestor);
      }
    }
  }
}

function ancestor_of(line: string): Ancestor {
  let row: {[column: string]: unknown};
  try {
    row = JSON.parse(line) as {[column: string]: unknown};
  } catch {
    throw new Error(`the lineage table has a line that is no JSON: ${line.slice(0, 80)}`);
  }
  const number = (column: string): number|null => typeof row[column] === "number" ? row[column] as number : null;
  const [generation, island, organism] = [number("generation"), number("island"), number("organism")];
  if (generation === null || island === null || organism === null) {
    throw new Error(`the lineage table has a row without an organism: ${line.slice(0, 80)}`);
  }
  const parents = ["parent_first", "parent_second"].flatMap((column) => {
    const parent = number(column), of_generation = number(column + "_generation"),
          of_island = number(column + "_island");
    return parent === null || of_generation === null ?
      [] :
      [{generation: of_generation, island: of_island ?? 0, organism: parent}];
  });
  return {
    generation,
    island,
    organism,
    origin: String(row.origin ?? ""),
    fitness: number("fitness"),
    parents: parents.length === 2 && name_key(parents[0]!) === name_key(parents[1]!) ? [parents[0]!] : parents,
    child_count: number("child_count") ?? 0,
    kept_count: number("kept_count") ?? 0,
  };
}
