// history_csv: what is wrong with a table of statistics, and what is allowed.
import type * as english from "../texts/history_csv";

import {with_separators} from "./numbers";

const writers = "erlaubt: Tabellen von „CSV speichern“, evoctl history --csv, evoctl export oder evod export --what " +
  "generations, evod run --csv oder evod sweep, mit Kommas zwischen den Zellen";
const shown_characters_max = 40; // of a wrong cell

export const history_csv_texts: typeof english.history_csv_texts = {
  in_file: (file, wrong) => `${file}: ${wrong}.`,
  too_large: (mebibytes, mebibytes_max) =>
    `die Datei hat ${with_separators(mebibytes)} MiB, erlaubt: höchstens ${mebibytes_max} MiB`,
  unreadable: (reason) => `der Browser kann die Datei nicht lesen (${reason})`,
  empty: `die Datei enthält keine Tabelle; ${writers}`,
  no_rows: (line) =>
    `nach der Kopfzeile in Zeile ${line} kommt keine Zeile; erlaubt: mindestens eine Zeile je Generation`,
  no_column: (line, column) => `Zeile ${line}: Es gibt keine Spalte „${column}“; ${writers}`,
  column_twice: (line, column) => `Zeile ${line}: Es gibt zwei Spalten „${column}“; erlaubt: jede Spalte einmal`,
  cell_count: (line, count, allowed) =>
    `Zeile ${line} hat ${count} ${count === 1 ? "Zelle" : "Zellen"}, erlaubt: ${allowed}, so viele wie die Kopfzeile`,
  not_a_number: (line, column, cell) =>
    `Zeile ${line}, ${column}: „${cell.slice(0, shown_characters_max)}“, erlaubt: eine Zahl`,
  not_an_account: (line, column, cell) =>
    `Zeile ${line}, ${column}: „${cell.slice(0, shown_characters_max)}“, erlaubt: eine Zahl oder nichts`,
  not_whole: (line, column, cell, least, most) =>
    `Zeile ${line}, ${column}: ${cell.slice(0, shown_characters_max)}, erlaubt: ganze Zahlen von ${
      with_separators(least)} bis ${with_separators(most)}`,
  open_quote: (line) =>
    `Zeile ${
      line}: Ein Anführungszeichen öffnet eine Zelle, und keines schließt sie; erlaubt: "Zelle", und "" für ein ` +
    "Anführungszeichen",
  text_after_quote: (line) =>
    `Zeile ${line}: Nach dem schließenden Anführungszeichen einer Zelle steht Text; erlaubt: ` +
    "ein Komma oder das Ende der Zeile",
  twice: (line, generation, island) =>
    `Zeile ${line}: Generation ${with_separators(generation)} der Insel ${
      island} kommt zweimal vor; erlaubt: einmal, oder einmal je Lauf, wenn andere Spalten wie cell und replicate ` +
    "den Lauf benennen",
  run_of_file: (file, run) => `${file}, ${run}`,
  run: (columns) => columns.map(([column, cell]) => `${column.replaceAll("_", " ")} ${cell}`).join(", "),
};
