// BrainView: the drawing of a network in the panel "organism". Circles are activations, lines are weights. The sign of
// a weight is visible by colour and by dashes, its size by the width of the line.
//
// Keyboard  The drawing is one tab stop. Arrow keys move between neurons; Enter steps through the connections of a
// neuron.
import {
  brain_diagram,
  BrainDiagram,
  connection_text,
  connections_of,
  neighbour,
  Neuron,
  neuron_text
} from "../organism/brain";
import type {Brain} from "../core/protocol";
import {brain_texts as texts} from "../texts/brain";
import {gene_label} from "../texts/genes";
import {h, set_text, svg} from "../widgets/dom";
import {svg_label, svg_line, svg_rect} from "../widgets/svg";

const character_width = 6.6; // of a label, in CSS pixels
const number_width = 38; // of " −0.00"

export class BrainView {
  readonly element: HTMLElement;
  readonly #drawing = h("div", {class: "brain-drawing"});
  readonly #note = h("p", {class: "hint brain-note", "aria-live": "polite"});
  #diagram: BrainDiagram|null = null;
  #weights: readonly number[] = [];
  #shape = "";
  #lines: SVGLineElement[] = [];
  #circles: {group: SVGGElement; fill: SVGCircleElement | null; value: SVGTextElement | null}[] = [];
  #neuron: number|null = null; // pointed at, or with the keyboard focus
  #connection: number|null = null;
  #stop = 0; // the neuron that Tab leads to

