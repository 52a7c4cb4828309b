// Texts about names that users choose, and about worlds whose organisms have other genes.
import type * as english from "../texts/names";

import {gene_label} from "./genes";
import {with_separators} from "./numbers";

const genes = (count: number): string => `${with_separators(count)} ${count === 1 ? "Gen" : "Gene"}`;
const fields: {readonly [field: string]: string|undefined} = {
  name: "Name"
};

export const name_texts: typeof english.name_texts = {
  wrong: (field, name, characters_max) => `${fields[field] ?? field}: „${name}“ ist nicht möglich, erlaubt sind 1 bis ${
    characters_max} Zeichen von a-z A-Z 0-9 _ -`,
  other_count: (model, count, world, world_count) =>
    `${model} hat ${genes(count)}, die Organismen der Welt ${world} haben aber ${with_separators(world_count)}.`,
  other_gene: (model, number, gene, world, world_gene) => `${model} hat andere Gene als die Organismen der Welt ${
    world}: Gen ${number} ist ${gene_label(gene)}, nicht ${gene_label(world_gene)}.`,
};
