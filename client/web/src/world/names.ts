// names: the names of worlds and of what the user keeps, and whether organisms have the genes of a world.
// Pure functions.
import type {WorldInfo} from "../core/protocol";
import {name_texts} from "../texts/names";

export const name_characters_max = 64;

/** What is wrong with a name, as a sentence; empty if nothing is. */
export function name_problem(name: string): string {
  return /^[A-Za-z0-9_-]{1,64}$/.test(name) ? "" : name_texts.wrong("name", name, name_characters_max);
}

/** `base`, or `base` with the first number that makes it unused: "default-2". */
export function unused_name(base: string, used: readonly string[]): string {
  if (!used.includes(base)) {
    return base;
  }
  const stem = base.replace(/-\d+$/, "");
  for (let number = 2;; ++number) {
    const end = `-${number}`, name = stem.slice(0, name_characters_max - end.length) + end;
    if (!used.includes(name)) {
      return name;
    }
  }
}

/** The name of a fork: "default-2". In a class it begins with the class and the member: "bio2_red-fox_2". */
export function fork_name({name = "", class: of_class = ""}: WorldInfo, used: readonly string[]): string {
  if (of_class === "") {
    return unused_name(name, used);
  }
  const stem = name.split("_").slice(0, 2).join("_");
  for (let number = 2;; ++number) {
    if (!used.includes(`${stem}_${number}`)) {
      return `${stem}_${number}`;
    }
  }
}

/** The name that the name of a file suggests: "my best.csv" → "my_best". */
export function name_of_file(file: string, fallback: string): string {
  const stem = file.replace(/\.\w+$/, "").replace(/[^A-Za-z0-9_-]/g, "_");
  return stem.slice(0, name_characters_max) || fallback;
}

/** Why an organism with these genes cannot live in a world, as a sentence; empty if it can.
 *
 *  model  what the sentence calls the organism: "leader" */
export function gene_problem(
  model: string, genes: readonly string[], world: string, world_genes: readonly string[]): string {
  if (genes.length !== world_genes.length) {
    return name_texts.other_count(model, genes.length, world, world_genes.length);
  }
  const other = genes.findIndex((gene, i) => gene !== world_genes[i]);
  return other < 0 ? "" : name_texts.other_gene(model, other + 1, genes[other]!, world, world_genes[other]!);
}
