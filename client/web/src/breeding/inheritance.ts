// Inheritance: how crossover, order mutation, mutations and bounds turned the genes of the parents into those of a
// descendant. No DOM.
import type {Descendant, Mutation, MutationKind} from "../core/protocol";
import {breeding_texts} from "../texts/breeding";

export interface GeneOrigin {
  value: number;
  from_second: boolean; // false: from the first parent, or blended from both parents
  blended: boolean; // made of the genes of both parents, by blend or simulated_binary crossover
  gene: number; // index of the gene in that parent
}

export interface Inheritance {
  alone: boolean; // the only parent is the organism itself
  first: number[]; // genes of the parents
  second: number[];
  cuts: number[]; // after gene g - 1, the child takes its genes from the other parent
  crossed: GeneOrigin[]; // by gene, after the crossover
  moves: {from: number; to: number}[]; // by the order mutation; genes that stayed are not included
  arranged: GeneOrigin[]; // by gene, after the order mutation
  changes: Required<Mutation>[]; // clamping to bounds, too, in the order in which they happened
  changed: boolean[]; // by gene
  genes: number[]; // of the descendant
}

/** Whether gene g comes from the second parent. */
export function is_from_second(descendant: Descendant, gene: number): boolean {
  const word = gene < 32 ? descendant.from_second ?? 0 : descendant.more_from_second?.[Math.floor(gene / 32) - 1] ?? 0;
  return ((word >>> (gene % 32)) & 1) === 1;
}

/** Returns null if the lists of the Descendant contradict each other. */
export function inheritance_of(descendant: Descendant): Inheritance|null {
  const first = descendant.first_genes ?? [], second = descendant.second_genes ?? [];
  const count = first.length;
  const order = descendant.order_mutation?.order;
  const alone = second.length === 0 || descendant.kind !== "DESCENDANT_KIND_CHILD";
  if (
    count === 0 || (!alone && second.length !== count) ||
    (second.length === 0 && (descendant.from_second ?? 0) !== 0) ||
    (descendant.order_mutation && order?.length !== count)) {
    return null;
  }
  const result: Inheritance = {
    alone,
    first,
    second,
    cuts: [],
    crossed: [],
    moves: [],
    arranged: [],
    changes: [],
    changed: first.map(() => false),
    genes: []
  };
  const share = alone ? 0 : descendant.second_share ?? 0;
  for (let gene = 0; gene < count; ++gene) {
    if (share > 0) {
      result.crossed.push({
        value: Math.fround(first[gene]! + share * (second[gene]! - first[gene]!)),
        from_second: false,
        blended: true,
        gene
      });
      continue;
    }
    const from_second = !alone && is_from_second(descendant, gene);
    const spread = descendant.crossed_genes?.[gene];
    if (spread !== undefined && spread !== (from_second ? second : first)[gene]) {
      result.crossed.push({value: spread, from_second, blended: true, gene});
      continue;
    }
    result.crossed.push({value: from_second ? second[gene]! : first[gene]!, from_second, blended: false, gene});
    if (gene > 0 && from_second !== result.crossed[gene - 1]!.from_second) {
      result.cuts.push(gene);
    }
  }
  result.arranged = [...result.crossed];
  if (order) {
    for (let gene = 0; gene < count; ++gene) {
      const from = order[gene]!;
      const moved = result.crossed[from];
      if (!moved) {
        return null;
      }
      result.arranged[gene] = moved;
      if (from !== gene) {
        result.moves.push({from, to: gene});
      }
    }
  }
  result.genes = result.arranged.map((origin) => origin.value);
  for (const mutation of descendant.mutations ?? []) {
    const {kind = "MUTATION_KIND_UNSPECIFIED", gene = 0, before = 0, after = 0} = mutation;
    if (gene >= count) {
      return null;
    }
    result.changes.push({kind, gene, before, after});
    result.genes[gene] = after;
    result.changed[gene] = true;
  }
  return result;
}

/** Whether the change moved a gene that was outside its bounds. */
export function brings_back(kind: MutationKind|undefined): boolean {
  return kind === "MUTATION_KIND_CLAMP" || kind === "MUTATION_KIND_REFLECT" || kind === "MUTATION_KIND_REDRAW";
}

/** Where a gene comes from: "hidden3<bias: 0.42 of parent 12, creep to 0.5" */
export function origin_text(inheritance: Inheritance, gene: number, name: string, descendant: Descendant): string {
  const origin = inheritance.arranged[gene]!;
  const parent = (origin.from_second ? descendant.second_parent : descendant.first_parent) ?? 0;
  return breeding_texts.gene_origin(
    name, origin.value, origin.blended ? null : parent, origin.gene === gene ? null : origin.gene,
    inheritance.changes.filter((change) => change.gene === gene)
      .map((change) => ({how: breeding_texts.mutation[change.kind], after: change.after})));
}

/** "66 other genes: 35 of parent 12, 31 of parent 45, 4 mutated" */
export function other_genes_text(inheritance: Inheritance, first_gene: number, descendant: Descendant): string {
  const others = inheritance.arranged.slice(first_gene);
  return breeding_texts.other_genes(others.length, {
    first: descendant.first_parent ?? 0,
    second: descendant.second_parent ?? 0,
    blended: others.some((origin) => origin.blended),
    from_second: others.filter((origin) => origin.from_second).length,
    mutated: inheritance.changed.slice(first_gene).filter((changed) => changed).length,
  });
}

/** Neighbouring genes of a long chromosome that are drawn side by side: the weights of one neuron, or a few genes that
 *  are not weights. */
export interface GeneBlock {
  label: string; // the neuron, or the first gene
  neuron: string; // "": the genes are not weights
  first: number;
  count: number;
}

const unnamed_max = 16; // genes in a block that are not weights

/** Divides the genes from `first` on into blocks. */
export function gene_blocks(names: readonly string[], first: number): GeneBlock[] {
  const blocks: GeneBlock[] = [];
  for (let gene = first; gene < names.length; ++gene) {
    const name = names[gene]!;
    const cut = name.indexOf("<");
    const neuron = cut < 0 ? "" : name.slice(0, cut);
    const last = blocks[blocks.length - 1];
    if (last && last.neuron === neuron && (neuron !== "" || last.count < unnamed_max)) {
      last.count += 1;
    } else {
      blocks.push({label: neuron || name, neuron, first: gene, count: 1});
    }
  }
  return blocks;
}
