// history_csv: the statistics of runs as CSV, with the columns of `evod export --what generations`. Pure functions.
import {csv_line, csv_records, CsvError} from "../core/csv";
import type {CsvRecord} from "../core/csv";
import {none_left} from "../core/messages";
import type {GenerationStatistics} from "../core/protocol";
import {history_csv_texts as texts} from "../texts/history_csv";
import type {AccountPart, ColonyPart, GenePart, NumberColumn} from "./history_table";

const number_columns: readonly NumberColumn[] = [
  "generation",   "island",       "end_tick",       "simulated_s",       "organism_count",
  "fitness_best", "fitness_mean", "fitness_median", "fitness_worst",     "fitness_deviation",
  "diversity",    "alive_count",  "starved_count",  "poisoned_count",    "food_eaten",
  "poison_eaten", "clamp_count",  "too_fast_count", "speed_limit_count", "best_organism"
];
const common_columns = 4; // so many of them are the same for both species
const gene_parts: readonly GenePart[] = ["mean", "deviation", "min", "max"];
const account_parts: readonly AccountPart[] = ["selection", "transmission", "migration", "change"];
/** Columns that only colonies have. */
const colony_parts: readonly ColonyPart[] = [
  "first_count", "lowest_count", "count_mean", "born_count", "refused_count", "without_room_count", "eaten_count",
  "old_count", "died_count", "children_mean", "children_variance", "age_mean_s"
];
const of_predators = "predators_"; // the prefix of the columns about the predators of a colony
const island_max = 65535, generation_max = 2 ** 32;

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
  const of_both = [...of_genes(gene_parts), ...of_genes(account_parts)], own = number_columns.slice(common_columns);
  const has_colony = history.some((one) => one.colony !== undefined);
  const has_predators = history.some((one) => one.predators !== undefined);
  const of_species = (one: GenerationStatistics): (string|number)[] => {
    const genes = gene_names.map((_, i) => one.genes?.[i]);
    return [
      ...own.map((name) => one[name] ?? 0), ...genes.flatMap((gene) => gene_parts.map((part) => gene?.[part] ?? 0)),
      ...genes.flatMap((gene) => account_parts.map((part) => (gene?.account ? gene.account[part] ?? 0 : ""))),
      ...(has_colony ? colony_parts.map((part) => (one.colony ? one.colony[part] ?? 0 : "")) : [])
    ];
  };
  const columns = [...own, ...of_both, ...(has_colony ? colony_parts : [])];
  const twins = has_predators ? columns.map((name) => of_predators + name) : [];
  const common = number_columns.slice(0, common_columns);
  const lines = [csv_line([...common, ...columns, ...twins])];
  for (const one of history) {
    const predators = one.predators ? of_species(one.predators) : twins.map(() => "");
    lines.push(csv_line([...common.map((name) => one[name] ?? 0), ...of_species(one), ...predators]));
  }
  return `${lines.join("\n")}\n`;
}

/** Reads a table in any order of columns. Other columns, such as cell and replicate of `evod sweep`, distinguish the
 *  runs of the table. Returns the runs; or a sentence that names the wrong line, without a full stop. */
export function read_history_csv(text: string): HistoryCsv|string {
  let heading: CsvRecord|null = null, columns: Columns|null = null;
  const groups = new Map<string, Group>();
  for (const record of csv_records(text)) {
    if (record instanceof CsvError) {
      return error_text(record);
    }
    if (columns === null) {
      const read = columns_of(record);
      if (typeof read === "string") {
        return read;
      }
      heading = record;
      columns = read;
      continue;
    }
    const wrong = add_row(groups, record, columns);
    if (wrong !== "") {
      return wrong;
    }
  }
  if (heading === null || columns === null) {
    return texts.empty;
  }
  return groups.size === 0 ? texts.no_rows(heading.line) :
                             {runs: runs_of([...groups.values()], columns), gene_names: columns.gene_names};
}

function error_text({line, wrong}: CsvError): string {
  switch (wrong) {
    case "open quote":
      return texts.open_quote(line);
    case "text after quote":
      return texts.text_after_quote(line);
    default:
      none_left(wrong);
      return "";
  }
}

/** Adds a row to the rows of its run. Returns what is wrong with it; empty: nothing. */
function add_row(groups: Map<string, Group>, row: CsvRecord, columns: Columns): string {
  const statistics = row_of(row, columns);
  if (typeof statistics === "string") {
    return statistics;
  }
  const key = JSON.stringify(columns.others.map(([, at]) => row.cells[at]));
  const group = groups.get(key) ?? {cells: row.cells, history: [], places: new Set<number>()};
  groups.set(key, group);
  const {generation, island} = statistics, place = generation * (island_max + 1) + island;
  if (group.places.has(place)) {
    return texts.twice(row.line, generation, island);
  }
  group.places.add(place);
  group.history.push(statistics);
  return "";
}

