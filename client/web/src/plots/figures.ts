// figures: the plots of one history, or of one history compared with another. Pure functions.
import type {HistoryTable, Island} from "./history_table";
import type {Marks, PlotContent, Series, SeriesColour} from "./plot_content";
import {compare_dash, histogram, range_of, running_mean} from "./plot_layout";
import type {Mark, Numbers} from "./plot_layout";

export type Quantity = "Fitness"|"Genes"|"Selection"|"Diversity"|"Survivors"|"Deaths"|"Food";
export const quantities: readonly Quantity[] =
  ["Fitness", "Genes", "Selection", "Diversity", "Survivors", "Deaths", "Food"];

/** The maximum number of genes in one plot. */
export const genes_in_plot_max = 12;

/** One history in a plot. */
export interface Subject {
  table: HistoryTable;
  island: Island;
  name: string; // in the legend of a comparison
  gene_names: readonly string[];
  changes: readonly(Mark&{label?: string})[]; // changes of parameters and other events, in order
}

/** How a line looks besides its colour, so that lines differ also without colours. */
interface Style {
  dash: readonly number[];
  thickness: number;
}
const plain: Style = {
  dash: [],
  thickness: 1.8
},
             thick: Style = {
               dash: [],
               thickness: 2.8
             },
             dotted: Style = {
               dash: [2, 2.5],
               thickness: 1.8
             },
             thin: Style = {
               dash: [8, 3, 2, 3],
               thickness: 1.2
             };

const gene_colours: readonly SeriesColour[] = ["blue", "orange", "green", "purple", "vermilion", "sky"];
const gene_dashes: readonly(readonly number[])[] = [[], [9, 3], [2, 2.5], [9, 3, 2, 3], [4.5, 2], [14, 3, 2, 3, 2, 3]];
function gene_style(index: number): Style&{colour: SeriesColour} {
  const round = Math.floor(index / gene_colours.length);
  return {
    colour: gene_colours[index % gene_colours.length]!,
    dash: gene_dashes[(index + 3 * round) % gene_dashes.length]!,
    thickness: round % 2 === 1 ? 1.2 : 2
  };
}

/** "mean of 10" */
export function running_mean_name(window: number): string {
  return `mean of ${window}`;
}

class FigureBuilder {
  readonly content: PlotContent;

  readonly #subject: Subject;
  readonly #other: Subject|null;
  readonly #window: number;

  constructor(subject: Subject, other: Subject|null, window: number) {
    this.#subject = subject;
    this.#other = other;
    this.#window = window;
    const marks: Marks[] = [{marks: subject.changes, name: other !== null ? subject.name : ""}];
    if (other !== null) {
      marks.push({marks: other.changes, name: other.name});
    }
    this.content = {
      title: "",
      series: [],
      x_label: "generation",
      y_label: "",
      marks,
      smoothed: running_mean_name(window),
      counted_x: true
    };
  }

