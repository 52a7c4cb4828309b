// Texts of the dialog "New world".
import type * as english from "../texts/new_world";

import {with_separators} from "./numbers";

export const new_world_texts: typeof english.new_world_texts = {
  title: "Neue Welt",
  experiments: "Experiment",
  same: (world) => `wie ${world}`,
  same_help: "Die Parameter und der Zeitplan, die diese Welt jetzt hat.",
  name: "Name",
  seed: "Startwert",
  seed_hint: "leer: zufällig gewählt",
  seed_help:
    "Der Startwert bestimmt alles Zufällige. Zwei Welten mit gleichem Startwert und gleichen Parametern sind " +
    "gleich.",
  population: "erste Population",
  from_seed: "aus dem Startwert",
  population_help: "Zahl der Organismen und Inseln folgen aus der Population.",
  copies_help: "Alle Organismen der ersten Generation sind Kopien von diesem.",
  freezer_problem: (why) => `Das Gefrierfach ist nicht lesbar. ${why}`,
  text: "Parameter als Text",
  text_label: "Text des Experiments",
  text_help: "Der Text des Experiments. Ein Parameter, der nicht darin steht, hat seinen Standardwert.",
  open_file: "Datei öffnen …",
  beside: "neben dieser Welt zeigen",
  create: "Erzeugen",
  create_and_run: "Erzeugen und starten",
  unequal_islands: (first, other) => `erste Population: Inseln mit ${with_separators(first)} und ${
    with_separators(other)} Organismen, erlaubt ist dieselbe Zahl auf jeder Insel`,
};
