// history_csv: the statistics of runs as CSV, with the columns of `evod export --what generations`. Pure functions.
import {csv_line, csv_records, CsvError} from "../core/csv";
import type {CsvRecord} from "../core/csv";
import type {GenerationStatistics} from "../core/protocol";
import {history_csv_texts as texts} from "../texts/history_csv";
import type {AccountPart, GenePart, NumberColumn} from "./history_table";

const number_columns: readonly NumberColumn[] = [
  "generation",   "island",       "end_tick",       "simulated_s",       "organism_count",
  "fitness_best", "fitness_mean", "fitness_median", "fitness_worst",     "fitness_deviation",
  "diversity",    "alive_count",  "starved_count",  "poisoned_count",    "food_eaten",
  "poison_eaten", "clamp_count",  "too_fast_count", "speed_limit_count", "best_organism"
];
const gene_parts: readonly GenePart[] = ["mean", "deviation", "min", "max"];
const account_parts: readonly AccountPart[] = ["selection", "transmission", "migration", "change"];
const island_max = 65535;

/** Statistics that a file contains. */
export type Statistics = GenerationStatistics&{
  generation: number;
  island: number
};

/** The statistics of one run in a file. */
export interface CsvRun {
  name: string; // the columns that distinguish the runs of the file: "cell 0, replicate 1"; empty: the only run
  history: Statistics[]; // ordered by generation
}
export interface HistoryCsv {
  runs: CsvRun[]; // at least one
  gene_names: string[];
}

/** Returns the table of GenerationStatistics messages, with a heading. */
export function history_csv(history: readonly GenerationStatistics[], gene_names: readonly string[]): string {
  const of_genes = (parts: readonly string[]): string[] =>
    gene_names.flatMap((gene) => parts.map((part) => `${gene}_${part}`));
  const lines = [csv_line([...number_columns, ...of_genes(gene_parts), ...of_genes(account_parts)])];
  for (const one of history) {
    const genes = gene_names.map((_, i) => one.genes?.[i]);
    lines.push(csv_line([
      ...number_columns.map((name) => one[name] ?? 0),
      ...genes.flatMap((gene) => gene_parts.map((part) => gene?.[part] ?? 0)),
      ...genes.flatMap((gene) => account_parts.map((part) => (gene?.account ? gene.account[part] ?? 0 : ""))),
    ]));
  }
  return `${lines.join("\n")}\n`;
}

/** Reads a table in any order of columns. Other columns, such as cell and replicate of `evod sweep`, distinguish the
 *  runs of the table. Returns the runs; or a sentence that names the wrong line, without a full stop. */
export function read_history_csv(text: string): HistoryCsv|string {
  const records = csv_records(text);
  if (records instanceof CsvError) {
    return records.wrong === "open quote" ? texts.open_quote(records.line) : texts.text_after_quote(records.line);
  }
  const [heading, ...rows] = records;
  if (heading === undefined) {
    return texts.empty;
  }
  const columns = columns_of(heading);
  if (typeof columns === "string") {
    return columns;
  }
  if (rows.length === 0) {
    return texts.no_rows(heading.line);
  }
  const groups = new Map<string, Group>();
  for (const row of rows) {
    const statistics = row_of(row, columns);
    if (typeof statistics === "string") {
      return statistics;
    }
    const key = JSON.stringify(columns.others.map(([, at]) => row.cells[at]));
    const group = groups.get(key) ?? {cells: row.cells, history: [], places: new Set<string>()};
    groups.set(key, group);
    const {generation, island} = statistics, place = `${generation}/${island}`;
    if (group.places.has(place)) {
      return texts.twice(row.line, generation, island);
    }
    group.places.add(place);
    group.history.push(statistics);
  }
  return {runs: runs_of([...groups.values()], columns), gene_names: columns.gene_names};
}

/** The rows with the same cells in all columns that are not statistics. */
interface Group {
  cells: readonly string[]; // of its first row
  history: Statistics[];
  places: Set<string>; // generations and islands
}

