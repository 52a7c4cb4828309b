// genes: names and values of genes for readers.
import type * as english from "../texts/genes";

import {localised, tenths} from "./numbers";

const names: {readonly [gene: string]: string|undefined} = {
  normal_speed: "Normaltempo",
  impulse: "Impuls",
  body_size: "Körpergröße",
  base_health: "Grundgesundheit",
  food_radius: "Futterradius",
  poison_radius: "Giftradius",
};

export const gene_name: typeof english.gene_name = (name) => names[name] ?? name;

export const gene_label: typeof english.gene_label = (name) => names[name] ?? name.replace(/_/g, " ");

export const gene_number: typeof english.gene_number = (value) =>
  Math.abs(value) >= 10 ? tenths(value) : localised(value.toFixed(2)).replace("-", "−");