  /** Adds a line for a column of the subject; if `compared`, also one for the same column of the other subject. */
  line(
    column: string, name: string, colour: SeriesColour, style: Style, compared: boolean, whole = false,
    other_column: string|null = column): void {
    const is_compared =
      this.#other !== null && compared && other_column !== null && is_known(column_of(this.#other, other_column));
    this.#add_line(this.#subject, column, name, colour, is_compared ? {...style, dash: []} : style, whole, true);
    if (this.#other !== null && is_compared) {
      this.#add_line(
        this.#other, other_column, `${name}, ${this.#other.name}`, colour, {...style, dash: compare_dash}, whole,
        false);
      this.content.solid = this.#subject.name;
      this.content.dashed = this.#other.name;
    }
  }

  /** Adds a band of one standard deviation on either side of the mean, as far as it is within the range of the values. */
  band(prefix: string, least: string, greatest: string, colour: SeriesColour): void {
    const mean = column_of(this.#subject, `${prefix}mean`), deviation = column_of(this.#subject, `${prefix}deviation`);
    const min = column_of(this.#subject, least), max = column_of(this.#subject, greatest);
    if (!is_known(mean)) {
      return;
    }
    const low = mean.map((number, i) => Math.max(number - deviation[i]!, min[i]!)),
          high = mean.map((number, i) => Math.min(number + deviation[i]!, max[i]!));
    this.content.series.push({
      kind: "band",
      name: "± 1 standard deviation",
      colour,
      x: column_of(this.#subject, "generation"),
      y: running_mean(high, this.#window),
      low: running_mean(low, this.#window)
    });
  }

  stack(column: string, name: string, colour: SeriesColour): void {
    const y = column_of(this.#subject, column);
    if (is_known(y)) {
      this.content.series.push({
        kind: "stack",
        name: this.#named(name, this.#subject),
        colour,
        x: column_of(this.#subject, "generation"),
        y,
        whole: true
      });
    }
  }

  /** Adds a dashed line over the stacks for a column of the other subject. */
  compare(column: string, name: string, colour: SeriesColour): void {
    if (this.#other !== null) {
      this.#add_line(
        this.#other, column, this.#named(name, this.#other), colour, {dash: compare_dash, thickness: 1.8}, true, true);
    }
  }

  #named(name: string, subject: Subject): string {
    return this.#other === null ? name : `${name}, ${subject.name}`;
  }

  #add_line(
    subject: Subject, column: string, name: string, colour: SeriesColour, style: Style, whole: boolean,
    in_legend: boolean): void {
    const raw = column_of(subject, column);
    if (is_known(raw)) {
      const series:
        Series = {kind: "line", name, colour, ...style, x: column_of(subject, "generation"), y: raw, whole, in_legend};
      this.content.series.push(this.#window > 1 ? {...series, y: running_mean(raw, this.#window), raw} : series);
    }
  }
}

function column_of(subject: Subject, name: string): number[] {
  return subject.table.column(subject.island, name);
}

function is_known(column: readonly number[]): boolean {
  return column.some((number) => Number.isFinite(number));
}

/** Returns whether an axis from 0 leaves the curves of fitness at least half of its height. */
function starts_at_zero(subject: Subject): boolean {
  const worst = range_of(column_of(subject, "fitness_worst")), best = range_of(column_of(subject, "fitness_best"));
  return worst !== null && best !== null && worst.min < best.max / 2;
}

/** Returns the name of a column of a gene; null if the subject has no such gene. */
function gene_column(subject: Subject, gene: string, part: string): string|null {
  const index = subject.gene_names.indexOf(gene);
  return index >= 0 ? `gene:${index}:${part}` : null;
}

/** Builds the plot of a quantity.
 *
 *  genes   the genes whose means, or whose selection, are plotted together
 *  gene    the one gene that is shown instead; empty: all of `genes`
 *  other   the compared history; null: none. If it has no island of this number, all its islands together are shown
 *  window  generations of the running mean of each line and band; 1: none */
export function figure_of(
  quantity: Quantity, subject: Subject, other: Subject|null, genes: readonly string[], gene: string,
  window: number): PlotContent {
  const make = new FigureBuilder(subject, other, window), {content} = make;
  const is_weight = (gene || genes[0] || "").includes("<");
  const gene_line =
    (of: string, part: string, name: string, colour: SeriesColour, style: Style, compared: boolean): void => {
      const column = gene_column(subject, of, part);
      if (column !== null) {
        make.line(column, name, colour, style, compared, false, other === null ? null : gene_column(other, of, part));
      }
    };
  const gene_lines = (part: string): void => genes.forEach((each, i) => {
    const {colour, ...style} = gene_style(i);
    gene_line(each, part, each, colour, style, true);
  });
  switch (quantity) {
    case "Fitness":
      content.title = "Fitness";
      content.y_label = "fitness";
      content.from_zero = starts_at_zero(subject);
      make.line("fitness_best", "best", "vermilion", plain, true);
      make.line("fitness_mean", "mean", "blue", thick, true);
      make.line("fitness_median", "median", "sky", dotted, false);
      make.line("fitness_worst", "worst", "grey", thin, false);
      make.band("fitness_", "fitness_worst", "fitness_best", "blue");
      break;
    case "Genes":
      content.y_label = is_weight ? "weight" : "gene units";
      if (gene === "") {
        content.title = "Means of the genes";
        gene_lines("mean");
      } else {
        content.title = `Gene ${gene}`;
        gene_line(gene, "mean", "mean", "green", thick, true);
        gene_line(gene, "max", "greatest", "grey", thin, false);
        gene_line(gene, "min", "least", "grey", dotted, false);
        const column = gene_column(subject, gene, "");
        if (column !== null) {
          make.band(column, `${column}min`, `${column}max`, "green");
        }
      }
      break;
    case "Selection":
      content.y_label = is_weight ? "weight per generation" : "gene units per generation";
      if (gene === "") {
        content.title = "Selection of the genes";
        gene_lines("selection");
      } else { // the change is the sum of the other series
        content.title = `Causes of change in the mean of ${gene}`;
        gene_line(gene, "change", "change", "grey", thick, true);
        gene_line(gene, "selection", "selection", "blue", plain, true);
        gene_line(gene, "transmission", "transmission", "orange", {dash: [9, 3], thickness: 1.8}, true);
        gene_line(gene, "migration", "migration", "purple", dotted, true);
      }
      break;
    case "Diversity":
      content.title = "Diversity";
      content.y_label = "mean standard deviation, as a share of the gene's range";
      content.from_zero = true;
      make.line("diversity", "diversity", "purple", plain, true);
      break;
    case "Survivors":
      content.title = "Alive at the end";
      content.y_label = "organisms";
      content.from_zero = true;
      make.line("alive_count", "alive at the end", "green", plain, true, true);
      make.line("organism_count", "born", "grey", thin, false, true);
      break;
    case "Deaths":
      content.title = "Causes of death";
      content.y_label = "organisms";
      content.from_zero = true;
      make.stack("starved_count", "starved", "orange");
      make.stack("poisoned_count", "poisoned", "vermilion");
      make.stack("alive_count", "alive at the end", "green");
      make.compare("starved_count", "starved", "sky");
      make.compare("poisoned_count", "poisoned", "blue");
      break;
    case "Food":
      content.title = "Food and poison eaten";
      content.y_label = "items per generation";
      content.from_zero = true;
      make.line("food_eaten", "food eaten", "green", plain, true, true);
      make.line("poison_eaten", "poison eaten", "vermilion", {dash: [9, 3], thickness: 1.8}, true, true);
      break;
  }
  return content;
}

/** Returns those of the genes that have changed most, the most changed first: in their mean or, for Selection, by selection. If there are at
 *  most `count_max`, returns all of them in their order. */
export function most_changed(
  quantity: Quantity, subject: Subject, genes: readonly string[], count_max = genes_in_plot_max): string[] {
  if (genes.length <= count_max) {
    return [...genes];
  }
  const change_of = (gene: string): number => {
    const column = gene_column(subject, gene, quantity === "Selection" ? "selection" : "mean");
    const numbers = column === null ? [] : column_of(subject, column);
    const change = quantity === "Selection" ?
      numbers.reduce((sum, number) => (Number.isFinite(number) ? sum + number : sum), 0) :
      numbers.length > 0 ? numbers[numbers.length - 1]! - numbers[0]! :
                           0;
    return Number.isFinite(change) ? Math.abs(change) : 0;
  };
  const ranked = genes.map((gene) => ({gene, change: change_of(gene)})); // the sort is stable: ties keep their order
  return ranked.sort((a, b) => b.change - a.change).slice(0, count_max).map(({gene}) => gene);
}

/** Builds a histogram of a gene's values, one value per organism. */
export function histogram_of(gene: string, values: Numbers): PlotContent {
  const range = range_of(values) ?? {min: 0, max: 1};
  const shown = range.max > range.min ? range : {min: range.min - 0.5, max: range.max + 0.5};
  const count = Math.min(Math.max(Math.round(Math.sqrt(values.length)), 8), 60);
  const width = (shown.max - shown.min) / count;
  const series: Series[] = values.length === 0 ? [] : [{
    kind: "bars",
    name: "organisms",
    colour: "green",
    in_legend: false,
    bar_width: width,
    whole: true,
    x: Array.from({length: count}, (_, i) => shown.min + (i + 0.5) * width),
    y: histogram(values, shown, count),
  }];
  return {title: `Values of ${gene}`, series, x_label: gene, y_label: "organisms", from_zero: true, empty: "…"};
}

/** Returns marks where all organisms of the history died, unless this happened in more than a tenth of the generations. */
export function extinctions(table: HistoryTable, island: Island): (Mark&{label: string})[] {
  const generation = table.column(island, "generation"), alive = table.column(island, "alive_count"),
        born = table.column(island, "organism_count");
  const found = generation.filter((_, i) => alive[i] === 0 && born[i]! > 0);
  return found.length * 10 > generation.length ?
    [] :
    found.map((x) => ({x, text: `generation ${x}: all organisms died before its end`, label: "extinction"}));
}
