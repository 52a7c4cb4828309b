// Texts of the panel "Freezer" and of files with chromosomes.
import type * as english from "../texts/freezer";

import {localised, with_separators} from "./numbers";

const counted = (count: number, one: string, many: string): string =>
  `${with_separators(count)} ${count === 1 ? one : many}`;
const mebibytes = (bytes: number): string =>
  bytes > 0 && bytes < 52_429 ? "weniger als 0,1" : localised((bytes / (1 << 20)).toFixed(1).replace(/\.0$/, ""));
const organisms = (count: number): string => counted(count, "Organismus", "Organismen");
const genes = (count: number): string => counted(count, "Gen", "Gene");

export const freezer_texts: typeof english.freezer_texts = {
  title: "Gefrierfach",
  about: "Bewahrt Organismen und ganze Populationen in diesem Browser auf, um sie mit anderen zu vergleichen und " +
    "später Kopien in beliebige Welten einzusetzen.",

  name: "Name",
  as: "als",
  name_hint: "leer: Welt, Generation",
  keep: "Behalten",
  keep_selected: "Auswahl",
  keep_selected_help: "Bewahrt die Gene des ausgewählten Organismus auf.",
  keep_healthiest: "Gesündester",
  keep_healthiest_help: "Bewahrt die Gene des Organismus auf, der jetzt am gesündesten ist.",
  keep_population: "Population",
  keep_population_help: "Bewahrt die Gene aller Organismen der gezeigten Generation auf, von allen Inseln, lebend " +
    "und tot. Die Zeitleiste zeigt frühere Generationen.",
  open_files: "Dateien öffnen …",
  open_files_help: "Öffnet CSV-Dateien mit Chromosomen. Sie lassen sich auch in diesen Bereich ziehen.",
  no_selection: "Kein Organismus ist ausgewählt: einen auf der Insel anklicken.",
  none_alive: "Kein Organismus lebt.",
  kept: (name, count) => `${organisms(count)} als ${name} aufbewahrt.`,
  busy: "Wird gelesen …",

  list: "Aufbewahrte Organismen und Populationen",
  list_headings: ["Name", "Inhalt", "Herkunft"],
  nothing: "Noch ist nichts aufbewahrt.",
  content: (count, islands, gene_count) =>
    `${organisms(count)}${islands > 1 ? ` auf ${with_separators(islands)} Inseln` : ""}, ${
      count === 1 ? "" : "je "}${genes(gene_count)}`,
  from_organism: (world, generation, island, organism) =>
    `${world}, Generation ${with_separators(generation)}, Insel ${island}, Organismus ${organism}`,
  from_population: (world, generation) => `${world}, Generation ${with_separators(generation)}`,
  from_file: (file) => `Datei ${file}`,
  usage: (count, bytes, bytes_max) =>
    `${with_separators(count)} aufbewahrt, ${mebibytes(bytes)} von ${mebibytes(bytes_max)} MiB.`,
  where: (address) => `Sie liegen nur in diesem Browser und nur für ${address}. Zum Verwenden an anderer Stelle, ` +
    "oder bevor die Daten des Browsers gelöscht werden, als Dateien herunterladen.",

  cannot_place: "Dieser Server kann nichts einsetzen; eine neuere Version von evod kann es.",
  replay: "Eine Wiedergabe kann nicht geändert werden; eine Abzweigung davon schon.",
  place: "Mit Klicks einsetzen",
  place_help: "Jeder Klick auf die Insel setzt dann eine Kopie ein. Esc beendet das.",
  placing: (name) => `Auf die Insel klicken, um einzusetzen: ${name}. Esc beendet das.`,
  copies: "Kopien",
  scatter: "Zufällig verteilen",
  scatter_help: "Setzt so viele Kopien auf die gezeigte Insel, dorthin, wo nichts im Weg ist.",
  scattered: (name, count, world, island) =>
    `${counted(count, "Kopie", "Kopien")} von ${name} in ${world} eingesetzt, Insel ${island}.`,
  no_room: (placed, wanted) =>
    `${with_separators(placed)} von ${counted(wanted, "Kopie", "Kopien")} eingesetzt: ` +
    "Für die nächste war kein freier Platz zu finden.",
  create: "Neue Welt …",
  create_help: "Erzeugt eine Welt, deren erste Generation diese Population ist.",
  create_copies_help: "Erzeugt eine Welt, deren erste Organismen Kopien von diesem sind.",
  download: "Herunterladen",
  download_help: (file) => `Speichert ${file}; evod und evoctl können die Datei öffnen.`,
  rename: "Umbenennen …",
  new_name: "Neuer Name",
  do_rename: "Umbenennen",
  remove: "Löschen …",
  ask_remove: (name) => `${name} löschen? Das lässt sich nicht rückgängig machen.`,
  do_remove: "Endgültig löschen",
  island: "Insel",
  organism: "Organismus",
  organism_name: (entry, island, organism, islands) =>
    `Organismus ${organism} von ${entry}${islands > 1 ? `, Insel ${island}` : ""}`,
  a_copy_of: (name) => `Kopie von ${name}`,

  gene_table: "Gene des aufbewahrten Organismus",
  gene_headings: ["Gen", "aufbewahrt"],
  difference: "Unterschied",
  range_heading: "kleinster…größter",
  nothing_to_compare: "Einen Organismus auf der Insel auswählen, um seine Gene zu vergleichen.",
  other: (organism) => `Organismus ${organism}`,
  equal: (organism, common) => 
    `Organismus ${organism} hat ${common === 1 ? "dasselbe Gen" : `dieselben ${genes(common)}`}.`,
  different: (organism, different, common) =>
    `Organismus ${organism} unterscheidet sich in ${with_separators(different)} von ${
      counted(common, "Gen", "Genen")}.`,
  not_common: (missing) => ` Ihm fehlen ${genes(missing)} des aufbewahrten.`,
  further_genes: (count) => counted(count, "weiteres Gen", "weitere Gene"),
  genes_left_out: (count) => `und ${with_separators(count)} weitere, die die heruntergeladene Datei enthält`,

  wrong_line: (line, got, allowed) =>
    `Zeile ${with_separators(line)}: „${got}“ ist nicht möglich, erlaubt: ${allowed}`,
  not_csv: (line) => `Zeile ${with_separators(line)}: Eine Zelle in Anführungszeichen endet nicht richtig`,
  heading: "eine Kopfzeile mit island, organism und einmal dem Namen jedes Gens, in beliebiger Reihenfolge",
  row: (gene_count, allowed, got) => `eine Insel, ein Organismus und ${genes(gene_count)}, also ${allowed} Zellen, ` +
    `nicht ${
                              got}` +
    (got > allowed ? "; bei Dezimalkommas müssen Semikolons oder Tabulatoren die Zellen trennen" : ""),
  cell: (column, choices) =>
    `${column === "island" || column === "organism" ? "eine ganze Zahl" : "eine Zahl"}${
      choices.length > 0 ? `, oder eines von ${choices.join(", ")}` : ""} (Spalte ${column})`,
  no_organism: "es ist kein Organismus darin",
  of_file: (file, problem) => `${file}: ${problem}.`,
  file_too_large: (bytes, bytes_max) =>
    `die Datei hat ${with_separators(bytes)} Byte, erlaubt sind höchstens ${with_separators(bytes_max)}`,
  too_short: "Die Generationen sind zu kurz, um eine ganze zu lesen. Zuerst die Welt anhalten oder in der Zeitleiste " +
    "eine frühere Generation zeigen.",
  incomplete: (world) => `Die Antwort des Servers über die Population von ${world} ist unvollständig.`,
  gone: (name) => `${name} ist nicht mehr da: Vielleicht wurde es in einem anderen Tab gelöscht.`,
  forbidden: (why) => `Dieser Browser lässt die Seite nichts speichern${why ? `: ${why}` : ""}.`,
  browser_full: "Dieser Browser hat keinen Platz mehr für diese Seite: Wichtiges als Dateien herunterladen und dann " +
    "hier löschen.",
  too_many: (most) =>
    `Das Gefrierfach ist voll: Es hat ${with_separators(most)} Einträge, mehr sind nicht erlaubt. ` +
    "Zuerst einige löschen.",
  full: (bytes, free, most) =>
    `Das Gefrierfach ist voll: Die Gene brauchen ${mebibytes(bytes)} MiB, frei sind ${mebibytes(free)} von ${
      mebibytes(most)} MiB. Zuerst einige Einträge herunterladen und löschen.`,
};
