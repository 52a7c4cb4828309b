// Texts about the panels themselves: the titles of those that are loaded later, and why one is not shown yet.
import type * as english from "../texts/panels";

export const panels_texts: typeof english.panels_texts = {
  worlds: "Welten",
  run: "Lauf",
  parameters: "Parameter",
  view: "Ansicht",
  organism: "Organismus",
  glass_box: "Glaskasten",
  family: "Stammbaum",
  plots: "Diagramme",
  physics: "Physik",
  lesson: "Lektion",
  freezer: "Gefrierfach",
  class: "Klasse",
  loading: "Wird geladen …",
  not_loaded: (why) => `Der Bereich kann nicht geladen werden: ${why}.`,
};