/** The rows with the same cells in all columns that are not statistics. */
interface Group {
  cells: readonly string[]; // of its first row
  history: Statistics[];
  places: Set<number>; // generations and islands
}

/** The place of a column: its name and its index. */
type Place<Name extends string = string> = readonly[Name, number];

interface Columns {
  count: number;
  gene_names: string[];
  required: Place[]; // cells that must be numbers
  accounts: Place[]; // cells that may be empty, with those of colonies
  numbers: Place<NumberColumn>[];
  genes: {parts: Place<GenePart>[]; account: Place<AccountPart>[] | null}[];
  colony: Place<ColonyPart>[]; // of the prey; empty: the run is not a colony
  predators: Place<ColonyPart>[];
  others: Place[]; // columns that are not statistics
}

function columns_of({line, cells}: CsvRecord): Columns|string {
  const at = new Map(cells.map((name, i) => [name, i]));
  const twice = cells.find((name, i) => at.get(name) !== i);
  if (twice !== undefined) {
    return texts.column_twice(line, twice);
  }
  const colony = colony_parts.flatMap((part) => [part, of_predators + part]).filter((name) => at.has(name));
  const is_of_colony = (name: string): boolean => name.startsWith(of_predators) || colony.includes(name);
  const gene_names = cells.filter((name) => name.endsWith("_mean") && name !== "fitness_mean" && !is_of_colony(name))
                       .map((name) => name.slice(0, -"_mean".length));
  const of_genes = (parts: readonly string[]): string[] =>
    gene_names.flatMap((gene) => parts.map((part) => `${gene}_${part}`));
  const required = [...number_columns, ...of_genes(gene_parts)];
  const missing = required.find((name) => !at.has(name));
  if (missing !== undefined) {
    return texts.no_column(line, missing);
  }
  const accounts = [...of_genes(account_parts).filter((name) => at.has(name)), ...colony];
  const place = (name: string): Place => [name, at.get(name)!];
  const places_of = <Part extends string>(gene: string, parts: readonly Part[]): Place<Part>[] =>
    parts.map((part) => [part, at.get(`${gene}_${part}`)!]);
  const places_in_colony = (prefix: string): Place<ColonyPart>[] =>
    colony_parts.flatMap((part): Place<ColonyPart>[] => at.has(prefix + part) ? [[part, at.get(prefix + part)!]] : []);
  const statistics = new Set([...required, ...accounts]);
  return {
    count: cells.length,
    gene_names,
    required: required.map(place),
    accounts: accounts.map(place),
    numbers: number_columns.map((name) => [name, at.get(name)!]),
    genes: gene_names.map(
      (gene) => ({
        parts: places_of(gene, gene_parts),
        account: account_parts.every((part) => at.has(`${gene}_${part}`)) ? places_of(gene, account_parts) : null
      })),
    colony: places_in_colony(""),
    predators: places_in_colony(of_predators),
    others: [...at].filter(([name]) => !statistics.has(name) && !is_of_colony(name)),
  };
}

/** Returns GenerationStatistics; or a sentence that says what is wrong. */
function row_of({line, cells}: CsvRecord, columns: Columns): Statistics|string {
  if (cells.length !== columns.count) {
    return texts.cell_count(line, cells.length, columns.count);
  }
  const numbers = cells.map((cell) => (cell.trim() === "" ? NaN : Number(cell)));
  const wrong = columns.required.find(([, at]) => !Number.isFinite(numbers[at]));
  if (wrong !== undefined) {
    return texts.not_a_number(line, wrong[0], cells[wrong[1]]!);
  }
  const wrong_account = columns.accounts.find(([, at]) => cells[at] !== "" && !Number.isFinite(numbers[at]));
  if (wrong_account !== undefined) {
    return texts.not_an_account(line, wrong_account[0], cells[wrong_account[1]]!);
  }
  const picked = <Name extends string>(places: readonly Place<Name>[]): {[name in Name]: number} => {
    const made = {} as {[name in Name]: number};
    for (const [name, at] of places) {
      made[name] = numbers[at]!;
    }
    return made;
  };
  const statistics: Statistics = picked(columns.numbers);
  const has = (places: readonly Place[]): boolean =>
    places.length > 0 && places.every(([, at]) => Number.isFinite(numbers[at]));
  if (has(columns.colony)) {
    statistics.colony = picked(columns.colony);
  }
  if (has(columns.predators)) {
    statistics.predators = {colony: picked(columns.predators)};
  }
  for (const [name, least, most] of [["generation", 1, generation_max], ["island", 0, island_max]] as const) {
    if (!Number.isInteger(statistics[name]) || statistics[name] < least || statistics[name] > most) {
      return texts.not_whole(line, name, String(statistics[name]), least, most);
    }
  }
  statistics.genes = columns.genes.map(({parts, account}) => {
    return {...picked(parts), ...(account !== null && has(account) ? {account: picked(account)} : {})};
  });
  return statistics;
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