interface Columns {
  at: ReadonlyMap<string, number>; // the index of each column
  count: number;
  gene_names: string[];
  required: string[];
  accounts: string[]; // may be absent or empty
  others: [string, number][]; // columns that are not statistics
}

function columns_of({line, cells}: CsvRecord): Columns|string {
  const at = new Map(cells.map((name, i) => [name, i]));
  const twice = cells.find((name, i) => at.get(name) !== i);
  if (twice !== undefined) {
    return texts.column_twice(line, twice);
  }
  const gene_names = cells.filter((name) => name.endsWith("_mean") && name !== "fitness_mean")
                       .map((name) => name.slice(0, -"_mean".length));
  const of_genes = (parts: readonly string[]): string[] =>
    gene_names.flatMap((gene) => parts.map((part) => `${gene}_${part}`));
  const required = [...number_columns, ...of_genes(gene_parts)];
  const missing = required.find((name) => !at.has(name));
  if (missing !== undefined) {
    return texts.no_column(line, missing);
  }
  const accounts = of_genes(account_parts), statistics = new Set([...required, ...accounts]);
  const others = [...at].filter(([name]) => !statistics.has(name));
  return {at, count: cells.length, gene_names, required, accounts, others};
}

/** Returns GenerationStatistics; or a sentence that says what is wrong. */
function row_of({line, cells}: CsvRecord, {at, count, gene_names, required, accounts}: Columns): Statistics|string {
  if (cells.length !== count) {
    return texts.cell_count(line, cells.length, count);
  }
  const cell = (name: string): string => cells[at.get(name) ?? -1] ?? "";
  const is_number = (text: string): boolean => text.trim() !== "" && Number.isFinite(Number(text));
  const wrong = required.find((name) => !is_number(cell(name)));
  if (wrong !== undefined) {
    return texts.not_a_number(line, wrong, cell(wrong));
  }
  const wrong_account = accounts.find((name) => cell(name) !== "" && !is_number(cell(name)));
  if (wrong_account !== undefined) {
    return texts.not_an_account(line, wrong_account, cell(wrong_account));
  }
  const number = (name: string): number => Number(cell(name));
  for (const [name, least, most] of [["generation", 1, Number.MAX_SAFE_INTEGER], ["island", 0, island_max]] as const) {
    if (!Number.isInteger(number(name)) || number(name) < least || number(name) > most) {
      return texts.not_whole(line, name, cell(name), least, most);
    }
  }
  const parts_of = (gene: string, parts: readonly string[]): {[part: string]: number} =>
    Object.fromEntries(parts.map((part) => [part, number(`${gene}_${part}`)]));
  const has_account = (gene: string): boolean => account_parts.every((part) => is_number(cell(`${gene}_${part}`)));
  return {
    generation: number("generation"),
    island: number("island"),
    ...Object.fromEntries(number_columns.map((name) => [name, number(name)])),
    genes: gene_names.map(
      (gene) =>
        ({...parts_of(gene, gene_parts), ...(has_account(gene) ? {account: parts_of(gene, account_parts)} : {})})),
  };
}

/** Names the runs by the columns in which they differ. The seed and the cell are left out if the others suffice: a cell
 *  is the number of a set of parameters. */
function runs_of(groups: readonly Group[], {others}: Columns): CsvRun[] {
  let distinct = others.filter(([, at]) => groups.some(({cells}) => cells[at] !== groups[0]!.cells[at]));
  for (const unclear of ["seed", "cell"]) {
    const rest = distinct.filter(([name]) => name !== unclear);
    const names = groups.map(({cells}) => JSON.stringify(rest.map(([, at]) => cells[at])));
    distinct = rest.length > 0 && new Set(names).size === groups.length ? rest : distinct;
  }
  return groups.map(({cells, history}) => ({
                      name: texts.run(distinct.map(([name, at]) => [name, cells[at]!])),
                      history: history.sort((a, b) => a.generation - b.generation),
                    }));
}
