// plots_panel: the panel "Plots" and its plots over generations.
import type * as english from "../texts/plots_panel";

import {gene_label} from "./genes";
import {shown_number, three_digits, with_separators} from "./numbers";

const round = (births: boolean): string => (births ? "Intervall" : "Generation");

export const quantity_texts: typeof english.quantity_texts = {
  population: "Bestand",
  phase: "Phasendiagramm",
  fitness: "Fitness",
  genes: "Gene",
  selection: "Selektion",
  diversity: "Vielfalt",
  survivors: "Überlebende",
  deaths: "Todesursachen",
  food: "Futter"
};

export const figure_texts: typeof english.figure_texts = {
  generation: "Generation",
  interval: "Intervall",
  series_of: (series, history) => `${series}, ${history}`,
  deviation: "± 1 Standardabweichung",
  fitness: {
    title: "Fitness",
    y: "Fitness",
    children: "Kinder",
    best: "beste",
    mean: "Mittelwert",
    median: "Median",
    worst: "schlechteste"
  },
  genes: {
    title: "Mittelwerte der Gene",
    of_one: (gene) => `Gen ${gene_label(gene)}`,
    y: "Gen-Einheiten",
    y_of_weights: "Gewicht",
    mean: "Mittelwert",
    greatest: "größter",
    least: "kleinster"
  },
  selection: {
    title: "Selektion der Gene",
    of_one: (gene) => `Ursachen der Änderung des Mittelwerts von ${gene_label(gene)}`,
    y: (births) => `Gen-Einheiten pro ${round(births)}`,
    y_of_weights: (births) => `Gewicht pro ${round(births)}`,
    change: "Änderung",
    selection: "Selektion",
    transmission: "Weitergabe",
    migration: "Migration"
  },
  diversity:
    {title: "Vielfalt", y: "mittlere Standardabweichung, als Anteil am Bereich des Gens", diversity: "Vielfalt"},
  survivors: {title: "Am Ende am Leben", y: "Organismen", alive: "am Ende am Leben", born: "geboren"},
  deaths: {
    title: "Todesursachen",
    y: "Organismen",
    starved: "verhungert",
    poisoned: "vergiftet",
    eaten: "von Räubern gefressen",
    old: "an Altersschwäche",
    alive: "am Ende am Leben"
  },
  population: {
    title: "Bestand",
    y: "lebende Organismen",
    prey: "Beute, Mittelwert",
    prey_lowest: "Beute, wenigste",
    predators: "Räuber, Mittelwert",
    predators_lowest: "Räuber, wenigste"
  },
  food: {
    title: "Gefressenes Futter und Gift",
    y: (births) => `Stück pro ${round(births)}`,
    food: "Futter",
    poison: "Gift"
  },
  values: {title: (gene) => `Werte von ${gene_label(gene)}`, y: "Organismen", organisms: "Organismen", none: "…"},
  all_died: (generation) => `Generation ${generation}: Alle Organismen starben vor ihrem Ende`,
  extinction: "alle gestorben",
  phase: {
    title: "Beute und Räuber",
    prey: "lebende Beute, Mittelwert",
    predators: "lebende Räuber, Mittelwert",
    newest: (generation, prey, predators, births) => `Kreis: ${round(births)} ${with_separators(generation)}, ${
      three_digits(prey)} Beutetiere, ${
      three_digits(predators)} Räuber. Die Linie führt dorthin; ihre älteren Teile sind blasser.`,
  },
};

export const plots_panel_texts: typeof english.plots_panel_texts = {
  title: "Diagramme",
  quantity: "Größe",
  island: "Insel",
  all_islands: "alle Inseln",
  island_name: (island) => `Insel ${island}`,
  running_mean: "Gleitendes Mittel",
  running_mean_help: "Gleitendes Mittel: Jeder Punkt ist das Mittel dieser Generation und der Generationen davor. " +
    "Blasse Linien zeigen jede Generation.",
  each_generation: "jede Generation",
  species: "Art",
  prey: "Beute",
  predators: "Räuber",
  fit: "Einpassen",
  fit_help: "Zeigt alle Generationen.",
  save_csv: "CSV speichern",
  save_csv_help: "Speichert den Verlauf aller Inseln als Tabelle.",
  save_png: "PNG speichern",
  save_png_help: (width, height) => `Speichert das Diagramm als Bild mit ${width} × ${height} Pixeln.`,
  known: (count, last, births) => `${with_separators(count)} ${round(births)}${
    count === 1 ? "" :
      births    ? "e" :
                  "en"}, bis ${shown_number(last)}`,
  none_ended: (births) => `Noch ist kein${births ? "" : "e"} ${round(births)} zu Ende`,
  from_second: (births) => `Bekannt ab ${births ? "dem" : "der"} zweiten ${round(births)}`,
  loading: "…",
  selection_of_all: "Price-Gleichung: wie stark die Selektion den Mittelwert jedes Gens geändert hat. Über 0 hatten " +
    "Organismen mit mehr davon mehr Nachkommen.",
  selection_of_one:
    "Price-Gleichung: Die Änderung des Mittelwerts ist Selektion (welche Organismen Nachkommen hatten) " +
    "+ Weitergabe (Rekombination und Mutation) + Migration.",

  compare: "vergleichen mit",
  nothing: "nichts",
  open_file: "CSV-Datei …",
  open_file_help: "Vergleicht mit der Statistik in einer CSV-Datei dieses Rechners. Die Datei lässt sich auch in den " +
    "Bereich ziehen. Sie verlässt den Browser nicht.",
  compared_file: (file) => `Gestrichelt: ${file}`,
  run: "Lauf der Datei",
  remove: "Entfernen",
  remove_help: (file) => `Entfernt ${file} aus den Diagrammen`,

  gene: "Gen",
  group: "Gruppe von Genen",
  genes_of: (group) => `Gene: ${group}`,
  body: "Körper",
  brain: "Gehirn",
  free: "frei",
  most_changed: (count) => `Mittelwerte der ${count} am stärksten geänderten`,
  most_selected: (count) => `Selektion der ${count} am stärksten geänderten`,
  means_of_group: "Mittelwerte der ganzen Gruppe",
  selection_of_group: "Selektion der ganzen Gruppe",
  means_of_all: "Mittelwerte aller Gene",
  selection_of_genes: "Selektion aller Gene",
  organisms_of: (generation) => `Alle Organismen der Generation ${with_separators(generation)}`,
  organisms_of_island: (generation, island) =>
    `Alle Organismen der Generation ${with_separators(generation)}, Insel ${island}`,
};
