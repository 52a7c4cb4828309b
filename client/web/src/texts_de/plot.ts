// plot: what a plot says itself, whatever it shows, and the fitness curve of the column.
import type * as english from "../texts/plot";

import {shown_number, with_separators} from "./numbers";

export const plot_texts: typeof english.plot_texts = {
  role: "Diagramm",
  no_numbers: "keine Zahlen",
  described: (title, hint) => `${title}: ${hint}`,
  keys: (chooses) => `Pfeil links und rechts lesen die Zahlen; ${
    chooses ? "die Eingabetaste wählt eine Generation; " : ""}Plus und Minus zoomen; 0 zeigt alles`,
  shows_or_hides: (series) => `Zeigt oder verbirgt ${series}`,

  value: (series, value) => `${series}: ${value}`,
  band: (low, high) => `${low} bis ${high}`,
  smoothed: (raw, mean_name, mean) => `${raw} (${mean_name}: ${mean})`,
  mean: "Mittel",
  mean_of: (window) => `Mittel der letzten ${window} Generationen`,
  mark_of: (mark, history) => `${mark} (${history})`,
  more: (count) => `und ${with_separators(count)} weitere`,

  generation: "Generation",
  fitness: "Fitness",
  best: "beste",
  curve_title: (generation, births) =>
    `${births ? "Kinder, Intervall" : "Fitness, Generation"} ${shown_number(generation)}`,
  no_curve: "Fitness: Die Kurve beginnt, wenn die erste Generation endet",
  changed: (generation, values, actor) => `Generation ${generation}: ${values}, von ${actor}`,
  click_shows: (first) => `Ein Klick zeigt diese Generation in einer Wiedergabe${
    first > 1 ? `, ab Generation ${with_separators(first)}` : ""}.`,
  begins: (generation) => `Der Lauf dieser Welt lässt sich ab Generation ${with_separators(generation)} zeigen.`,
};
