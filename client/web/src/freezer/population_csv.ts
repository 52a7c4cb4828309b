// population_csv: chromosomes as text, in the format of `evod export --what population`, which evod and evoctl
// read (proto/codec/population_csv.h). Pure functions.
//
//   island,organism,normal_speed,impulse,body_size,base_health,food_radius,poison_radius
//   0,0,103.2,97.5,…
//
// There is a column for each gene. evod numbers islands and organisms from 0, in order. Each gene is a text that parses
// to the same 32-bit float. A gene that is a choice is the text of the choice; its index is read, too.
//
// A file that another program has changed may have what population_csv.h describes: columns in any order, blanks,
// quotes, empty rows, other separators, a decimal comma, and islands that need not count from 0.
import {csv_line, csv_records, CsvError, separator_of} from "../core/csv";
import {freezer_texts} from "../texts/freezer";
import {gene_of_text, type GeneChoices} from "../world/gene_axes";

export interface Population {
  gene_names: string[]; // at least one
  islands: Float32Array[]; // the genes organism by organism
}

const body_genes: readonly string[] =
  ["normal_speed", "impulse", "body_size", "base_health", "food_radius", "poison_radius"];
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

interface Columns {
  island: number;
  organism: number;
  count: number;
  genes: number[]; // in the order of gene_names
  gene_names: string[];
}

/** Returns where the columns are; null if this is not a heading. A first column without a name is ignored: R writes the
 *  names of the rows there. */
function read_heading(cells: readonly string[]): Columns|null {
  const names = cells.map((cell) => cell.trim()), named = names[0] === "" ? names.slice(1) : names;
  const island = names.indexOf("island"), organism = names.indexOf("organism");
  const columns = names.map((_, i) => i).filter((i) => names[i] !== "" && i !== island && i !== organism);
  const is_wrong = island < 0 || organism < 0 || named.includes("") || new Set(named).size !== named.length;
  if (is_wrong || columns.length === 0 || columns.length > genes_max) {
    return null;
  }
  const place = (name: string): number => body_genes.includes(name) ? body_genes.indexOf(name) : body_genes.length;
  const genes = columns.sort((a, b) => place(names[a]!) - place(names[b]!) || a - b); // those of the body first
  return {island, organism, count: cells.length, genes, gene_names: genes.map((column) => names[column]!)};
}

/** Returns a gene; NaN if the cell is neither a 32-bit float nor a choice. */
function read_gene(cell: string, separator: string, choices: readonly string[]): number {
  const text = choices.includes(cell) ? cell : cell.trim();
  const number = separator === "," ? text : text.replaceAll(",", ".");
  const is_readable = choices.includes(text) || number_pattern.test(number);
  return is_readable ? Math.fround(gene_of_text(choices.includes(text) ? text : number, choices)) : NaN;
}

/** Returns the first wrong column of a row, and adds its genes to `genes`; "" if none is wrong. */
function read_row(
  cells: readonly string[], columns: Columns, separator: string, choices: GeneChoices, genes: number[]): string {
  for (const name of ["island", "organism"] as const) {
    if (!/^\d+$/.test(cells[columns[name]]!.trim())) {
      return name;
    }
  }
  for (const [i, column] of columns.genes.entries()) {
    const name = columns.gene_names[i]!, gene = read_gene(cells[column]!, separator, choices.get(name) ?? []);
    if (!Number.isFinite(gene)) {
      return name;
    }
    genes.push(gene);
  }
  return "";
}

/** Returns the population in a file; or a sentence that names the wrong line and column, without a full stop.
 *
 *  choices  of the shown world */
export function read_population(text: string, choices: GeneChoices = new Map()): Population|string {
  const islands = new Map<number, number[]>(), separator = separator_of(text);
  let columns: Columns|null = null;
  for (const record of csv_records(text, separator)) {
    if (record instanceof CsvError) {
      return freezer_texts.not_csv(record.line);
    }
    const {line, cells} = record;
    const wrong = (allowed: string): string =>
      freezer_texts.wrong_line(line, csv_line(cells).slice(0, shown_characters_max), allowed);
    if (columns === null) {
      columns = read_heading(cells);
      if (columns === null) {
        return wrong(freezer_texts.heading);
      }
      continue;
    }
    if (cells.every((cell) => cell.trim() === "")) {
      continue; // spreadsheet programs write empty rows
    }
    if (cells.length !== columns.count) {
      return wrong(freezer_texts.row(columns.genes.length, columns.count, cells.length));
    }
    const genes: number[] = [], wrong_column = read_row(cells, columns, separator, choices, genes);
    if (wrong_column !== "") {
      return wrong(freezer_texts.cell(wrong_column, choices.get(wrong_column) ?? []));
    }
    const island = Number(cells[columns.island]!), there = islands.get(island) ?? [];
    islands.set(island, there);
    for (const gene of genes) {
      there.push(gene);
    }
  }
  if (columns === null) {
    return freezer_texts.wrong_line(1, "", freezer_texts.heading);
  }
  const in_order = [...islands.keys()].sort((a, b) => a - b);
  return islands.size === 0 ?
    freezer_texts.no_organism :
    {gene_names: columns.gene_names, islands: in_order.map((island) => Float32Array.from(islands.get(island)!))};
}

/** Returns the text of a file with these genes.
 *
 *  choices  of the world from which they come; without them, the file contains the indices */
export function population_text(population: Population, choices: GeneChoices = new Map()): string {
  const {gene_names, islands} = population, count = gene_names.length;
  const lines = [csv_line(["island", "organism", ...gene_names])];
  islands.forEach((genes, island) => {
    for (let organism = 0; organism * count < genes.length; ++organism) {
      const texts = Array.from(
        genes.subarray(organism * count, (organism + 1) * count),
        (value, gene) => choices.get(gene_names[gene]!)?.[value] ?? float_text(value));
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
