// Texts of the panel "Glass box": its controls and drawings. What it says about a breeding is in breeding.ts.
import type * as english from "../texts/glass_box";

import {counted} from "./breeding";
import {fitness_text, three_digits, with_separators, with_sign} from "./numbers";

function off_text(off: number): string {
  return Number.isFinite(off) ? with_sign(off) : off > 0 ? "∞" : "−∞";
}

export const glass_box_texts: typeof english.glass_box_texts = {
  title: "Glaskasten",
  wrong_generation: (generation) =>
    `Der Server hat die Züchtung einer anderen Generation als ${with_separators(generation)} geschickt`,
  not_picked: (organism, generation) =>
    `Organismus ${organism} wurde bei der Züchtung aus Generation ${with_separators(generation)} nicht gezogen.`,
  summary: (world, generation, breeding) => `Welt ${world}, Generation ${with_separators(generation)}: ${breeding}`,
  problem: (problem) => `${problem}.`,
  retry: "Noch einmal",
  no_snapshot: "Warten auf die erste Momentaufnahme …",
  births: "In dieser Welt wird keine Generation gezüchtet: Organismen bekommen Kinder, während sie leben. " +
    "Der Bereich „Organismus“ nennt die Eltern eines Organismus. Das Diagramm „Selektion“ zeigt, " +
    "warum sich die Mittelwerte der Gene ändern.",
  nothing_bred:
    "Noch hat sich keine Generation fortgepflanzt. Die erste tut es, wenn sie endet und die nächste beginnt.",
  loading: "Wird geladen …",

  generation: "Generation",
  generation_label: "Generation der Eltern",
  follow: "die neueste",
  follow_help: "Zeigt jede neue Züchtung, wenn die Schritte der letzten am Anfang oder am Ende stehen.",
  bet: "erst tippen",
  bet_help: "Tippen, welche Organismen gezogen werden. Das Ergebnis vergleicht die Tipps mit zufälligen.",
  play_each: "jede abspielen",
  play_each_help: "Spielt jede Züchtung von Anfang an ab, sobald sie erscheint; mit Tipps nach den Tipps.",
  hold: "Welt anhalten",
  hold_help: "Hält, solange dieser Bereich offen ist, die Welt nach jeder Generation an, einen Tick in der nächsten. " +
    "Fortsetzen lässt eine weitere Generation laufen.",
  birth: "Geburt des ausgewählten Organismus",
  tabs: {step: "Schritt", theory: "Theorie", genes: "Warum sich Gene ändern"},
  tabs_label: "Was gezeigt wird",

  play: "Abspielen",
  stop: "Stopp",
  play_help: "Spielt ab oder stoppt (Leertaste).",
  to_begin: "Zum Anfang (Pos1)",
  previous_stage: "Zum vorigen Abschnitt (Bild auf)",
  back: "Ein Schritt zurück (←)",
  forward: "Ein Schritt vor (→)",
  next_stage: "Zum nächsten Abschnitt (Bild ab)",
  to_end: "Zum Ende (Ende)",
  speed_label: "Schritte pro Sekunde",
  speed: (steps_per_s) => `${three_digits(steps_per_s)} Schritte/s`,
  speed_read: (steps_per_s) => `${three_digits(steps_per_s)} Schritte pro Sekunde`,
  position_label: "Schritt",
  position: (position, last) => `Schritt ${with_separators(position)} von ${with_separators(last)}`,
  stage_label: "Schritte der Züchtung. Pfeil links und rechts: ein Schritt; Bild auf, Bild ab: Abschnitt; Leertaste: " +
    "abspielen",
  play_picks: (picks, closes_bets) =>
    `${closes_bets ? "Tipps abgeben und " : ""}${counted(picks, "Ziehung", "Ziehungen")} abspielen`,
  migrant: (organism, from, island) =>
    `Organismus ${organism} ist eine Kopie von Organismus ${from} der Insel ${island}`,
  migrants: (shown, count) =>
    `${counted(count, "Organismus ist", "Organismen sind")} vor der Selektion auf diese Insel eingewandert: ${
      shown.join("; ")}` +
    (count > shown.length ? `; und ${with_separators(count - shown.length)} weitere.` : "."),
  picks_legend: "Ziehungen in ihrer Reihenfolge; hell: fittester, dunkel: niedrigster Rang",

  bets_closed:
    "Die Tipps sind geschlossen, weil Ziehungen dieser Züchtung schon zu sehen waren. Eine andere Generation wählen, " +
    "um wieder zu tippen.",
  bets_question: (bets_max, offered, organisms) =>
    `Welche Organismen werden am häufigsten gezogen? Bis zu ${bets_max} wählen. ` +
    (offered < organisms ? `Zur Wahl stehen die ${offered} fittesten Organismen, nach Rang.` :
                           "Der fitteste Organismus steht zuerst."),
  bets_label: "Tipps",
  bet_on: (organism, rank, fitness) => `Organismus ${organism}: Rang ${rank + 1}, Fitness ${fitness_text(fitness)}`,
  no_bets: "Tipps: noch keine.",
  your_bets: (organisms) => `Tipps: ${organisms.join(", ")}.`,

  too_many: (rows_max) =>
    `Die Theorie braucht alle Organismen; angefordert werden nur die ersten ${with_separators(rows_max)}.`,
  received: (received, all) => `${with_separators(received)} von ${with_separators(all)} Organismen empfangen …`,
  deviating: (count, ranks) =>
    `${with_separators(count)} von ${with_separators(ranks)} Rängen weichen um mehr als zwei Standardfehler ab`,
  after_picks: (made, all) => `Nach ${with_separators(made)} von ${
    counted(all, "Ziehung", "Ziehungen")}. Die Abweichungen erscheinen nach der letzten Ziehung.`,
  value: (value, unit) =>
    value === null ? "–" : `${three_digits(Math.abs(value) < 1e-12 ? 0 : value)}${unit && " "}${unit}`,
  expected: (name, expected) => `${name}: erwartet ${expected}`,
  expected_and_observed: (name, expected, observed) => `${name}: erwartet ${expected}, beobachtet ${observed}`,
  standard_errors: (off) => `${off_text(off)} Standardfehler`,
  source: (sentence, source) => `${sentence} (${source})`,
  table: "Alle Organismen als Tabelle",
  gene_table: "Gene der Eltern und des Nachkommen",
  table_columns: ["Rang", "Organismus", "Fitness", "erwartet", "Ziehungen", "Abw."],
  table_expected: (expected, error) => `${three_digits(expected)} ± ${three_digits(error)}`,
  table_off: off_text,
  table_limited: (rows, all) => `Die ${rows} fittesten von ${with_separators(all)} Organismen.`,

  account_unknown: "Der Server weiß nicht, warum sich die Mittelwerte der Gene geändert haben.",
  account_later: (generation) =>
    `Die Rechnung erscheint, wenn Generation ${with_separators(generation)} zu Ende ist, falls der Server ihre ` +
    "Statistik dann noch hat.",
  account: (generation) => `Warum sich der Mittelwert jedes Gens von Generation ${with_separators(generation)} zu ` +
    `${with_separators(generation + 1)} geändert hat, nach der Price-Gleichung: Die Änderung ist Selektion (welche ` +
    "Organismen Nachkommen hatten) + Weitergabe (Rekombination und Mutation) + Migration.",
  account_limited: (shown, all) =>
    `Die ${shown} von ${with_separators(all)} Genen, deren Mittelwerte sich am stärksten geändert haben, gemessen in ` +
    "Standardabweichungen.",
  account_parts: {selection: "Selektion", transmission: "Weitergabe", migration: "Migration", change: "Änderung"},

  narrow_slots: (first, last) => `Organismen ${first} bis ${last}: Felder zu schmal zum Zeichnen`,
  slot_organism: (organism) => `Organismus ${organism}`,
  slot_rank: (rank, of) => `Rang ${with_separators(rank + 1)}${of === null ? "" : ` von ${with_separators(of)}`}`,
  slot_share: (share, wide) => `${three_digits(100 * share)} %${wide ? " des Rads" : ""}`,
  contestants: "Teilnehmer in der Reihenfolge der Auslosung",
  contestant_fitness: (fitness, won) => fitness_text(fitness) + (won ? " gewinnt" : ""),
  unknown: "…",
  fitness: "Fitness",
  weight: "Gewicht",
  by_rank: (title, range) => `${title} nach Rang: ${range}`,
  rank_range: (best, worst, count) =>
    `${fitness_text(best)} (Rang 1) bis ${fitness_text(worst)} (Rang ${with_separators(count)})`,
  ranks: (first, last) => `Ränge ${first + 1} bis ${last + 1}`,
  picks_in_order: (pick, count) => `Ziehungen der Reihe nach: ${pick + 1} von ${count}`,
  one_pick: (pick) => `Ziehung ${pick + 1}`,
  copies_label: "Ziehungen nach Rang, beobachtet und erwartet; die Tabelle darunter enthält die Zahlen",
  copies_title: "Ziehungen nach Rang; Linie: erwartet ± Fehler",
  deviation_title: "Abweichung in Standardfehlern",
  plus_two: "+2",
  minus_two: "−2",
  one_rank: (rank, organism, fitness) => `Rang ${rank + 1}: Organismus ${organism}, Fitness ${fitness_text(fitness)}`,
  copies: (copies, expected, error, deviation) =>
    `; Ziehungen ${with_separators(copies)}, erwartet ${three_digits(expected)} ± ${three_digits(error)}` +
    (deviation === null ? "" : `; ${with_sign(deviation)} Standardfehler`),
  rank_label: (rank) => `Rang ${with_separators(rank + 1)}`,
  next_generation: "Die nächste Generation",
  descendant_of: (organism, count) => `Organismus ${organism} von ${count} der nächsten Generation`,
  elite: "Elite",
  survivors: "Überlebende",
  children: "Kinder",
  first_parent: "Gen des ersten Elternteils",
  second_parent: "des zweiten Elternteils",
  blended: "gemischt",
  cut: "Schnitt",
  mutated: "mutiert oder begrenzt",
  contradiction: "Die Gene dieses Organismus sind unbekannt: Seine Listen widersprechen sich.",
  unnamed_gene: (gene) => `Gen ${gene + 1}`,
  itself: "selbst",
  parent: "Elternteil",
  gene_received: (gene, received) => `${gene}: Das Kind hat dieses Gen ${received ? "" : "nicht "}erhalten`,
  crossed: "rekombiniert",
  from_both: (gene) => `${gene}: Mittel beider Eltern`,
  from_first: (gene) => `${gene}: vom ersten Elternteil`,
  from_second: (gene) => `${gene}: vom zweiten Elternteil`,
  order: "Reihenfolge",
  moved_from: (gene) => `von ${gene}`,
  mutations: "Mutationen",
  mutation: (delta, how) => `${delta}: ${how}`,
  changed_to: (value) => `→ ${value}`,
  organism_row: (organism) => `Organismus ${organism}`,
  other_genes: "Weitere Gene",
  other_genes_help: "Mit der Maus auf eine Zelle zeigen, um ihr Gen zu lesen; mit der Tastatur: Pfeiltasten.",
};
