// What the organisms of a world try to do: the sentences that the server makes in English.
import type {ParameterSet, ParameterValue} from "../core/protocol";
import type * as english from "../texts/experiment";

import {shown_number, with_separators} from "./numbers";

type Values = {
  readonly [name: string]: ParameterValue|undefined
};

const counted = (count: number, one: string, many: string): string =>
  `${with_separators(count)} ${count === 1 ? one : many}`;

/** The values in effect, by name. */
function values_of(set: ParameterSet) {
  const values: Values = Object.fromEntries((set.parameters ?? []).map(({name = "", value}) => [name, value]));
  return {
    number: (name: string): number => values[name]?.real ?? values[name]?.count ?? 0,
    flag: (name: string): boolean => values[name]?.flag === true,
    choice: (name: string): string => values[name]?.choice ?? "",
  };
}

type Read = ReturnType<typeof values_of>;

/** The sentences that the server sends in English, made from the values in effect. */
export const experiment_text: typeof english.experiment_text = (set) => {
  const read = values_of(set), islands = read.number("island_count"), fitness = read.choice("fitness");
  const has_bodies = fitness === "life" || (fitness === "external" && read.flag("external_bodies"));
  const free = read.number("free_genes");
  return [
    islands > 1 ? `Auf jeder von ${with_separators(islands)} Inseln:` : "",
    has_bodies ?
      life(read) :
      `${counted(read.number("population_size"), "Organismus", "Organismen")} ohne Körper; nur die Gene zählen.`,
    free > 0 ?
      `Jeder hat ${counted(free, "freies Gen", "freie Gene")}${has_bodies ? ", ohne Wirkung auf den Körper" : ""}.` :
      "",
    islands > 1 ? migration(read) : "",
    `Die Fitness ${fitness_of(read, fitness)}.`,
    ...(read.choice("reproduction") === "births" ? [births(read)] : [selection(read), generations(read)]),
    schedule(set),
  ].filter((sentence) => sentence !== "")
    .join(" ");
};

function life(read: Read): string {
  const has_networks = read.choice("controller") === "network", always = read.choice("flee_rule") === "always";
  const food = shown_number(read.number("food_health")), poison = shown_number(read.number("poison_harm"));
  const obstacles = read.number("obstacle_count"), crates = read.number("crate_count");
  const among =
    [
      obstacles > 0 ? counted(obstacles, "Hindernis", "Hindernissen") : "",
      crates > 0 ? counted(crates, "Kiste", "Kisten") : "",
    ].filter((part) => part !== "")
      .join(" und ");
  const organisms = counted(read.number("population_size"), "Organismus", "Organismen");
  const loss = read.number("health_loss_per_s");
  return `${organisms}${has_networks ? ", gesteuert von neuronalen Netzen, die sich entwickeln," : ""} suchen${
           among ? ` zwischen ${among}` : ""} Futter (+${food} Gesundheit)` +
    (read.number("poison_count") === 0 ?
       "." :
       ` und ${always && !has_networks ? "fliehen immer vor Gift" : "meiden Gift"} (−${poison}).`) +
    (loss === 0 ? " Mit der Zeit verlieren sie keine Gesundheit." :
                  ` Jeder verliert ${shown_number(loss)} Gesundheit pro Sekunde und stirbt bei 0.`) +
    predators(read);
}

function predators(read: Read): string {
  const count = read.number("predator_count"), from = read.number("predator_from");
  const round = read.choice("reproduction") === "births" ? "Intervall" : "Generation";
  const when = from > 1 ? `Ab ${round} ${with_separators(from)} ` : "";
  const verb = count === 1 ? "jagt" : "jagen", who = `${with_separators(count)} Räuber`;
  return count === 0 ? "" : ` ${when === "" ? `${who} ${verb} sie.` : `${when}${verb} sie ${who}.`}`;
}