  constructor() {
    this.element = h("div", {class: "brain"}, this.#drawing, this.#note);
  }

  /** Returns false if the message does not describe a network with these weights. */
  update(brain: Brain, weights: readonly number[], width: number): boolean {
    const widest = (names: string[]|undefined): number =>
      Math.max(0, ...(names ?? []).map((name) => name.length)) * character_width + 14;
    const diagram = brain_diagram(
      brain, weights, width, {inputs: widest(brain.input_names), outputs: widest(brain.output_names) + number_width});
    if (!diagram) {
      return false;
    }
    const shape = `${width}/${diagram.neurons.map((neuron) => neuron.kind + neuron.name).join()}`;
    const same = shape === this.#shape && weights.length === this.#weights.length &&
      weights.every((weight, i) => weight === this.#weights[i]);
    this.#diagram = diagram;
    if (!same) {
      this.#shape = shape;
      this.#weights = [...weights];
      this.#neuron = this.#connection = null;
      this.#stop = 0;
      this.#build(diagram);
    }
    this.#show_activations(diagram);
    this.#show_note();
    return true;
  }

  #build(diagram: BrainDiagram): void {
    const count = (kind: Neuron["kind"]): number => diagram.neurons.filter((neuron) => neuron.kind === kind).length;
    const root = svg("svg", {
      class: "brain-svg",
      viewBox: `0 0 ${diagram.width} ${diagram.height}`,
      width: diagram.width,
      height: diagram.height,
      role: "group",
      "aria-label": texts.network(count("input"), count("hidden"), count("output")),
      onkeydown: (event: KeyboardEvent) => this.#press(event),
      onmouseleave: () => this.#point(null, null),
    });
    this.#lines = diagram.connections.map((connection, i) => {
      const from = diagram.neurons[connection.from]!, to = diagram.neurons[connection.to]!;
      const line =
        svg_line(connection.weight < 0 ? "weight negative" : "weight positive", [from.x, from.y, to.x, to.y], {
          "stroke-width": (0.6 + 2.6 * connection.strength).toFixed(2),
          "stroke-opacity": (0.25 + 0.75 * connection.strength ** 1.5).toFixed(2)
        });
      const target =
        svg_line("weight-target", [from.x, from.y, to.x, to.y], {onmouseenter: () => this.#point(null, i)});
      root.append(line, target);
      return line;
    });
    this.#circles = diagram.neurons.map((neuron, i) => {
      const group = svg("g", {
        class: "neuron " + neuron.kind,
        tabindex: i === this.#stop ? 0 : -1,
        role: "img",
        onmouseenter: () => this.#point(i, null),
        onfocus: () => this.#take_focus(i),
        onblur: () => this.#point(null, null),
      });
      let fill: SVGCircleElement|null = null;
      let value: SVGTextElement|null = null;
      if (neuron.kind === "bias") {
        const side = neuron.radius * 1.6;
        group.append(svg_rect("neuron-base", [neuron.x - side / 2, neuron.y - side / 2, side, side]));
      } else {
        fill = svg("circle", {class: "neuron-fill", cx: neuron.x, cy: neuron.y, r: neuron.radius});
        group.append(svg("circle", {class: "neuron-base", cx: neuron.x, cy: neuron.y, r: neuron.radius}), fill);
      }
      const gap = neuron.radius + 5;
      if (neuron.layer === 0) {
        group.append(
          svg_label("neuron-name", [neuron.x - gap, neuron.y], gene_label(neuron.name), {"text-anchor": "end"}));
      } else if (neuron.kind === "output") {
        value = svg("text", {class: "neuron-value", x: diagram.width - 2, y: neuron.y, "text-anchor": "end"});
        group.append(svg_label("neuron-name", [neuron.x + gap, neuron.y], gene_label(neuron.name)), value);
      }
      root.append(group);
      return {group, fill, value};
    });
    this.#drawing.replaceChildren(root);
    this.#emphasise();
  }

  #show_activations(diagram: BrainDiagram): void {
    diagram.neurons.forEach((neuron, i) => {
      const {group, fill, value} = this.#circles[i]!;
      group.setAttribute("aria-label", neuron_text(diagram, i));
      if (fill) {
        fill.setAttribute("class", neuron.activation < 0 ? "neuron-fill negative" : "neuron-fill positive");
        fill.setAttribute("fill-opacity", Math.min(1, Math.abs(neuron.activation)).toFixed(2));
      }
      if (value) {
        set_text(value, texts.number(neuron.activation));
      }
    });
  }

  #point(neuron: number|null, connection: number|null): void {
    if (neuron === this.#neuron && connection === this.#connection) {
      return;
    }
    this.#neuron = neuron;
    this.#connection = connection;
    this.#emphasise();
    this.#show_note();
  }

  /** Draws only the lines of the neuron in question, and marks the connection in question. */
  #emphasise(): void {
    this.#lines.forEach((line, i) => {
      const connection = this.#diagram!.connections[i]!;
      const hidden = this.#neuron !== null && connection.from !== this.#neuron && connection.to !== this.#neuron;
      line.classList.toggle("faded", hidden);
      line.classList.toggle("marked", i === this.#connection);
    });
  }

  #show_note(): void {
    const diagram = this.#diagram!;
    set_text(
      this.#note,
      this.#connection !== null ? connection_text(diagram, diagram.connections[this.#connection]!) :
        this.#neuron !== null   ? neuron_text(diagram, this.#neuron) :
                                  texts.hint);
  }

  #take_focus(neuron: number): void {
    this.#circles[this.#stop]!.group.setAttribute("tabindex", "-1");
    this.#stop = neuron;
    this.#circles[neuron]!.group.setAttribute("tabindex", "0");
    this.#point(neuron, null);
  }

  #press(event: KeyboardEvent): void {
    const diagram = this.#diagram!;
    if (event.key.startsWith("Arrow")) {
      this.#circles[neighbour(diagram, this.#stop, event.key)]!.group.focus();
    } else if (event.key === "Enter" || event.key === " ") {
      const all = connections_of(diagram, this.#stop);
      this.#point(
        this.#stop, all[(this.#connection === null ? -1 : all.indexOf(this.#connection)) + 1] ?? all[0] ?? null);
    } else {
      return;
    }
    event.preventDefault();
    event.stopPropagation();
  }
}
