// CompareView: the fitness of all worlds of a class in one plot, medians of groups that differ in a parameter, and a
// table of the parameters that differ.
import {Plot} from "../plots/plot";
import type {Series, SeriesColour} from "../plots/plot_content";
import {compare_texts as texts} from "../texts/class";
import {fitness_text} from "../texts/numbers";
import {set_options} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {hint, row} from "../widgets/form";
import {value_text} from "../world/parameter_values";
import {label_of} from "../world/parameters";

import type {ForAllContext} from "./for_all";
import {type Curve, differing, grouped_by, median, median_of, type Values, values_of} from "./compare";
import type {Student} from "./class_model";

const colours: SeriesColour[] = ["orange", "sky", "green", "vermilion", "blue", "purple"];
const read_ms = 5000; // least time between two readings of the parameters
const plot_height = 300, line_pixels = 1.2, median_pixels = 3.5;

interface Compared extends Student {
  values: Values;
}

export class CompareView {
  readonly element: HTMLElement;
  readonly #context: ForAllContext;
  readonly #open: (world: string) => void;
  readonly #plot = new Plot({height: plot_height});
  readonly #by = h("select", {class: "field", id: "class-by", onchange: () => this.#draw()});
  readonly #groups = h("tbody", {});
  readonly #group_table: HTMLElement;
  readonly #table = h("table", {class: "table", "aria-label": texts.table});
  readonly #none = h("p", {class: "hint"});
  #values = new Map<string, Values>(); // by world
  #read_ms = -Infinity;
  #drawn = "";

  /** open: shows the world of a student */
  constructor(context: ForAllContext, open: (world: string) => void) {
    this.#context = context;
    this.#open = open;
    const headings =
      texts.group_headings.map((text, i) => h("th", {scope: "col", class: i > 0 ? "number" : null}, text));
    this.#group_table =
      h("table", {class: "table", "aria-label": texts.groups}, h("thead", {}, h("tr", {}, ...headings)), this.#groups);
    this.element =
      h("div", {class: "class-compare"},
        row(
          h("label",
            {for: "class-by"
            },
            texts.group_by),
          this.#by),
        this.#plot.element, this.#group_table, h("h3", {}, texts.table), this.#none,
        h("div", {class: "class-table"}, this.#table), hint(texts.help));
  }

  close(): void {
    this.#plot.close();
  }

  refresh(): void {
    const now_ms = performance.now();
    if (now_ms - this.#read_ms > read_ms) {
      this.#read_ms = now_ms;
      void this.#read();
    }
    const key = this.#context.model.students.map(({world, history}) => `${world} ${history?.table.revision}`).join();
    if (key !== this.#drawn) {
      this.#drawn = key;
      this.#draw();
    }
  }

  /** Reads the parameters of all worlds. */
  async #read(): Promise<void> {
    const {server, model} = this.#context;
    await Promise.all(model.students.filter(({info}) => info !== null).map(async ({world}) => {
      try {
        this.#values.set(world, values_of(await server.request("get_parameters", {world})));
      } catch {
        this.#values.delete(world); // the world was deleted
      }
    }));
    this.#draw();
  }

  get #compared(): Compared[] {
    return this.#context.model.students.flatMap((student) => {
      const values = this.#values.get(student.world);
      return values ? [{...student, values}] : [];
    });
  }

  #draw(): void {
    const compared = this.#compared, names = differing(compared.map(({values}) => values));
    const label = (name: string): string =>
      label_of(this.#context.server.parameters.find((about) => about.name === name) ?? {name});
    set_options(
      this.#by, [{value: "", text: texts.no_groups}, ...names.map((name) => ({value: name, text: label(name)}))],
      names.includes(this.#by.value) ? this.#by.value : "");
    this.#draw_plot(compared, this.#by.value, label);
    set_text(this.#none, names.length === 0 ? texts.no_difference : "");
    this.#table.hidden = names.length === 0;
    const head = ["", ...names.map(label), texts.best];
    this.#table.replaceChildren(
      h("thead", {},
        h("tr", {}, ...head.map((text, i) => h("th", {scope: "col", class: i > 0 ? "number" : null}, text)))),
      h("tbody", {}, ...compared.map(({name, world, values, standing}) => {
        const open = h("button", {type: "button", class: "link", onclick: () => this.#open(world)}, name);
        const cells = names.map((parameter) => h("td", {class: "number"}, value_text(values.get(parameter) ?? {})));
        return h(
          "tr", {}, h("th", {scope: "row"}, open), ...cells, h("td", {class: "number"}, fitness_of(standing.best)));
      })));
  }

  #draw_plot(compared: readonly Compared[], parameter: string, label: (name: string) => string): void {
    const groups = parameter === "" ? [] : grouped_by(compared, parameter);
    const students = groups.length > 0 ? compared : this.#context.model.students;
    const group_of = (student: Student): number =>
      groups.findIndex(({members}) => members.some(({world}) => world === student.world));
    const lines = students.map((student, i): Series => {
      const {x, y} = curve_of(student), group = group_of(student);
      const colour = colours[(group < 0 ? i : group) % colours.length]!;
      return {
        kind: "line",
        name: student.name,
        colour,
        x: [...x],
        y: [...y],
        in_legend: group < 0,
        thickness: line_pixels
      };
    });
    const medians = groups.map(({value, members}, i): Series => {
      const {x, y} = median_of(members.map(curve_of)), colour = colours[i % colours.length]!;
      const name = texts.median(label(parameter), value_text(value), members.length);
      return {kind: "line", name, colour, x: [...x], y: [...y], thickness: median_pixels};
    });
    this.#plot.set_content({
      title: texts.plot,
      series: [...medians, ...lines.filter(({x}) => x.length > 0)],
      x_label: texts.generation,
      y_label: texts.fitness,
      counted_x: true,
      empty: texts.no_curves
    });
    this.#group_table.hidden = groups.length === 0;
    this.#groups.replaceChildren(...groups.map(({value, members}) => {
      const bests = members.map(({standing}) => standing.best).filter((best) => Number.isFinite(best));
      const cells = [String(members.length), fitness_of(bests.length > 0 ? median(bests) : NaN)];
      return h(
        "tr", {}, h("th", {scope: "row"}, value_text(value)), ...cells.map((text) => h("td", {class: "number"}, text)));
    }));
  }
}

function curve_of({history}: Student): Curve {
  return {x: history?.table.column(null, "generation") ?? [], y: history?.table.column(null, "fitness_best") ?? []};
}

function fitness_of(value: number): string {
  return Number.isFinite(value) ? fitness_text(value) : "–";
}
