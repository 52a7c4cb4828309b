// Texts of the panel "Worlds".
import type * as english from "../texts/worlds";

import {with_separators} from "./numbers";

export const worlds_texts: typeof english.worlds_texts = {
  table: "Welten des Servers",
  headings: ["Welt", "Zustand", "Generation", "Tick", "Tempo"],
  damaged: "beschädigt",
  slower: (speed) => `${speed} (langsamer)`,
  create: "Neue Welt …",
  create_help: "Erzeugt eine weitere Welt.",
  fork: "Abzweigen …",
  fork_help: "Erzeugt eine Welt, die beim gezeigten Tick beginnt.",
  remove: "Löschen …",
  return_first: "Die gezeigte Welt ist eine Wiedergabe; zuerst zur laufenden Welt zurückkehren.",
  ask_remove: (world) => `Welt ${world} löschen? Sie endet für alle.`,
  file_stays: "Speichert der Server Läufe, bleibt die Laufdatei in ihrem Ordner.",
  do_remove: "Welt löschen",
  fork_from: (world, generation, tick) => `Eine Kopie von ${world} bei Generation ${
    with_separators(generation)}, Tick ${with_separators(tick)}. Sie wartet, bis sie gestartet wird.`,
  fork_name: "Name der Abzweigung",
  do_fork: "Abzweigen",
  islands: (world) => `Inseln von ${world}`,
  islands_of_replay: (world) => `Inseln der Wiedergabe von ${world}`,
  island_table: "Inseln der Welt",
  island_headings: ["Insel", "Am Leben", "Mittlere Gesundheit", "Letzte beste Fitness"],
  island: (number) => `Insel ${number}`,
  alive: (alive, all) => `${with_separators(alive)} von ${with_separators(all)}`,
};
