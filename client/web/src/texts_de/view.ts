// Texts of the panel "View".
import type * as english from "../texts/view";

import {gene_name} from "./genes";

export const view_texts: typeof english.view_texts = {
  language: "Sprache (language)",
  languages: {"": "automatisch (automatic)", en: "English", de: "Deutsch"},
  skin: "Stil",
  skins: {vivid: "lebhaft", classic: "klassisch"},
  background: "Hintergrund",
  backgrounds: {dark: "dunkel", light: "hell"},
  colour_by: "färben nach (C)",
  by_nothing: "nichts",
  by_nothing_vivid: "nichts (hell: gesund)",
  by_health: "Gesundheit",
  by_lineage: "Abstammung",
  by_gene: (gene) => `Gen ${gene_name(gene)}`,
  palette: "Farbskala",
  palettes: {violet: "violett", viridis: "viridis", cividis: "cividis"},
  lineages: "Die Abstammung zählt ab der ersten Generation. Hat sich eine Linie durchgesetzt, haben alle Organismen " +
    "ihre Farbe.",
  perception: "Sichtweiten (V)",
  forces: "Kräfte (G)",
  of_which: {none: "keine", selected: "Maus oder Auswahl", all: "alle"},
  switches: {
    trails: "Spuren der letzten 3 simulierten Sekunden (T)",
    flashes: "Aufleuchten bei Fressen und Tod",
    density: "Dichtekarte, wo es zu viele Organismen sind",
    minimap: "Übersichtskarte beim Vergrößern",
    interpolate: "fließende Bewegung zwischen Momentaufnahmen",
  },
  follow: "ausgewählten Organismus in der Mitte halten (L)",
  select_first: "Ein Klick auf einen Organismus wählt ihn aus.",
};
