// Texts about names that users choose, and about worlds whose organisms have other genes.
import {with_separators} from "./numbers";

const genes = (count: number): string => `${with_separators(count)} ${count === 1 ? "gene" : "genes"}`;

export const name_texts = {
  wrong: (field: string, name: string, characters_max: number) =>
    `${field}: got "${name}", allowed 1 to ${characters_max} characters of a-z A-Z 0-9 _ -`,
  other_count: (model: string, count: number, world: string, world_count: number) =>
    `${model} has ${genes(count)}, but the organisms of the world ${world} have ${with_separators(world_count)}.`,
  other_gene: (model: string, number: number, gene: string, world: string, world_gene: string) =>
    `${model} has other genes than the organisms of the world ${world}: gene ${number} is ${gene}, not ${world_gene}.`,
};
