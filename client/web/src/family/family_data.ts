// FamilyData: the organisms and genes that the panel "family" has loaded, and what is still being loaded. No DOM.
import type {GeneChoices} from "../world/gene_axes";
import type {Server} from "../world/server";
import {GeneTable} from "./gene_table";
import {name_key, type OrganismName} from "./lineage";
import {first_of_whole_tree, gene_values_max, load_genes, load_lineage, type LoadedLineage} from "./loading";

/** What a tree is made of. */
export interface Subject {
  run_id: string;
  whole: boolean; // all organisms of the generation and island of `root`
  root: OrganismName;
}

export interface Source {
  server: Server;
  world: string; // shows the run; may be a replay
  choices: GeneChoices;
}

function key_of({run_id, whole, root}: Subject): string {
  return `${run_id}/${whole ? `${root.generation}/${root.island}` : name_key(root)}`;
}

export class FamilyData {
  lineage: LoadedLineage|null = null; // of the subject that was wanted last
  problem = ""; // why there is none
  genes = new GeneTable();
  genes_problem = "";
  /** How many generations of genes are loaded, of how many; null: none were wanted. */
  gene_progress: {loaded: number; all: number; limited: boolean}|null = null;
  #wanted = "";
  #number = 0; // of the last request
  #genes_wanted = "";
  readonly #on_change: () => void;

  constructor(on_change: () => void) {
    this.#on_change = on_change;
  }

  /** Loads the organisms of a subject unless they are loaded, or being loaded.
   *
   *  per_generation  about how many organisms the run has in each generation */
  want(source: Source, subject: Subject, generations: number, per_generation: number): void {
    const {whole, root} = subject;
    const first = whole ? first_of_whole_tree(root.generation, generations, per_generation) :
                          Math.max(1, root.generation - generations + 1);
    const wanted = `${key_of(subject)}/${first}`;
    if (wanted === this.#wanted) {
      return;
    }
    if (!this.#wanted.startsWith(`${subject.run_id}/`)) {
      this.genes = new GeneTable();
    }
    if (!this.#wanted.startsWith(`${key_of(subject)}/`)) {
      this.lineage = null;
    }
    this.#wanted = wanted;
    this.problem = "";
    this.#genes_wanted = "";
    this.gene_progress = null;
    const number = ++this.#number;
    load_lineage(source.server, source.world, root, whole, first).then(
      (lineage) => {
        if (number === this.#number) {
          this.lineage = lineage;
          this.#on_change();
        }
      },
      (error: Error) => {
        if (number === this.#number) {
          this.problem = error.message;
          this.#on_change();
        }
      });
  }

  /** Forgets that the last request failed, so that want() requests again. */
  try_again(): void {
    this.#wanted = this.#genes_wanted = "";
  }

  /** Loads the genes of these generations that are not loaded yet, the last generation first, as far as the limit
   *  allows. The lineage must be loaded. */
  async want_genes(source: Source, first: number, last: number, values_per_generation: number): Promise<void> {
    const wanted = `${first}/${last}`;
    if (wanted === this.#genes_wanted) {
      return;
    }
    this.#genes_wanted = wanted;
    this.genes_problem = "";
    const number = this.#number, most = Math.max(1, Math.floor(gene_values_max / Math.max(1, values_per_generation)));
    const all = Math.min(last - first + 1, most), limited = all < last - first + 1;
    try {
      for (let generation = last; generation > last - all; --generation) {
        this.gene_progress = {loaded: last - generation, all, limited};
        if (!this.genes.has(generation)) {
          await load_genes(source.server, source.world, generation, source.choices, this.genes);
          if (number !== this.#number || wanted !== this.#genes_wanted) {
            return;
          }
          this.#on_change();
        }
      }
      this.gene_progress = {loaded: all, all, limited};
    } catch (error) {
      if (number !== this.#number || wanted !== this.#genes_wanted) {
        return;
      }
      this.genes_problem = error instanceof Error ? error.message : String(error);
    }
    this.#on_change();
  }
}
