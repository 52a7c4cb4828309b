// Texts of the dialog "New world".
import type * as english from "../texts/new_world";

import {with_separators} from "./numbers";

export const new_world_texts: typeof english.new_world_texts = {
  title: "Neue Welt",
  experiments: "Experiment",
  descriptions: {
    default:
      "Die Standardwelt: 50 Organismen, 25 Stück Futter, 40 Stück Gift. Alle Parameter haben ihre Standardwerte.",
    annealing: "Die Mutation nimmt mit den Generationen ab: erst große Schritte, später kleine zum Feinabstimmen.",
    brains:
      "Neuronale Netze lernen durch Evolution, Futter zu fressen und Gift zu meiden; sie nehmen Richtung und Nähe " +
      "wahr. Starke Dämpfung wie in Wasser lässt Organismen dorthin gehen, wohin sie sich drehen.",
    classic:
      "Die ursprünglichen Regeln der Dissertation: Organismen umkreisen ihr Futter und fliehen immer. Die Population " +
      "ist klein, und Überlebende mutieren. Der Zufall überwiegt hier die Selektion.",
    colony:
      "Eine Kolonie ohne Generationen: Organismen mit genug Gesundheit bekommen Kinder neben sich und sterben an " +
      "Hunger, Gift oder Alter. Die Gesundheit eines Kindes zahlen seine Eltern. Fitness ist die Zahl der Kinder.",
    islands:
      "Acht Inseln in einem Ring: Alle zehn Generationen schickt jede Insel eine Kopie ihres besten Organismus zur " +
      "nächsten.",
    predators:
      "Beute und Räuber ohne Generationen: Räuber kommen in Abschnitt 10, fressen Beute und streifen nach jeder " +
      "Mahlzeit sechs Sekunden umher. Die Beute flieht vor ihnen. Kinder beider Arten haben einen Elternteil.",
    rooy:
      "Netze mit einem Eingang steuern auf Futter zu, wie in N. Rooys „Evolving Simple Organisms“ (2017), hier mit " +
      "Wänden fern vom Futter; der nächste Organismus erhält das Stück.",
    trade_offs:
      "Jedes Gen hat Kosten: Mehr Tempo, Kraft, Gesundheit und Wahrnehmung kosten mehr Gesundheit pro Sekunde, " +
      "und ein kleiner Körper begrenzt die Gesundheit. Die besten Werte der Gene liegen daher innerhalb ihrer Grenzen.",
  },
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
