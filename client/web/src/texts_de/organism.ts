// organism: the panel "Organism".
import type * as english from "../texts/organism";

import {gene_label, gene_number} from "./genes";
import {duration, localised, tenths, three_digits, with_separators} from "./numbers";

export const organism_texts: typeof english.organism_texts = {
  title: "Organismus",
  loading: "Wird geladen …",

  choose: "Einen Organismus anklicken, um ihn zu untersuchen: seine Gene, seine Eltern und warum sie gezogen wurden.",
  healthiest: "Die gesündesten Organismen jetzt",
  offer: (id, health) => `Organismus ${id}, Gesundheit ${three_digits(health)}`,
  none_alive: "Kein Organismus lebt.",
  waiting: "Warten auf die erste Momentaufnahme …",

  heading: (id, generation) => `Organismus ${id} der Generation ${with_separators(generation)}`,
  predator: (id, generation) => `Räuber ${id} der Generation ${with_separators(generation)}`,
  numbered: (number, is_predator) => `${is_predator ? "Räuber" : "Organismus"} Nummer ${with_separators(number)}`,
  back: "Zurück zu live",
  back_help: "Kehrt zur laufenden Welt zurück.",
  deselect: "Abwählen",
  family: "Stammbaum",
  follow: "in der Mitte halten",
  eaten: (food, poison) => `gefressen: ${with_separators(food)} Futter, ${with_separators(poison)} Gift`,
  eaten_prey: (count) => `gefressen: ${with_separators(count)} Beutetiere`,
  children: (count) => `Kinder: ${with_separators(count)}`,
  body: (radius_px, mass_kg) => `Radius ${tenths(radius_px)} px, Masse ${localised(mass_kg.toFixed(2))} kg`,

  alive: (lived_s, health) => `lebt seit ${tenths(lived_s)} s, Gesundheit ${tenths(health)}`,
  alive_when_last_seen: (lived_s, births) => `lebte noch, als er nach ${tenths(lived_s)} s zuletzt zu sehen war; ${
    births ? "das Intervall" : "seine Generation"} ist zu Ende`,
  starved: (lived_s) => `nach ${tenths(lived_s)} s verhungert`,
  poisoned: (lived_s) => `nach ${tenths(lived_s)} s an Gift gestorben`,
  eaten_by_predator: (lived_s) => `nach ${tenths(lived_s)} s von einem Räuber gefressen`,
  old: (lived_s) => `nach ${tenths(lived_s)} s an Altersschwäche gestorben`,
  removed: (lived_s) => `nach ${tenths(lived_s)} s von Hand entfernt`,
  wanders: "will umherstreifen",
  seeks: (x_px, y_px) => `will Futter suchen bei ${place(x_px, y_px)}`,
  flees: (x_px, y_px) => `will fliehen vor Gift bei ${place(x_px, y_px)}`,
  flees_predator: (x_px, y_px) => `will fliehen vor dem Räuber bei ${place(x_px, y_px)}`,
  hunts: (x_px, y_px) => `will Beute jagen bei ${place(x_px, y_px)}`,
  handles: (seconds) => `frisst noch ${tenths(seconds)} s an seiner Beute`,
  steers: "von seinem Netz gesteuert",

  why: "Warum es ihn gibt",
  placed: (tick) => `Keine Eltern: von Hand eingesetzt nach Tick ${with_separators(tick)} der Generation`,
  founder: "Keine Eltern: Gründer der Generation 1, oder aus einer Datei",
  one_parent: (parent, generation, why) =>
    `Ein Elternteil: ${parent} (Generation ${with_separators(generation)})${why}`,
  of_elite: ": Dieser Organismus gehört zur Elite",
  of_survivors: ": Dieser Organismus hat überlebt",
  both_parents: ", zugleich beide Eltern",
  parents: (first, second, generation) => `Eltern: ${first} und ${second} (Generation ${with_separators(generation)})`,
  arrived: "Keine Eltern: Er kam am Anfang dieses Intervalls",
  born_before: "Er wurde vor diesem Intervall geboren",
  child_of_parent: (parent) => `Kind von Organismus ${parent} dieses Intervalls`,
  child_of_parents: (first, second) => `Kind der Organismen ${first} und ${second} dieses Intervalls`,
  go_to_parent: (parent) => `Zum Elternteil ${parent}`,
  go_to_parent_help: "Zeigt den Elternteil lebend, in einer Wiedergabe seiner Generation.",
  why_parent: (parent) => `Warum ${parent}?`,
  why_parent_help: "Öffnet den Glaskasten bei der ersten Ziehung dieses Elternteils.",
  its_parent: (parent) => `Elternteil ${parent}`,
  it: "Er",
  copy_of: (subject, organism, island) => `${subject} (Kopie von Organismus ${organism} der Insel ${island})`,
  picked: (subject, count, all, expected) => `${subject} wurde ${with_separators(count)}-mal bei ${
    with_separators(all)} ${all === 1 ? "Ziehung" : "Ziehungen"} gezogen, erwartet ${three_digits(expected)}.`,
  show_picks: "Ziehungen zeigen",
  show_picks_help: "Öffnet den Glaskasten bei seiner ersten Ziehung.",
  not_bred: "Seine Generation hat sich noch nicht fortgepflanzt.",
  no_picks: "Seine Ziehungen sind unbekannt.",
  picks_problem: (why) => `Die Ziehungen sind unbekannt: ${why}.`,

  health_axis: (most) => `Gesundheit, Achse von 0 bis ${three_digits(most)}`,
  health_curve: (first, last) => `Gesundheit seit der Auswahl: von ${tenths(first)} bis ${tenths(last)}`,
  health_unknown: "Gesundheit: unbekannt",
  selected: "seit der Auswahl",
  selected_ago: (seconds) => `seit der Auswahl vor ${duration(seconds)}`,

  network: "Netz",
  genes: "Gene",
  genes_hint: "Balken: vom kleinsten bis zum größten Wert in dieser Generation. Strich: der Mittelwert.",
  gene_range: (min, max, mean) =>
    `Bereich in dieser Generation: ${gene_number(min)} bis ${gene_number(max)}, Mittelwert ${gene_number(mean)}`,
  gene_of_range: (value, range) => `${gene_number(value)}. ${range}`,
  free_genes: (count) => `${with_separators(count)} freie Gene, ohne Wirkung in der Simulation`,
  free_gene: (name, value) => `${gene_label(name)} ${gene_number(value)}`,

  offspring: "Nachkommen",
  offspring_in: (generation, count) =>
    `Nachkommen in Generation ${with_separators(generation)}: ${with_separators(count)}`,
  offspring_later: "Nachkommen erscheinen, wenn die nächste Generation beginnt.",
  offspring_too_many: "Nachkommen unbekannt: Die nächste Generation ist zu groß, um sie zu durchsuchen.",
  no_offspring: "keine",
  child_with: (id, other) => `${id} (mit ${other})`,
  child_unchanged: (id) => `${id} (unverändert)`,
  child_of_one: (id) => `${id} (nur ein Elternteil)`,
  child_help: (id, generation) => `Zeigt Organismus ${id} der Generation ${generation}.`,
  more: (count) => `und ${with_separators(count)} weitere`,
};

function place(x_px: number, y_px: number): string {
  return `(${with_separators(x_px)}; ${with_separators(y_px)})`;
}
