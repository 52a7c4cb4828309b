// What people read about the past of a world: the time line, its buttons, links to moments.
import type * as english from "../texts/timeline";

import {with_separators} from "./numbers";

export const timeline_texts: typeof english.timeline_texts = {
  name: "Zeitleiste",
  slider: "Zeitleiste: Generation",
  generation: (generation) => `Generation ${with_separators(generation)}`,
  tick: (tick) => `Tick ${with_separators(tick)}`,
  tick_of: (tick, count) => `Tick ${with_separators(tick)} von ${with_separators(count)}`,
  last_tick: "letzter Tick",
  going_to: (moment) => `auf dem Weg: ${moment} …`,
  live: "live",
  is_live: "Die Welt ist live.",
  is_live_help: "Die Welt ist live; P gibt ihren Lauf wieder.",
  no_world: "Keine Welt ist offen.",
  is_first: "Das ist die erste Generation.",
  is_last: "Das ist die letzte Generation.",
  is_end: "Die Wiedergabe ist am Ende.",
  extinction: (generation) => `Generation ${with_separators(generation)}: Alle Organismen starben vor ihrem Ende`,
  forked: (world) => `Die Welt ${world} wurde hier abgezweigt.`,
  mark_labels: {
    extinction: "alle gestorben",
    placed: "eingesetzt",
    removed: "entfernt",
    migration: "Migration",
    fork: "Abzweigung"
  },
  several: (label, further) => `${label} +${further}`,
  zoomed: (first, last) => `die Leiste zeigt die Generationen ${with_separators(first)} bis ${with_separators(last)}`,
  zoom: "Zoom der Zeitleiste",
  further_marks: (count) => `und ${count} weitere`,
};

export const timeline_buttons: typeof english.timeline_buttons = {
  first: {label: "|<", name: "Erster Tick", help: "Geht zum ersten Tick."},
  previous: {label: "<", name: "Vorige Generation", help: "Geht zur vorigen Generation ([)."},
  play: {label: "Start", help: "Spielt die Wiedergabe ab oder hält sie an (Leertaste)."},
  pause: {label: "Pause"},
  next: {label: ">", name: "Nächste Generation", help: "Geht zur nächsten Generation (])."},
  last: {label: ">|", name: "Letzter Tick", help: "Geht zum letzten Tick."},
  live: {label: "Live", help: "Kehrt zur laufenden Welt zurück (P)."},
  zoom_in:
    {label: "+", name: "Vergrößern", help: "Zeigt weniger Generationen auf der Leiste (Mausrad, + auf der Leiste)."},
  zoom_out:
    {label: "−", name: "Verkleinern", help: "Zeigt mehr Generationen auf der Leiste (Mausrad, − auf der Leiste)."},
  show_all: {label: "Alle", name: "Alle Generationen zeigen", help: "Zeigt den ganzen Lauf auf der Leiste (0)."},
  is_whole: "Die Leiste zeigt den ganzen Lauf.",
  copy: {label: "Link", help: "Kopiert einen Link, der diesen Moment in einem Browser zeigt (Strg+C)."},
};

export const generation_field_texts: typeof english.generation_field_texts = {
  label: (births) => (births ? "Intervall" : "Generation"),
  help: (first, last, births) => `${births ? "Ein Intervall" : "Eine Generation"} von ${with_separators(first)} bis ${
    with_separators(last)} eingeben; die Eingabetaste zeigt ${births ? "es" : "sie"}.`,
};
