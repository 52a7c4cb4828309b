// The help of the keys and gestures. panels.js contains it.
import type * as english from "../texts/help";

export const key_names: typeof english.key_names = {
  "Space": "Leertaste",
  "Shift+.": "⇧ .",
  "Page Down": "Bild ab",
  "Page Up": "Bild auf",
  "Home": "Pos1",
  "Shift+Z": "⇧ Z",
};

export const key_help: typeof english.key_help = {
  pause: "starten, anhalten, fortsetzen",
  tick: "ein Tick, dann anhalten",
  ticks: "60 Ticks, dann anhalten",
  faster: "Tempo verdoppeln",
  slower: "Tempo halbieren",
  real_time: "Echtzeit",
  maximum: "höchstes Tempo; noch einmal: voriges Tempo",
  next_island: "nächste Insel",
  previous_island: "vorige Insel",
  all_islands: "alle Inseln zeigen oder nur die gewählte",
  next_world: "nächste Welt",
  replay: "Lauf der Welt wiedergeben; noch einmal: zurück zu live",
  previous_generation: "in einer Wiedergabe: vorige Generation",
  next_generation: "in einer Wiedergabe: nächste Generation",
  beside: "eine zweite Welt oder die Vergangenheit dieser Welt daneben zeigen; noch einmal: nur die erste Welt",
  evolution: "Generation 1 neben der Gegenwart zeigen; noch einmal: nur die Gegenwart",
  other_world: "zur anderen Welt wechseln",
  link: "Ansichten beider Welten koppeln oder lösen",
  fit: "ganze Insel zeigen",
  zoom: "vergrößern, verkleinern",
  move: "Ansicht bewegen",
  follow: "dem ausgewählten Organismus folgen; noch einmal: aufhören",
  colour: "färben nach Gesundheit, Abstammung, einem Gen, nichts",
  perception: "Sichtweiten: des Organismus unter dem Mauszeiger, aller, keine",
  forces: "Kräfte: des Organismus unter dem Mauszeiger, aller, keine",
  trails: "Spuren zeigen oder verbergen",
  column: "Spalte verbergen; noch einmal: zeigen",
  help: "diese Hilfe zeigen oder verbergen",
  escape: "Hilfe schließen, Werkzeug beenden, Auswahl aufheben, zurück zu allen Inseln",
};

export const gesture_help: typeof english.gesture_help = [
  ["Strg+C", "Link zu diesem Moment kopieren"],
  ["Strg+Z", "letzte eigene Änderung von Parametern oder zuletzt Eingesetztes rückgängig machen"],
  ["Strg+⇧+Z   Strg+Y", "Rückgängiges wiederholen"],
  ["Mausrad   zwei Finger", "beim Mauszeiger zoomen"],
  ["Ziehen", "Ansicht bewegen"],
  ["Klicken   Tippen", "einen Organismus auswählen; ins Leere: keinen auswählen; oder das gewählte Werkzeug benutzen"],
];
