// Texts of the panel "Lesson".
import type * as english from "../texts/lesson";

import {significant, with_separators, with_unit} from "./numbers";

const generations = (count: number): string => `${with_separators(count)} Generation${count === 1 ? "" : "en"}`;

export const lesson_texts: typeof english.lesson_texts = {
  language: "de",

  about:
    "Eine Lektion erklärt, fragt nach deiner Vorhersage, lässt die Welt laufen und vergleicht. Was du vorhersagst " +
    "und beobachtest, bleibt in der Laufdatei.",
  list: "Lektionen",
  minutes: (count) => `${count} Minuten`,
  none: "Dieser Server hat keine Lektionen.",
  loading: "Wird geladen …",
  not_loaded: (why) => `Die Lektionen können nicht geladen werden: ${why}.`,
  unknown: (name) => `Dieser Server hat keine Lektion ${name}.`,
  all: "‹ Alle Lektionen",
  handout: "Arbeitsblatt drucken",
  handout_help: "Öffnet den Druckdialog: die Texte, mit Platz für Vorhersagen.",

  goals: "Ziele",
  needs: "Was ihr braucht",
  begin: "Lektion beginnen",
  begin_again: "Neu beginnen …",
  ask_begin_again: (world) => `Neu beginnen? Deine Vorhersagen bleiben im jetzigen Lauf von ${
    world}, der damit endet. Die Lektion beginnt ohne sie.`,
  do_begin_again: "Neu beginnen",
  begin_about: (world) => `Die Lektion setzt die Welt ${
    world} zurück: Ihr jetziger Lauf endet. Alle Parameter bekommen die Werte der Lektion.`,
  read_only: (why) => `Du kannst diese Lektion lesen, aber hier nicht ausführen. ${why}`,
  elsewhere: (world) => `Diese Lektion läuft in der Welt ${world}.`,
  show_world: "Anzeigen",
  no_world: "Es gibt keine Welt, in der die Lektion laufen kann.",

  steps: "Schritte der Lektion",
  step_of: (step, count) => `Schritt ${step} von ${count}`,
  back: "‹ Zurück",
  next: "Weiter ›",
  first_predict: "Gib zuerst deine Vorhersage ab.",
  first_run: "Lass zuerst die Welt laufen.",
  changes: "Parameter dieses Schritts",
  from_to: (from, to) => `${from} → ${to}`,
  resets: "Die Welt wird zurückgesetzt: Sie beginnt wieder in Generation 1.",
  run: (count) => `${generations(count)} laufen lassen`,
  apply: "Anwenden",
  observe: "Beobachten",
  fast: "so schnell wie möglich",
  runs: (generation, last) => `Generation ${with_separators(generation)} von ${with_separators(last)} …`,
  frozen: "Die Klasse ist angehalten. Der Lauf geht weiter, wenn deine Lehrkraft sie weiterlaufen lässt.",
  paused: "Die Welt ist angehalten.",
  resume: "Weiter",
  unwritten: "Noch nicht gespeichert. Die Seite versucht es wieder.",
  finished: "Du hast die Lektion beendet. Deine Vorhersagen und Beobachtungen stehen in der Laufdatei.",

  prediction: "Deine Vorhersage",
  give: "Das ist meine Vorhersage",
  given: "Deine Vorhersage ist gespeichert.",
  from: (min, max, unit) => `von ${with_unit(min, "")} bis ${with_unit(max, unit)}`,
  wrong_number: (text, min, max) =>
    `„${text}“ ist nicht möglich, erlaubt sind Zahlen von ${with_unit(min, "")} bis ${with_unit(max, "")}`,
  no_choice: "Wähle eine der Antworten.",
  no_curve: "Zeichne eine Kurve oder gib mindestens zwei Werte ein.",
  no_sentence: "Schreibe einen Satz.",
  up: (option) => `Nach oben: ${option}`,
  down: (option) => `Nach unten: ${option}`,
  moved: (option, place, count) => `${option}: jetzt ${place} von ${count}`,
  drag: "Ziehen zum Verschieben",
  order_help: "Ziehe die Zeilen oder benutze die Pfeile. Das Größte kommt zuerst.",
  draw_help: "Zeichne die Kurve mit der Maus oder dem Finger, oder gib ihre Werte ein.",
  clear: "Löschen",
  values: "Werte der Kurve",
  value_at: (label, x) => `${label} ${with_unit(x, "")}`,
  characters: (used, most) => `${with_separators(used)} von ${with_separators(most)} Zeichen`,

  answer: "Was geschah",
  predicted: "Deine Vorhersage",
  observed: "Beobachtet",
  theory: "Theorie",
  no_value: "Dieser Lauf hat keinen solchen Wert.",
  no_comparison: "Der Lauf liefert nicht alle Werte, die zum Vergleich nötig sind.",
  apart: (apart, observed, unit) => {
    const percent = observed === 0 ? "" : ` (${significant(Math.abs(apart / observed) * 100)}\u00a0%)`;
    const size = with_unit(Number(Math.abs(apart).toPrecision(3)), unit);
    return apart === 0 ? "Deine Vorhersage stimmt genau." :
                         `Deine Vorhersage liegt um ${size} ${apart > 0 ? "zu hoch" : "zu niedrig"}${percent}.`;
  },
  close: "Das ist nahe dran.",
  far: "Woran hast du nicht gedacht?",
  agrees: "Der Lauf gibt dir recht.",
  differs: "Der Lauf verlief anders. Was könnte der Grund sein?",
  pairs: (count) => count === 0 ? "Alle stehen in der Reihenfolge des Laufs." :
                                  `${count} ${count === 1 ? "Paar steht" : "Paare stehen"} in der anderen Reihenfolge.`,
  curve_apart: (apart) => `Im Mittel liegt deine Kurve ${significant(apart)} von der beobachteten entfernt.`,
  law: (value, error, unit) => `${with_unit(Number(value.toPrecision(4)), error === undefined ? unit : "")}${
    error === undefined ? "" : ` ± ${with_unit(Number(error.toPrecision(2)), unit)}`}`,
  law_apart: (errors) => `Die Beobachtung liegt das ${significant(Math.abs(errors))}-Fache dieser Unsicherheit ${
    errors >= 0 ? "über" : "unter"} der Theorie.`,
  option: "Antwort",
  value: "Wert",
  your_order: "Deine Reihenfolge",
  run_order: "Reihenfolge im Lauf",
  summary: "Deine Ergebnisse",
  summary_headings: ["Frage", "Deine Vorhersage", "Beobachtet"],
  generations,
};

export const handout_texts: typeof english.handout_texts = {
  name: "Name",
  date: "Datum",
  run: (count) => `${generations(count)} laufen lassen.`,
  observed: "Beobachtet",
  explanation: "Warum?",
};
