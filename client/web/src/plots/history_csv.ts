// history_csv: the statistics of a run as CSV, with the columns of `evod export --what generations`. Pure functions.
import type {Message} from "../core/messages";

const numbers = [
  "generation",   "island",       "end_tick",       "simulated_s",       "organism_count",
  "fitness_best", "fitness_mean", "fitness_median", "fitness_worst",     "fitness_deviation",
  "diversity",    "alive_count",  "starved_count",  "poisoned_count",    "food_eaten",
  "poison_eaten", "clamp_count",  "too_fast_count", "speed_limit_count", "best_organism"
];
const gene_parts = ["mean", "deviation", "min", "max"];
const account_parts = ["selection", "transmission", "migration", "change"];

/** Returns the table of GenerationStatistics messages, with a heading. */
export function history_csv(history: readonly Message[], gene_names: readonly string[]): string {
  const of_genes = (parts: readonly string[]): string[] =>
    gene_names.flatMap((gene) => parts.map((part) => `${gene}_${part}`));
  const lines = [[...numbers, ...of_genes(gene_parts), ...of_genes(account_parts)].join(",")];
  for (const one of history) {
    const genes = gene_names.map((_, i) => one.genes?.[i] as Message | undefined);
    lines.push([
      ...numbers.map((name) => one[name] ?? 0),
      ...genes.flatMap((gene) => gene_parts.map((part) => gene?.[part] ?? 0)),
      ...genes.flatMap((gene) => account_parts.map((part) => (gene?.account ? gene.account[part] ?? 0 : ""))),
    ].join(","));
  }
  return `${lines.join("\n")}\n`;
}

/** Reads a table in any order of columns. Returns the statistics, ordered by generation, or a sentence that names the wrong line. */
export function read_history_csv(text: string): {history: Message[]; gene_names: string[]}|string {
  const [first = "", ...lines] = text.replace(/^\ufeff/, "").split(/\r?\n/);
  const heading = cells_of(first);
  const gene_names = heading.filter((name) => name.endsWith("_mean") && name !== "fitness_mean")
                       .map((name) => name.slice(0, -"_mean".length));
  const required = [...numbers, ...gene_names.flatMap((gene) => gene_parts.map((part) => `${gene}_${part}`))];
  const missing = required.find((name) => !heading.includes(name));
  if (missing !== undefined) {
    return `line 1: there is no column ${missing}; the columns must be those of evoctl export --what generations`;
  }
  const place = new Map(heading.map((name, i) => [name, i]));
  const history: Message[] = [];
  for (const [i, line] of lines.entries()) {
    if (line === "") {
      continue;
    }
    const cells = cells_of(line), at = `line ${i + 2}`;
    if (cells.length !== heading.length) {
      return `${at} has ${cells.length} cells, allowed: ${heading.length}, as many as the heading`;
    }
    const wrong =
      required.find((name) => cells[place.get(name)!] === "" || !Number.isFinite(Number(cells[place.get(name)!])));
    if (wrong !== undefined) {
      return `${at}, ${wrong}: must be a number, not "${cells[place.get(wrong)!]!.slice(0, 40)}"`;
    }
    const number = (name: string): number => Number(cells[place.get(name)!]);
    const island = number("island");
    if (!Number.isInteger(island) || island < 0 || island > 65535) {
      return `${at}, island: must be a whole number from 0 to 65535, not ${island}`;
    }
    if (!Number.isInteger(number("generation")) || number("generation") < 1) {
      return `${at}, generation: must be a whole number from 1, not ${number("generation")}`;
    }
    const account = (gene: string): Message|undefined => {
      const texts = account_parts.map((part) => cells[place.get(`${gene}_${part}`) ?? -1] ?? "");
      return texts.every((cell) => cell !== "" && Number.isFinite(Number(cell))) ?
        Object.fromEntries(account_parts.map((part, n) => [part, Number(texts[n])])) :
        undefined;
    };
    history.push({
      ...Object.fromEntries(numbers.map((name) => [name, number(name)])),
      genes: gene_names.map((gene) => ({
                              ...Object.fromEntries(gene_parts.map((part) => [part, number(`${gene}_${part}`)])),
                              account: account(gene)
                            })),
    });
  }
  history.sort((a, b) => a.generation - b.generation);
  return {history, gene_names};
}

function cells_of(line: string): string[] {
  return line.split(",").map((cell) => (/^".*"$/.test(cell) ? cell.slice(1, -1) : cell));
}
