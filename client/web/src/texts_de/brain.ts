// brain: the drawing of a network in the panel "Organism".
import type * as english from "../texts/brain";

import {gene_label} from "./genes";
import {localised} from "./numbers";

export const brain_texts: typeof english.brain_texts = {
  hint: "Kreise: Aktivierung; Linien: Gewichte, je größer, desto breiter. Orange, durchgezogen: positiv; blau, " +
    "gestrichelt: negativ. Zeigt der Mauszeiger auf eine Linie oder einen Kreis, erscheinen die Zahlen; mit der " +
    "Tastatur: Pfeiltasten, Eingabe.",
  network: (inputs, hidden, outputs) => `Netz: ${inputs} Eingänge, ${hidden} verdeckte Neuronen, ${outputs} Ausgänge`,
  hidden: (number) => `hidden${number}`,
  bias: "Bias",
  constant: "Bias: die Konstante 1",
  number: (value) => (value < 0 ? "−" : "") + localised(Math.abs(value).toFixed(2)),
  connection: (from, to, weight) => `${gene_label(from)} → ${gene_label(to)}: Gewicht ${brain_texts.number(weight)}`,
  neuron: (name, activation) => `${gene_label(name)}: ${brain_texts.number(activation)}`,
  neuron_with_inputs: (neuron, inputs) => `${neuron}. Eingänge: ${inputs.join("; ")}`,
  input: (name, weight) => `${gene_label(name)} × ${brain_texts.number(weight)}`,
  weaker: (count) => `und ${count} schwächere`,
};
