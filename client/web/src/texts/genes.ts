// genes: names and values of genes for readers.
import {localised, tenths} from "./numbers";

/** As the server names the gene: "normal_speed". */
export function gene_name(name: string): string {
  return name;
}

/** "normal_speed" → "normal speed". */
export function gene_label(name: string): string {
  return name.replace(/_/g, " ");
}

/** Genes of the body are about 100, weights and free genes about 1. */
export function gene_number(value: number): string {
  return Math.abs(value) >= 10 ? tenths(value) : localised(value.toFixed(2)).replace("-", "−");
}
