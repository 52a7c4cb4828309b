// history_csv: what is wrong with a table of statistics, and what is allowed.
import {with_separators} from "./numbers";

const writers = "allowed: tables of Save CSV, evoctl history --csv, evoctl export or evod export --what generations, " +
  "evod run --csv or evod sweep, with commas between the cells";
const shown_characters_max = 40; // of a wrong cell

export const history_csv_texts = {
  in_file: (file: string, wrong: string) => `${file}: ${wrong}.`,
  too_large: (mebibytes: number, mebibytes_max: number) =>
    `the file has ${with_separators(mebibytes)} MiB, allowed: at most ${mebibytes_max} MiB`,
  unreadable: (reason: string) => `the browser cannot read the file (${reason})`,
  empty: `the file contains no table; ${writers}`,
  no_rows: (line: number) =>
    `there is no row after the heading in line ${line}; allowed: one row per generation or more`,
  no_column: (line: number, column: string) => `line ${line}: there is no column "${column}"; ${writers}`,
  column_twice: (line: number, column: string) =>
    `line ${line}: there are two columns "${column}"; allowed: each column once`,
  cell_count: (line: number, count: number, allowed: number) =>
    `line ${line} has ${count} ${count === 1 ? "cell" : "cells"}, allowed: ${allowed}, as many as the heading`,
  not_a_number: (line: number, column: string, cell: string) =>
    `line ${line}, ${column}: got "${cell.slice(0, shown_characters_max)}", allowed: a number`,
  not_an_account: (line: number, column: string, cell: string) =>
    `line ${line}, ${column}: got "${cell.slice(0, shown_characters_max)}", allowed: a number or nothing`,
  not_whole: (line: number, column: string, cell: string, least: number, most: number) =>
    `line ${line}, ${column}: got ${cell.slice(0, shown_characters_max)}, allowed: whole numbers from ${
      with_separators(least)} to ${with_separators(most)}`,
  open_quote: (line: number) =>
    `line ${line}: a quote opens a cell and none closes it; allowed: "cell", and "" for a quote`,
  text_after_quote: (line: number) =>
    `line ${line}: there is text after the closing quote of a cell; allowed: a comma or the end of the line`,
  twice: (line: number, generation: number, island: number) =>
    `line ${line}: generation ${with_separators(generation)} of island ${
      island} occurs twice; allowed: once, or once per run if other columns, such as cell and replicate, name the run`,
  run_of_file: (file: string, run: string) => `${file}, ${run}`,
  run: (columns: readonly(readonly[string, string])[]) =>
    columns.map(([column, cell]) => `${column.replaceAll("_", " ")} ${cell}`).join(", "),
};
