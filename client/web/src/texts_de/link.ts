// What is wrong with a link to a moment.
import type * as english from "../texts/link";

import {with_separators} from "./numbers";

const fields: {readonly [field: string]: string|undefined} = {
  island: "Insel",
  organism: "Organismus",
  rate: "Bildrate",
  generation: "Generation",
  tick: "Tick"
};
const named = (field: string): string => fields[field] ?? field;

export const link_texts: typeof english.link_texts = {
  no_number: (field, got) => `${named(field)}: „${got}“ ist nicht möglich, erlaubt sind ganze Zahlen`,
  tick_alone: (got) => `Tick: ${got} ohne eine Generation ist nicht möglich`,
  out_of_range: (field, got, subject, first, last) => `${named(field)}: ${got} ist nicht möglich, ${subject} hat ${
    first === last ? "nur " : `${with_separators(first)} bis `}${with_separators(last)}`,
  generation: (generation) => `Generation ${with_separators(generation)}`,
  run: "der Lauf",
};
