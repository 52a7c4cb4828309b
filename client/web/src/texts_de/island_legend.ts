// The legend of the colours of the organisms in the corner of the island.
import type * as english from "../texts/island_legend";

import {gene_label} from "./genes";
import {shown_number, with_separators} from "./numbers";

export const island_legend_texts: typeof english.island_legend_texts = {
  density: (side_px) => `Organismen je ${shown_number(side_px)} × ${shown_number(side_px)} px`,
  health: "Gesundheit, Punkte",
  gene: (name) => gene_label(name) +
    (name === "food_radius" || name === "poison_radius" ? ", px" :
       name.includes("<")                               ? "" :
                                                          ", Gen-Einheiten"),
  unknown_lineages: "Abstammung noch unbekannt",
  lineages: "Abstammung, ab Generation 1",
  lineage: (founder, count) => `Nachkommen von Organismus ${with_separators(founder)}: ${with_separators(count)}`,
  smaller_lineages: (lineages, count) => `${with_separators(lineages)} kleinere Linien: ${with_separators(count)}`,
  placed: (count) => `von Hand eingesetzt, und ihre Nachkommen: ${with_separators(count)}`,
  food_radius: "Sichtweite für Futter",
  poison_radius: "Sichtweite für Gift",
  networks: "vom Netz gesteuert; ein Pfeil von 30 px ist 100 kg px/s²",
  seeks: "sucht Futter",
  flees_both: "flieht vor Gift oder einem Räuber",
  flees: "flieht vor Gift",
  wanders: "streift umher; ein Pfeil von 30 px ist 100 kg px/s²",
};
