// Gene groups: which genes of a world describe the body, which are weights of the network, and which are free. No DOM.

export type GeneGroup = "body"|"brain"|"free";

export interface GeneRange {
  first: number;
  count: number;
}

/** Returns the genes of a group, which are contiguous. Without known groups, all genes describe the body.
 *
 *  groups  the enumerators of WorldInfo.gene_groups, in the order of the chromosome */
export function genes_of(groups: readonly string[], group: GeneGroup, gene_count: number): GeneRange {
  if (groups.length === 0) {
    return group === "body" ? {first: 0, count: gene_count} : {first: gene_count, count: 0};
  }
  const name = "GENE_GROUP_" + group.toUpperCase();
  const first = groups.indexOf(name);
  return first < 0 ? {first: groups.length, count: 0} : {first, count: groups.filter((other) => other === name).length};
}
