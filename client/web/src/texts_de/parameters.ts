// Texts of the panel "Parameters".
import type * as english from "../texts/parameters";

import {capitalised, with_separators} from "./numbers";
import {allowed_words} from "./registry";

const counted = (count: number, one: string, many: string): string =>
  `${with_separators(count)} ${count === 1 ? one : many}`;

export const warning_text: typeof english.warning_text = (warnings) =>
  warnings.map((warning) => `${capitalised(warning)}.`).join("\n");

export const effect_texts: typeof english.effect_texts = {
  PARAMETER_EFFECT_NEXT_TICK:
    {word: "sofort", sentence: "Wirkt ab dem nächsten Tick; Parameter der Züchtung bei der nächsten Züchtung."},
  PARAMETER_EFFECT_NEXT_GENERATION: {word: "nächste", sentence: "Wirkt ab der nächsten Generation."},
  PARAMETER_EFFECT_RESET: {word: "Neustart", sentence: "Wirkt, wenn die Welt zurückgesetzt wird."},
};

export const parameters_texts: typeof english.parameters_texts = {
  apply: "Anwenden",
  plan: "Planen",
  discard: "Verwerfen",
  discard_help: "Verwirft alle Eingaben.",
  at_once: "sofort anwenden",
  at_once_help: "Wendet jede Änderung an, sobald sie gemacht ist.",
  search: "Parameter suchen",
  search_hint: "in Namen, Gruppen und Erklärungen suchen",
  nothing_found: "Kein Parameter passt.",
  typing_is_wrong: "Nichts wurde gesendet: siehe den markierten Parameter.",
  no_edits: "Nichts wurde eingegeben.",
  plan_help: "Sendet alle Eingaben als eine Änderung, die der Server später anwendet.",
  apply_help: "Sendet alle Eingaben als eine Änderung: Der Server nimmt alle an oder keine.",
  loading: "Parameter werden geladen …",
  sending: "Wird gesendet …",
  revision: (revision) => `Revision ${with_separators(revision)}; keine Eingaben`,
  edits: (count) => `${counted(count, "Eingabe", "Eingaben")} noch nicht angewendet`,
  planned: (count, when) => `${counted(count, "Änderung", "Änderungen")} ${when} geplant.`,
  applied: (count, tick) => `${counted(count, "Änderung", "Änderungen")} ab Tick ${with_separators(tick)} angewendet.`,
};

export const when_texts: typeof english.when_texts = {
  choice: "Wann die Eingaben angewendet werden",
  now: "jetzt",
  in_generation: "in Generation",
  after_tick: "nach Tick",
  number: "Generation oder Tick",
  wrong: (kind, got) => `${kind}: „${got}“ ist nicht möglich, erlaubt sind ganze Zahlen ab 1`,
};

export const planned_texts: typeof english.planned_texts = {
  title: (count) => `Geplante Änderungen (${with_separators(count)})`,
  change: (when, values, by) => `${when}: ${values.join("; ")}, von ${by}`,
  scheduled: (generation, value) => `in Generation ${with_separators(generation)}: ${value}, nach dem Zeitplan`,
};

export const parameter_texts: typeof english.parameter_texts = {
  not_default: "Das ist nicht der Standardwert.",
  to_default: "Standard",
  to_default_help: (value) => `Standard: ${value}`,
  to_default_name: (parameter, value) => `${parameter} auf den Standardwert ${value} setzen`,
  was: (value) => `vorher ${value}`,
  still: (value) => `noch ${value}`,
  set_by: (client) => `gesetzt von ${client}`,
  planned: (values) =>
    `geplant: ${values[0]}${values.length > 1 ? ` und ${with_separators(values.length - 1)} weitere` : ""}`,
  refused: (got, allowed) => `${got === "" ? "" : `${allowed_words(got)} ist nicht möglich, `}erlaubt: ${allowed}`,
  wrong_text: (got, is_whole, allowed) =>
    `„${got}“ ist nicht möglich, erlaubt: ${is_whole ? "ganze Zahlen von " : ""}${allowed}`,
  now_and_then: (now, later) => `${now}, dann ${later}`,
  facts: (allowed, usual, now) => `Erlaubt: ${allowed}. Standard: ${usual}. Jetzt: ${now}.`,
};
