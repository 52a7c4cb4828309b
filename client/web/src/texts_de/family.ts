// Texts of the panel "Family tree".
import type * as english from "../texts/family";

import {choice_text, counted} from "./breeding";
import {fitness_text, three_digits, with_separators} from "./numbers";

type Named = Parameters<typeof english.family_texts.mark_another>[0];

function of_island(island: number): string {
  return island > 0 ? ` der Insel ${island}` : "";
}

/** "Organismus 17 der Generation 40" */
function name(organism: Named): string {
  return `Organismus ${organism.organism}${of_island(organism.island)} der Generation ` +
    with_separators(organism.generation);
}

/** "Organismen 3, 17 und 4 weiteren" */
function names(organisms: readonly Named[]): string {
  const shown = organisms.slice(0, 5).map(({organism, island}) => `${organism}${of_island(island)}`);
  const rest = organisms.length - shown.length;
  const last = rest > 0 ? `${with_separators(rest)} weiteren` : shown.pop()!;
  return `${organisms.length === 1 ? "Organismus" : "Organismen"} ` +
    (shown.length === 0 ? last : `${shown.join(", ")} und ${last}`);
}

function earlier(generations: number): string {
  return `${counted(generations, "Generation", "Generationen")} früher`;
}

export const family_texts: typeof english.family_texts = {
  title: "Stammbaum",
  subject: "Was gezeigt wird",
  ancestors: "Vorfahren eines Organismus",
  whole: "ganze Generation",
  generations: "Generationen",
  generation_count: (count) => `${count} Generationen`,
  both_parents: "beide Eltern",
  order: "Reihenfolge",
  order_lines: "Folge: wenige Kreuzungen",
  order_fitness: "Folge: fitteste zuerst",
  colours: "Farben",
  colour_nothing: "Farben: keine",
  colour_lineage: "Farben: Abstammung",
  colour_fitness: "Farben: Fitness",
  colour_gene: (gene) => `Farben: ${gene}`,
  retry: "Noch einmal",
  loading: "Wird geladen …",
  zoom_in: "Vergrößern (+)",
  zoom_out: "Verkleinern (−)",
  fit: "Einpassen",
  fit_title: "Ganze Breite zeigen (0)",
  mark: "Zum Vergleich markieren (M)",
  unmark: "Markierung entfernen (M)",
  no_marks: "Beide Markierungen entfernen",

  heading_ancestors: (organism, generation) =>
    `Vorfahren von Organismus ${organism} der Generation ${with_separators(generation)}`,
  heading_whole: (generation, island) =>
    `Generation ${with_separators(generation)}${of_island(island)} und ihre Vorfahren`,
  tree_of_organism: (organism) => `Baum von Organismus ${organism}`,
  tree_of_generation: (generation) => `Baum der Generation ${with_separators(generation)}`,
  select_first: "Einen Organismus auswählen, um seine Vorfahren zu sehen.",
  no_world: "Warten auf die erste Momentaufnahme …",
  unknown: (problem) => `Die Vorfahren sind unbekannt: ${problem}.`,
  not_stored: "Von dieser Generation ist kein Organismus gespeichert.",

  drawing: (generations, organisms) => `Stammbaum über ${counted(generations, "Generation", "Generationen")} mit ` +
    `${counted(organisms, "Organismus", "Organismen")}. Pfeiltasten gehen zu Verwandten, die Eingabetaste zeigt den ` +
    "Moment, M markiert einen Organismus zum Vergleich. Die Tabelle darunter enthält dieselben Organismen.",
  loaded: (organisms, bytes) =>
    `Geladen: ${counted(organisms, "Organismus", "Organismen")}, ${three_digits(bytes / 1e6)} MB.`,
  limited: (shown, wanted, organisms_max) =>
    `Nur die letzten ${shown} von ${wanted} Generationen sind zu sehen: Ein Baum darf etwa ` +
    `${with_separators(organisms_max)} Organismen haben.`,
  left_out: (generations) =>
    `${counted(generations, "Generation fehlt", "Generationen fehlen")}, weil die Laufdatei die Organismen nicht ` +
    "enthält.",
  loading_genes: (loaded, all) => `Gene: ${loaded} von ${all} Generationen geladen …`,
  genes_limited: (generations, values_max) =>
    `Die Gene der letzten ${counted(generations, "Generation", "Generationen")} sind geladen: höchstens ` +
    `${with_separators(values_max)} Zahlen.`,
  genes_unknown: (problem) => `Die Gene sind unbekannt: ${problem}.`,

  organism: ({generation, island, organism, parents, origin, fitness, child_count, kept_count}) => {
    const named =
      parents.map((parent) => `${parent.organism}${parent.island === island ? "" : ` der Insel ${parent.island}`}`)
        .join(" und ");
    const kind = parents.length === 0 ? (origin === "placed" ? "von Hand eingesetzt" : "ohne bekannte Eltern") :
      origin === "elite"              ? `aus der Elite, Kopie von ${named}` :
                   origin === "survivor" ? `überlebt, Kopie von ${named}` :
                                           `Kind von ${named}`;
    const next = [
      ...(child_count > 0 ? [counted(child_count, "Kind", "Kinder")] : []),
      ...(kept_count > 0 ? [counted(kept_count, "Kopie", "Kopien")] : []),
    ].join(" und ");
    return `Organismus ${organism} der Generation ${with_separators(generation)}` +
      `${island > 0 ? `, Insel ${island}` : ""}: ${kind}` +
      (fitness === null ? "" : `, Fitness ${fitness_text(fitness)}`) +
      (next ? `; ${next} in der nächsten Generation` : "") + ".";
  },
  of_lineage: (founder) => ` Abstammung: ${name(founder)}.`,
  gene_value: (gene, value) => ` ${gene}: ${value}.`,
  is_ancestor_of_all: " Ein gemeinsamer Vorfahr aller.",
  is_ancestor_of_both: " Ein gemeinsamer Vorfahr der beiden markierten Organismen.",
  is_marked: (letter) => ` Markiert als ${letter}.`,

  changed_genes: (changes, more) => changes.length === 0 ?
    "Kein Gen ist mutiert." :
    `Mutierte Gene: ${
      changes.map(({gene, before, after, how}) => `${gene} ${before} → ${after} (${how})`).join("; ")}` +
      (more > 0 ? `; und ${with_separators(more)} weitere.` : "."),
  order_mutated: (method) => ` Die Reihenfolge der Gene ist mutiert (${choice_text(method)}).`,
  loading_changes: "Geänderte Gene werden geladen …",
  changes_unknown: (problem) => `Die geänderten Gene sind unbekannt: ${problem}.`,

  all_descend_from: (count, generation, ancestors, first_parents) =>
    `${first_parents ? "Entlang der ersten Eltern stammen alle" : "Alle"} ${with_separators(count)} Organismen der ` +
    `Generation ${with_separators(generation)}${first_parents ? "" : " stammen"} von ${names(ancestors)} der ` +
    `Generation ${with_separators(ancestors[0]!.generation)} ab, ${earlier(generation - ancestors[0]!.generation)}: ` +
    (ancestors.length === 1 ? "ihrem jüngsten gemeinsamen Vorfahren." : "ihren jüngsten gemeinsamen Vorfahren."),
  all_are_ancestors: (generation) =>
    ` Bis Generation ${with_separators(generation)} ist jeder Organismus des Baums ein Vorfahr aller.`,
  no_ancestor_of_all: (count, generation, since, first_parents) =>
    `Die ${with_separators(count)} Organismen der Generation ${with_separators(generation)} haben ` +
    `${first_parents ? "entlang der ersten Eltern " : ""}seit Generation ${
      with_separators(since)} keinen gemeinsamen ` +
    "Vorfahren.",
  mark_two: "Zwei Organismen markieren (M, oder Umschalt und Klick), um ihre gemeinsamen Vorfahren zu finden.",
  mark_another: (one) =>
    `A: ${name(one)}. Einen weiteren Organismus markieren, um die gemeinsamen Vorfahren zu finden.`,
  marked: (one, other) => `A: ${name(one)}. B: ${name(other)}. `,
  two_descend_from: (ancestors) =>
    `${ancestors.length === 1 ? "Jüngster gemeinsamer Vorfahr" : "Jüngste gemeinsame Vorfahren"} beider: ${
      names(ancestors)} der Generation ` +
    `${with_separators(ancestors[0]!.generation)}.`,
  one_descends_from_other: (ancestor, descendant) => `${ancestor} ist ein Vorfahr von ${descendant}.`,
  two_have_none: (since) => `Sie haben seit Generation ${with_separators(since)} keinen gemeinsamen Vorfahren.`,

  legend: "Farben der Organismen",
  legend_lineages: (generation) => `Abstammung seit Generation ${with_separators(generation)}:`,
  legend_lineage: (founder, count) => `${founder.organism}${of_island(founder.island)} (${with_separators(count)})`,
  legend_others: (lineages, count) =>
    `${counted(lineages, "kleinere Linie", "kleinere Linien")} (${with_separators(count)})`,
  legend_grey: "grau: andere Linien",
  legend_unknown: (count) => `unbekannt: ${counted(count, "Organismus", "Organismen")}`,

  help_lines:
    "Dicke Linien führen zu den ersten Eltern, die mindestens die Hälfte der Gene gaben; dünne Linien führen zu den " +
    "zweiten Eltern. Gefüllt: Kinder; hohl: Kopien (Überlebende, Elite); Raute: Der erste Elternteil lebte auf einer " +
    "anderen Insel; doppelter Ring: gemeinsamer Vorfahr.",
  help_keys:
    "Ein Klick auf einen Organismus zeigt den Anfang seiner Generation. Strg und das Mausrad zoomen; Ziehen bewegt " +
    "den Baum. Mit der Tastatur: Pfeiltasten (Umschalt und ↑: zweiter Elternteil), Pos1, Ende, Eingabe, M, +, −, 0.",

  table: "Die Organismen als Tabelle",
  table_of: "Generation der Tabelle",
  table_rows: (first, last, all) =>
    `Zeilen ${with_separators(first)} bis ${with_separators(last)} von ${with_separators(all)}`,
  table_columns: ["Organismus", "Art", "Eltern", "Fitness", "Kinder", "Kopien", "gemeinsamer Vorfahr"],
  on_island: (organism, island) => `${organism} der Insel ${island}`,
  table_ancestor_of_all: "aller",
  table_ancestor_of_both: "von A und B",
  previous_rows: "Vorige Zeilen",
  next_rows: "Nächste Zeilen",
  kinds: {initial: "erste Generation", elite: "Elite", survivor: "überlebt", child: "Kind", placed: "eingesetzt"},

  no_column: (column) => `die Abstammungstabelle hat keine Spalte ${column}`,
  wrong_row: (line) => `die Abstammungstabelle hat eine Zeile ohne Organismus: ${line}`,
};
