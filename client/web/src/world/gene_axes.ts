// gene_axes: the bounds and the possible values of each gene, from the list of free genes and from the parameters.
import type {FreeGene, ParameterSet, WorldInfo} from "../core/protocol";
import {gene_text} from "../texts/breeding";

import {value_in_effect} from "./parameter_values";

export interface GeneAxis {
  name: string;
  min: number|null; // null: unknown
  max: number|null;
  logarithmic: boolean;
  choices: readonly string[]; // of a gene that contains the index of one of them; otherwise empty
}

/** Returns an axis for each gene of a chromosome, in order. */
export function gene_axes(info: WorldInfo|null, set: ParameterSet|null): GeneAxis[] {
  const listed = new Map((info?.free_genes?.genes ?? []).flatMap(axes_of).map((axis) => [axis.name, axis]));
  return (info?.gene_names ?? []).map((name, gene) => {
    const prefix = info?.gene_groups?.[gene] === "GENE_GROUP_FREE" ? "free_gene" : name;
    const bound = (which: string): number|null => {
      const value = value_in_effect(set, `${prefix}_${which}`);
      return value === undefined ? null : value.real ?? 0;
    };
    return listed.get(name) ?? {name, min: bound("min"), max: bound("max"), logarithmic: false, choices: []};
  });
}

function axes_of({name = "", min = 0, max = 0, logarithmic = false, choices = [], permutation = 0}: FreeGene):
  GeneAxis[] {
  if (permutation > 0) {
    return Array.from({length: permutation}, (_, i) => (
      {name: `${name}${i}`, min: 0, max: permutation - 1, logarithmic: false, choices: []}));
  }
  return [choices.length > 0 ? {name, min: 0, max: choices.length - 1, logarithmic: false, choices} :
                               {name, min, max, logarithmic, choices}];
}

/** The texts of the genes that are choices, by name. */
export type GeneChoices = ReadonlyMap<string, readonly string[]>;

export function gene_choices(info: WorldInfo|null): GeneChoices {
  const listed = info?.free_genes?.genes ?? [];
  return new Map(listed.flatMap(({name = "", choices}) => choices ? [[name, choices]] : []));
}

/** The gene for a cell of a table: the index of a choice, or a number. The text of a choice has precedence over an
 *  index, because evod writes the text. */
export function gene_of_text(text: string, choices: readonly string[] = []): number {
  const choice = choices.indexOf(text);
  return choice >= 0 ? choice : Number(text);
}

/** "relu" for a choice, "0.01" for a number. */
export function gene_value_text(axis: GeneAxis, value: number): string {
  return axis.choices[Math.round(value)] ?? gene_text(value);
}
