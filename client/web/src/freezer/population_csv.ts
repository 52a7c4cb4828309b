// population_csv: chromosomes as text, in the format of `evod export --what population`, which evod and evoctl
// read (proto/codec/population_csv.h). Pure functions.
//
//   island,organism,normal_speed,impulse,body_size,base_health,food_radius,poison_radius
//   0,0,103.2,97.5,…
//
// There is a column for each gene. Islands and organisms are numbered from 0, in order. Each gene is a text that
// parses to the same 32-bit float.
import {csv_line, csv_records, CsvError} from "../core/csv";
import {freezer_texts} from "../texts/freezer";

export interface Population {
  gene_names: string[]; // at least one
  islands: Float32Array[]; // the genes organism by organism
}

const genes_max = 10_000;
const shown_characters_max = 80; // of a wrong line
const number_pattern = /^-?(\d+\.?\d*|\.\d+)(e[+-]?\d+)?$/i;

/** Whether a population is a single organism. */
export function is_organism({gene_names, islands}: Population): boolean {
  return islands.length === 1 && islands[0]!.length === gene_names.length;
}

/** The genes of one organism. */
export function genes_of_organism(population: Population, island: number, organism: number): Float32Array {
  const count = population.gene_names.length;
  return population.islands[island]!.subarray(organism * count, (organism + 1) * count);
}

/** Returns the population in a file; or a sentence that names the wrong line, without a full stop. */
export function read_population(text: string): Population|string {
  const islands: number[][] = [];
  let gene_names: string[]|null = null;
  for (const record of csv_records(text)) {
    if (record instanceof CsvError) {
      return freezer_texts.not_csv(record.line);
    }
    const {line, cells} = record;
    const wrong = (allowed: string): string =>
      freezer_texts.wrong_line(line, csv_line(cells).slice(0, shown_characters_max), allowed);
    if (gene_names === null) {
      const [island, organism, ...names] = cells;
      const is_heading = island === "island" && organism === "organism" && names.length > 0;
      if (!is_heading || names.length > genes_max || names.includes("")) {
        return wrong(freezer_texts.heading);
      }
      gene_names = names;
      continue;
    }
    const genes: number[] = [];
    const are_numbers = /^\d+$/.test(cells[0]!) && /^\d+$/.test(cells[1] ?? "");
    for (let gene = 2; are_numbers && gene < cells.length; ++gene) {
      const value = number_pattern.test(cells[gene]!) ? Math.fround(Number(cells[gene])) : NaN;
      if (Number.isFinite(value)) {
        genes.push(value);
      }
    }
    if (!are_numbers || cells.length !== gene_names.length + 2 || genes.length !== gene_names.length) {
      return wrong(freezer_texts.row(gene_names.length));
    }
    const island = Number(cells[0]), organism = Number(cells[1]);
    if (island === islands.length && organism === 0) {
      islands.push([]);
    }
    const last = Math.max(islands.length - 1, 0), next = (islands[last]?.length ?? 0) / gene_names.length;
    if (islands.length === 0 || island !== last || organism !== next) {
      return wrong(freezer_texts.order(next, last));
    }
    for (const gene of genes) {
      islands[last]!.push(gene);
    }
  }
  if (gene_names === null) {
    return freezer_texts.wrong_line(1, "", freezer_texts.heading);
  }
  return islands.length === 0 ? freezer_texts.no_organism :
                                {gene_names, islands: islands.map((genes) => Float32Array.from(genes))};
}

/** Returns the text of a file with these genes. */
export function population_text(population: Population): string {
  const {gene_names, islands} = population, count = gene_names.length;
  const lines = [csv_line(["island", "organism", ...gene_names])];
  islands.forEach((genes, island) => {
    for (let organism = 0; organism * count < genes.length; ++organism) {
      const texts = Array.from(genes.subarray(organism * count, (organism + 1) * count), float_text);
      lines.push(csv_line([island, organism, ...texts]));
    }
  });
  return lines.join("\n") + "\n";
}

/** A short text that parses to the same 32-bit float. */
export function float_text(value: number): string {
  const digits = [6, 7, 8].find((count) => Math.fround(Number(value.toPrecision(count))) === value) ?? 9;
  return Object.is(value, -0) ? "-0" : String(Number(value.toPrecision(digits)));
}
