// Texts about the theory of selection, the bets on picks, and why the means of genes changed.
import type * as english from "../texts/breeding_theory";

import {three_digits, with_separators, with_sign} from "./numbers";

function signed(number: number): string {
  return number === 0 ? "0" : with_sign(number);
}

export const theory_texts: typeof english.theory_texts = {
  sources: {
    baker: "Baker 1987",
    goldberg_deb: "Goldberg & Deb 1991",
    blickle_thiele: "Blickle & Thiele 1996",
    motoki: "Motoki 2002",
    pearson_haldane: "Pearson 1900; Haldane 1937",
  },
  unit_deviations: "Standardabw.",
  unit_generations: "Generationen",
  fittest: "Kopien des Fittesten",
  fittest_sentence: "Wie oft der Organismus mit der besten Fitness gezogen wird.",
  intensity: "Selektionsintensität",
  intensity_sentence:
    "Um wie viele Standardabweichungen die mittlere Fitness der gezogenen Organismen über der mittleren Fitness " +
    "aller Organismen liegt.",
  normal_intensity: "Intensität bei Normalverteilung",
  normal_intensity_sentence:
    "Die Selektionsintensität, wenn die Fitness normalverteilt wäre: Sie hinge nur von den Rängen ab.",
  unpicked: "Anteil ohne Ziehung",
  unpicked_sentence: "Der Anteil der Organismen, die nie gezogen werden; Gene, die nur sie hatten, gehen verloren.",
  diversity: "Verlust an Vielfalt",
  diversity_sentence:
    "Der Anteil der Population, den Kopien fitterer Organismen ersetzen, wenn jeder Organismus so viele Kopien hat " +
    "wie erwartet: der kleinste mögliche Verlust.",
  takeover: "Übernahmezeit",
  takeover_sentence:
    "Generationen allein mit Selektion, ohne Mutation und Rekombination, bis Kopien des Fittesten alle Plätze außer " +
    "einem füllen.",
  takeover_overlapping:
    "Generationen, bis Kopien des Fittesten alle Plätze außer einem füllen; ohne Vorhersage, wenn der größte Teil " +
    "einer Generation überlebt.",
  takeover_of_fitness:
    "Generationen, bis Kopien des Fittesten alle Plätze außer einem füllen; ohne Vorhersage, wenn jede Generation " +
    "ihre kleinste Fitness abzieht oder alle Werte gleich sind.",
  takeover_never:
    "Generationen, bis Kopien des Fittesten alle Plätze außer einem füllen: nie, denn jeder Organismus hat dieselbe " +
    "Chance.",
  agreement: "Übereinstimmung aller Kopien",
  agreement_sentence:
    "Quadrierte Abweichungen der beobachteten von den erwarteten Kopien, jeweils geteilt durch die erwarteten " +
    "(Chi-Quadrat je Organismus): etwa 1, wenn das Gesetz gilt.",
};

export const bet_texts: typeof english.bet_texts = {
  hits: (hits, picks, bets, random) =>
    `${with_separators(hits)} von ${with_separators(picks)} ${picks === 1 ? "Ziehung traf" : "Ziehungen trafen"} ${
      bets === 1 ? "den Tipp" : `die ${bets} Tipps`}. Zufällige Tipps: ${three_digits(random)} erwartet.`,
  result: (law, most, ratio) =>
    ` Diese Tipps: nach dem Gesetz der Selektion ${three_digits(law)} erwartet. Die besten möglichen Tipps: ` +
    `${with_separators(most)}.` +
    (ratio === null ? "" : ` Ergebnis: ${three_digits(ratio)}-mal so gut wie zufällige Tipps.`),
};

export const account_texts: typeof english.account_texts = {
  unnamed_gene: (gene) => `Gen ${gene}`,
  change: ({name, change, selection, transmission, migration}) => `Der Mittelwert von ${name} ${
                                                                    change > 0   ? "stieg um " :
                                                                      change < 0 ? "sank um " :
                                                                                   "blieb gleich"}` +
    (change === 0 ? "" : with_sign(Math.abs(change)).slice(1)) +
    `: Selektion ${signed(selection)}, Weitergabe ${signed(transmission)}, Migration ${signed(migration)}.`,
  by_selection: (more) => `Organismen mit ${more ? "mehr" : "weniger"} davon hatten mehr Nachkommen.`,
  by_transmission: (more) =>
    `Rekombination und Mutation gaben den Nachkommen ${more ? "mehr" : "weniger"} davon, als ihre Eltern hatten.`,
  by_migration: (more) => `Die Einwanderer hatten ${more ? "mehr" : "weniger"} davon.`,
};
