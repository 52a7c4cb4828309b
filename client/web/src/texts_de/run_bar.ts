// The run controls: run and pause, one generation, replay, fork, speed.
import type * as english from "../texts/run_bar";

export const run_bar_texts: typeof english.run_bar_texts = {
  run: "Starten",
  pause: "Anhalten",
  resume: "Fortsetzen",
  run_help: "Startet die Welt oder hält sie an (Leertaste).",
  generation: (births) => (births ? "Ein Intervall" : "Eine Generation"),
  generation_help: (births) => births ?
    "Lässt das Intervall bis zu seinem Ende laufen und wartet dann." :
    "Lässt die Generation bis zu ihrem Ende laufen und wartet dann. Der nächste Tick züchtet die nächste.",
  replay: "Wiedergabe",
  replay_help: "Zeigt frühere Generationen dieses Laufs, mit einer Zeitleiste (P).",
  live: "Live",
  live_help: "Kehrt zur laufenden Welt zurück (P).",
  fork: "Abzweigen",
  what_if: "Was wäre, wenn?",
  fork_help: "Erzeugt eine Welt, die beim gezeigten Tick beginnt, und zeigt sie neben dieser.",
  create: "Neu …",
  create_help: "Erzeugt eine weitere Welt.",
  no_world: "Keine Welt ist offen.",
  has_ended: "Der Lauf ist zu Ende.",
  end_of_replay: "Die Wiedergabe ist am Ende.",
  speed: "Tempo",
  slower: "Tempo halbieren",
  slower_help: "− halbiert das Tempo.",
  faster: "Tempo verdoppeln",
  faster_help: "+ verdoppelt das Tempo; 1 ist Echtzeit.",
  is_fastest: "Die Welt läuft so schnell wie möglich.",
  max: "Max",
  max_help: "So schnell wie möglich (M).",
  slider: "Tempo, als Vielfaches der Echtzeit",
  max_value: "so schnell wie möglich",
  value: (factor) => `das ${factor}-Fache der Echtzeit`,
  slowed: "Der Server kommt nicht mit: Die simulierte Zeit läuft langsamer, kein Tick fällt aus.",
};
