// BrainDiagram: positions of the neurons and connections of a network, for a drawing. Inputs are at the left, hidden
// neurons in the middle, outputs at the right. No DOM.
import type {Brain} from "../core/protocol";
import {brain_texts as texts} from "../texts/brain";

export interface Neuron {
  kind: "input"|"hidden"|"output"|"bias";
  layer: number; // 0 to 2
  name: string;
  activation: number; // -1 to 1; 1 for a bias
  x: number;
  y: number;
  radius: number;
}

export interface Connection {
  from: number; // indices of neurons
  to: number;
  gene: number; // index of its weight among the genes of the group `brain`
  weight: number;
  strength: number; // share of the largest weight, 0 to 1
}

export interface BrainDiagram {
  width: number;
  height: number;
  neurons: Neuron[];
  connections: Connection[]; // the weakest first
}

const row_height = 22;
const height_max = 300;
const radius_max = 7;
const shown_inputs_max = 8; // in the text of a neuron

/** Returns null if the number of weights is not that of the network.
 *
 *  weights       the genes of the group `brain`: see Brain in world.proto
 *  label_widths  room for the names at the left and at the right, in the unit of `width` */
export function brain_diagram(
  brain: Brain, weights: readonly number[], width: number,
  label_widths: {inputs: number; outputs: number}): BrainDiagram|null {
  const inputs = brain.inputs ?? [], hidden = brain.hidden ?? [], outputs = brain.outputs ?? [];
  const bias = brain.has_bias ? 1 : 0;
  const weight_count = hidden.length * (inputs.length + bias) + outputs.length * (hidden.length + bias);
  if (inputs.length === 0 || hidden.length === 0 || outputs.length === 0 || weights.length !== weight_count) {
    return null;
  }
  const rows = Math.max(inputs.length + bias, hidden.length + bias, outputs.length);
  const diagram: BrainDiagram = {width, height: Math.min(rows * row_height, height_max), neurons: [], connections: []};
  const left = label_widths.inputs, right = width - label_widths.outputs;
  const add_layer =
    (layer: number, kind: Neuron["kind"], names: string[], activations: number[], x: number, has_bias: boolean):
      [number, number] => {
        const count = activations.length + (has_bias ? 1 : 0);
        const row = Math.min(diagram.height / count, row_height);
        const radius = Math.min(radius_max, row * 0.42);
        const top = (diagram.height - row * count) / 2 + row / 2;
        const begin = diagram.neurons.length;
        activations.forEach((activation, i) => {
          diagram.neurons.push({kind, layer, name: names[i] ?? String(i + 1), activation, x, y: top + row * i, radius});
        });
        if (has_bias) {
          diagram.neurons.push(
            {kind: "bias", layer, name: texts.bias, activation: 1, x, y: top + row * (count - 1), radius});
        }
        return [begin, diagram.neurons.length];
      };
  const first = add_layer(0, "input", brain.input_names ?? [], inputs, left, bias !== 0);
  const middle =
    add_layer(1, "hidden", hidden.map((_, i) => texts.hidden(i + 1)), hidden, (left + right) / 2, bias !== 0);
  const last = add_layer(2, "output", brain.output_names ?? [], outputs, right, false);
  let gene = 0;
  for (const [before, layer] of [[first, middle], [middle, last]] as const) {
    for (let to = layer[0]; to < layer[1]; ++to) {
      if (diagram.neurons[to]!.kind === "bias") {
        continue;
      }
      for (let from = before[0]; from < before[1]; ++from) {
        diagram.connections.push({from, to, gene, weight: weights[gene]!, strength: 0});
        ++gene;
      }
    }
  }
  const largest = diagram.connections.reduce((most, connection) => Math.max(most, Math.abs(connection.weight)), 0);
  for (const connection of diagram.connections) {
    connection.strength = largest > 0 ? Math.abs(connection.weight) / largest : 0;
  }
  diagram.connections.sort((a, b) => a.strength - b.strength);
  return diagram;
}

/** The connections of a neuron as indices, the strongest first. */
export function connections_of(diagram: BrainDiagram, neuron: number): number[] {
  const found: number[] = [];
  for (let i = diagram.connections.length - 1; i >= 0; --i) {
    if (diagram.connections[i]!.from === neuron || diagram.connections[i]!.to === neuron) {
      found.push(i);
    }
  }
  return found;
}

/** The neuron that an arrow key leads to: up and down within a layer, left and right to the nearest of the next layer.
 *  */
export function neighbour(diagram: BrainDiagram, neuron: number, key: string): number {
  const of = diagram.neurons[neuron]!;
  const step = key === "ArrowUp" || key === "ArrowLeft" ? -1 : 1;
  if (key === "ArrowUp" || key === "ArrowDown") {
    return diagram.neurons[neuron + step]?.layer === of.layer ? neuron + step : neuron;
  }
  let nearest = neuron, distance = Infinity;
  diagram.neurons.forEach((other, i) => {
    if (other.layer === of.layer + step && Math.abs(other.y - of.y) < distance) {
      nearest = i;
      distance = Math.abs(other.y - of.y);
    }
  });
  return nearest;
}

/** "hidden3 → turn: weight −0.42" */
export function connection_text(diagram: BrainDiagram, {from, to, weight}: Connection): string {
  return texts.connection(diagram.neurons[from]!.name, diagram.neurons[to]!.name, weight);
}

/** "hidden3: 0.31. Inputs: food distance × −1.20, …", the strongest first. */
export function neuron_text(diagram: BrainDiagram, neuron: number): string {
  const of = diagram.neurons[neuron]!;
  if (of.kind === "bias") {
    return texts.constant;
  }
  const inputs = connections_of(diagram, neuron).map((i) => diagram.connections[i]!).filter(({to}) => to === neuron);
  const shown =
    inputs.slice(0, shown_inputs_max).map(({from, weight}) => texts.input(diagram.neurons[from]!.name, weight));
  if (inputs.length > shown.length) {
    shown.push(texts.weaker(inputs.length - shown.length));
  }
  const text = texts.neuron(of.name, of.activation);
  return shown.length === 0 ? text : texts.neuron_with_inputs(text, shown);
}
