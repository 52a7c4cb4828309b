// What people read in and above an island: its name, hints, tiles of all islands, the views of two worlds.
import type * as english from "../texts/pane";

import {fitness_text, tenths, with_separators} from "./numbers";

export type{LabelWidth, ToolButton} from "../texts/pane";

function alive_organisms(count: number): string {
  return count === 1 ? "1 Organismus lebt" : `${with_separators(count)} Organismen leben`;
}

export const pane_texts: typeof english.pane_texts = {
  frozen: "angehalten",
  kind: "Insel",
  shown: "Gezeigte Welten",
  no_webgl: "Dieser Browser kann die Insel nicht zeichnen, weil WebGL 2 fehlt oder ausgeschaltet ist. Die Bereiche " +
    "zeigen die Welt wie gewohnt.",
  no_world: "Keine Welt wird gezeigt",
  island: (island, world, alive) =>
    `Insel ${island} der Welt ${world}${alive}. Pfeiltasten bewegen die Ansicht, 0 zeigt die ganze Insel.`,
  alive: (generation, alive) => `, Generation ${with_separators(generation)}, ${alive_organisms(alive)}`,
  start: "▶ Starten",
  start_help: "Macht mit und startet diese Welt.",
  waiting: "Warten auf die erste Momentaufnahme …",
  world: "Welt",
  world_named: (name, is_replay) => `Welt ${name}${is_replay ? ", Wiedergabe" : ""}`,
  generation: (generation, has_births) =>
    `${has_births ? "Intervall" : "Generation"} ${with_separators(generation)}`,
  replay_of: (world) => `WIEDERGABE von ${world}`,
  a_file: "eine Datei",
  not_connected: "nicht verbunden",
  silent: (seconds) => `seit ${seconds} s keine Daten`,
  end_of_replay: "Ende der Wiedergabe",
  slower: " langsamer",
  close: "Diese Welt schließen",
  beside: "Eine zweite Welt wählen und neben dieser zeigen (B)",
};

export const tile_texts: typeof english.tile_texts = {
  show: "Alle Inseln",
  show_help: (islands) => `Zeigt alle ${with_separators(islands)} Inseln zugleich (I).`,
  hide_help: (island) => `Zeigt nur Insel ${island} (I, Esc).`,
  back_help: "Kehrt zu allen Inseln zurück (I, Esc).",
  too_many: (islands, most) =>
    `Diese Welt hat ${with_separators(islands)} Inseln; höchstens ${most} lassen sich zugleich zeigen.`,
  only_one: "Diese Welt hat nur eine Insel.",
  group: (world) => `Alle Inseln der Welt ${world}. Pfeiltasten wählen eine Insel, die Eingabetaste zeigt nur diese.`,
  name: (island, width) => width === "wide" ? `Insel ${island}` : String(island),
  facts: (alive, fitness, width) => with_separators(alive) + (width === "narrow" ? "" : " am Leben") +
    (width === "wide" && fitness !== null ? ` · Fitness ${fitness_text(fitness)}` : ""),
  waiting: (island) => `Insel ${island}. Warten auf die erste Momentaufnahme.`,
  label: (island, generation, alive, health, fitness) =>
    `Insel ${island}: Generation ${with_separators(generation)}, ${alive_organisms(alive)}, ` +
    `mittlere Gesundheit ${tenths(health)}` +
    (fitness === null ? "" : `, mittlere Fitness der Generation davor ${fitness_text(fitness)}`) + ".",
};

export const link_texts: typeof english.link_texts = {
  name: "Ansichten koppeln",
  help: "Beide Welten bewegen sich und zoomen gemeinsam (K).",
  linked: "Beide Welten bewegen sich und zoomen gemeinsam.",
  unlinked: "Jede Welt bewegt sich und zoomt für sich.",
  one_world: "Nur eine Welt wird gezeigt; B zeigt eine zweite.",
};

export const tool_texts: typeof english.tool_texts = {
  group: "Klick",
  no_place: "Dieser Server kann nichts einsetzen oder entfernen; eine neuere Version von evod kann es.",
  no_world: "Keine Welt ist offen.",
  is_replay: "Eine Wiedergabe kann nicht geändert werden; eine Abzweigung davon schon.",
  no_organism: "Einen Organismus auswählen, um Kopien von ihm einzusetzen.",
  copy_of: (organism) => `Kopie von Organismus ${organism}`,
  nothing_to_remove: "Hier ist nichts zu entfernen",
  place: {food: "Futter einsetzen", poison: "Gift einsetzen"},
  place_organism: (name) => `${name ?? "Organismus"} einsetzen`,
  remove_organism: (organism) => `Organismus ${organism} entfernen`,
  remove: {food: "Futter entfernen", poison: "Gift entfernen"},
};

export const tool_buttons: typeof english.tool_buttons = [
  {tool: "select", label: "Auswahl", help: "Ein Klick auf die Insel wählt den Organismus dort aus (Esc)."},
  {
    tool: "food",
    label: "Futter",
    help: "Ein Klick auf die Insel setzt Futter ein. Gefressen erscheint es nicht wieder."
  },
  {tool: "poison", label: "Gift", help: "Ein Klick auf die Insel setzt Gift ein. Gefressen erscheint es nicht wieder."},
  {
    tool: "organism",
    label: "Organismus",
    help: "Ein Klick auf die Insel setzt eine Kopie des ausgewählten Organismus ein."
  },
  {
    tool: "remove",
    label: "Entfernen",
    help: "Ein Klick auf die Insel nimmt den Organismus, das Futter oder das Gift dort weg, bis die " +
      "Generation endet."
  },
];
