// brain: the drawing of a network in the panel "Organism".
import {gene_label} from "./genes";

export const brain_texts = {
  hint: "Circles: activation; lines: weights, wider if larger. Orange, solid: positive; blue, dashed: negative. " +
    "Point at a line or a circle to read its numbers; with the keyboard: arrow keys, Enter.",
  network: (inputs: number, hidden: number, outputs: number) =>
    `Network: ${inputs} inputs, ${hidden} hidden neurons, ${outputs} outputs`,
  hidden: (number: number) => `hidden${number}`,
  bias: "bias",
  constant: "bias: a constant 1",
  /** "−0.42" */
  number: (value: number) => (value < 0 ? "−" : "") + Math.abs(value).toFixed(2),
  connection: (from: string, to: string, weight: number) =>
    `${gene_label(from)} → ${gene_label(to)}: weight ${brain_texts.number(weight)}`,
  neuron: (name: string, activation: number) => `${gene_label(name)}: ${brain_texts.number(activation)}`,
  neuron_with_inputs: (neuron: string, inputs: readonly string[]) => `${neuron}. Inputs: ${inputs.join(", ")}`,
  input: (name: string, weight: number) => `${gene_label(name)} × ${brain_texts.number(weight)}`,
  weaker: (count: number) => `and ${count} weaker`,
};