function births(read: Read): string {
  const who = read.choice("births") === "sexual" ? "zwei Organismen" : "ein Organismus";
  const verb = read.choice("births") === "sexual" ? "bekommen ein Kind und bezahlen" : "bekommt ein Kind und bezahlt";
  const limit = read.number("generation_limit");
  return `Es gibt keine Generationen: ${who} mit mindestens ${shown_number(read.number("birth_health"))} Gesundheit ${
           verb} es mit Gesundheit.` +
    (limit === 0 ? "" : ` Der Lauf endet nach Intervall ${with_separators(limit)}.`);
}

function migration(read: Read): string {
  const way = read.choice("migration"), epoch = read.number("migration_epoch"), count = read.number("migrant_count");
  if (way === "none") {
    return "Zwischen den Inseln wandert nichts.";
  }
  const which = read.choice("emigrants") === "best" ? (count === 1 ? "ihren besten" : "ihre besten") :
                                                      (count === 1 ? "einen zufälligen" : "zufällige");
  return `${epoch === 1 ? "Nach jeder Generation" : `Alle ${with_separators(epoch)} Generationen`} schickt jede Insel ${
    count === 1 ? `${which} Organismus` : `${which} ${with_separators(count)} Organismen`} als Kopie ${
    way === "ring"              ? "zur nächsten" :
      way === "fully_connected" ? "zu jeder anderen" :
                                  "zu einer zufälligen anderen"}.`;
}

function fitness_of(read: Read, fitness: string): string {
  if (read.choice("reproduction") === "births") {
    return "ist die Zahl der Kinder";
  }
  if (fitness === "external") {
    return "kommt am Ende jeder Generation von einem Programm";
  }
  if (fitness !== "life") {
    return `folgt allein aus den Genen (${fitness === "rastrigin" ? "Rastrigin-Funktion" : "ihre Summe"})`;
  }
  const parts = [
    ["fitness_per_second", "die gelebte Zeit"], ["fitness_per_health", "die Gesundheit am Ende"],
    ["fitness_per_food", "das gefressene Futter"], ["fitness_per_poison", "das gefressene Gift"]
  ] as const;
  const sum = parts.filter(([name]) => read.number(name) !== 0).map(([name, part], n) => {
    const weight = read.number(name), size = Math.abs(weight);
    const sign = n === 0 ? (weight < 0 ? "−" : "") : weight < 0 ? "minus " : "plus ";
    return `${sign}${size === 1 ? "" : `${shown_number(size)} × `}${part}`;
  });
  return sum.length === 0 ? "ist für alle 0" : `ist ${sum.join(" ")}`;
}

function selection(read: Read): string {
  if (read.flag("shuffle_fitness")) {
    return "Die Fitness wird vor der Selektion gemischt, daher haben fittere nicht mehr Nachkommen als andere.";
  }
  switch (read.choice("selection")) {
    case "random":
      return "Die Eltern werden ausgelost, ohne Rücksicht auf ihre Fitness.";
    case "truncation":
      return "Nur die fittesten haben Nachkommen.";
    default:
      return "Im Mittel haben fittere Organismen mehr Nachkommen.";
  }
}

function generations(read: Read): string {
  const model = read.choice("population_model"), elite = read.number("elite_count");
  const limit = read.number("generation_limit");
  return [
    model === "generational" ?
      `Jede Generation ersetzt alle Organismen${
        elite === 0 ? "" : ` außer ${elite === 1 ? "dem besten" : `den ${with_separators(elite)} besten`}`}.` :
      model === "steady_state" ?
      `Jede Generation ersetzt nur die schlechtesten (${with_separators(read.number("replaced_count"))}).` :
      model === "nsga2"             ? "Die besten überleben, und die Eltern werden unter ihnen ausgewählt." :
      read.flag("mutate_survivors") ? "Auch Überlebende mutieren." :
                                      "",
    limit === 0 ? "" : `Der Lauf endet nach Generation ${with_separators(limit)}.`,
  ].filter((sentence) => sentence !== "")
    .join(" ");
}

function schedule({schedule: values = []}: ParameterSet): string {
  const all =
    [...new Set(values.map(({generation = 0}) => generation))].map((generation) => with_separators(generation));
  const last = all.pop();
  return last === undefined ?
    "" :
    `Parameter ändern sich in Generation ${all.length > 0 ? `${all.join(", ")} und ` : ""}${last}.`;
}
