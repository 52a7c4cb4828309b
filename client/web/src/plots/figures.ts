// figures: the plots of one history, or of one history compared with another. Pure functions.
import {plot_texts} from "../texts/plot";
import {figure_texts as texts} from "../texts/plots_panel";
import {gene_name} from "../texts/genes";
import type {AccountPart, Column, GenePart, HistoryTable, Island} from "./history_table";
import {thickness_default} from "./plot_content";
import type {Marks, PlotContent, Series, SeriesColour} from "./plot_content";
import {compare_dash, histogram, range_of, running_mean} from "./plot_layout";
import type {Mark, Numbers} from "./plot_layout";

export type Quantity = "population"|"phase"|"fitness"|"genes"|"selection"|"diversity"|"survivors"|"deaths"|"food";
export const quantities: readonly Quantity[] =
  ["population", "phase", "fitness", "genes", "selection", "diversity", "survivors", "deaths", "food"];
/** Plots that only colonies have. The phase plot is another element (panels/plots_phase.ts). */
export const colony_quantities: readonly Quantity[] = ["population", "phase"];

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
function style(dash: readonly number[], thickness = thickness_default): Style {
  return {dash, thickness};
}
const plain = style([]), thick = style([], 2.8);
const dashed = style([9, 3]), dotted = style([2, 2.5]), thin = style([8, 3, 2, 3], 1.2);

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
      x_label: texts.generation,
      y_label: "",
      marks,
      smoothed: plot_texts.mean_of(window),
      counted_x: true
    };
  }

  /** Adds a line for a column of the subject.
   *
   *  compared      whether the same column of the other subject gets a line, too
   *  whole         the numbers are counts
   *  other_column  the column of the other subject, if its name differs; null: it has no such column */
  line(column: Column, name: string, colour: SeriesColour, style: Style, {
    compared,
    whole = false,
    other_column = column
  }: {compared: boolean; whole?: boolean; other_column?: Column | null}): void {
    const other = this.#other;
    const is_compared = other !== null && compared && other_column !== null && is_known(column_of(other, other_column));
    this.#add_line(this.#subject, column, {name, colour, ...style, ...(is_compared ? {dash: []} : {}), whole});
    if (is_compared) {
      this.#add_line(
        other, other_column,
        {name: texts.series_of(name, other.name), colour, ...style, dash: compare_dash, whole, in_legend: false});
      this.content.solid = this.#subject.name;
      this.content.dashed = other.name;
    }
  }

  /** Adds a line for a number of a gene, if the subject has this gene. */
  gene_line(
    gene: string, part: GenePart|AccountPart, name: string, colour: SeriesColour, style: Style,
    compared: boolean): void {
    const column = gene_column(this.#subject, gene, part);
    if (column !== null) {
      const other_column = this.#other === null ? null : gene_column(this.#other, gene, part);
      this.line(column, name, colour, style, {compared, other_column});
    }
  }

  /** Adds a line for the same number of each of several genes. */
  gene_lines(genes: readonly string[], part: GenePart|AccountPart): void {
    genes.forEach((gene, i) => {
      const {colour, ...style} = gene_style(i);
      this.gene_line(gene, part, gene_name(gene), colour, style, true);
    });
  }

  /** Adds a band of one standard deviation on either side of the mean, as far as it is within the range of the
   *  values. */
  band(of: {mean: Column; deviation: Column; least: Column; greatest: Column}, colour: SeriesColour): void {
    const mean = column_of(this.#subject, of.mean), deviation = column_of(this.#subject, of.deviation);
    const min = column_of(this.#subject, of.least), max = column_of(this.#subject, of.greatest);
    if (!is_known(mean)) {
      return;
    }
    const low = mean.map((number, i) => Math.max(number - deviation[i]!, min[i]!)),
          high = mean.map((number, i) => Math.min(number + deviation[i]!, max[i]!));
    this.content.series.push({
      kind: "band",
      name: texts.deviation,
      colour,
      x: column_of(this.#subject, "generation"),
      y: running_mean(high, this.#window),
      low: running_mean(low, this.#window)
    });
  }

  stack(column: Column, name: string, colour: SeriesColour): void {
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
  compare(column: Column, name: string, colour: SeriesColour): void {
    if (this.#other !== null) {
      this.#add_line(
        this.#other, column, {...plain, name: this.#named(name, this.#other), colour, dash: compare_dash, whole: true});
    }
  }

  #named(name: string, subject: Subject): string {
    return this.#other === null ? name : texts.series_of(name, subject.name);
  }

  #add_line(subject: Subject, column: Column, line: Omit<Series, "kind"|"x"|"y">): void {
    const raw = column_of(subject, column);
    if (is_known(raw)) {
      const series: Series = {kind: "line", ...line, x: column_of(subject, "generation"), y: raw};
      this.content.series.push(this.#window > 1 ? {...series, y: running_mean(raw, this.#window), raw} : series);
    }
  }
}

function column_of(subject: Subject, name: Column): number[] {
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
function gene_column(subject: Subject, gene: string, part: GenePart|AccountPart): Column|null {
  const index = subject.gene_names.indexOf(gene);
  return index >= 0 ? `gene:${index}:${part}` : null;
}

/** What figure_of() plots. */
export interface FigureRequest {
  quantity: Quantity;
  subject: Subject;
  other: Subject|null; // the compared history. If it has no island of this number, all its islands together are shown
  genes: readonly string[]; // whose means, or whose selection, are plotted together
  gene: string; // the one gene that is shown instead; empty: all of `genes`
  window: number; // generations of the running mean of each line and band; 1: none
  births?: boolean; // the world has births: generations are intervals, and fitness is the number of children
}

/** Builds the plot of a quantity. */
export function figure_of(request: FigureRequest): PlotContent {
  const make = new FigureBuilder(request.subject, request.other, request.window), {content} = make;
  const {births = false} = request;
  if (births) {
    content.x_label = texts.interval;
  }
  switch (request.quantity) {
    case "population":
      build_population(make, request.subject);
      break;
    case "phase":
      break;
    case "fitness":
      build_fitness(make, request);
      break;
    case "genes":
      build_genes(make, request);
      break;
    case "selection":
      build_selection(make, request);
      break;
    case "diversity":
      Object.assign(content, {title: texts.diversity.title, y_label: texts.diversity.y, from_zero: true});
      make.line("diversity", texts.diversity.diversity, "purple", plain, {compared: true});
      break;
    case "survivors":
      Object.assign(content, {title: texts.survivors.title, y_label: texts.survivors.y, from_zero: true});
      make.line("alive_count", texts.survivors.alive, "green", plain, {compared: true, whole: true});
      make.line(
        births ? "colony:born_count" : "organism_count", texts.survivors.born, "grey", thin,
        {compared: false, whole: true});
      break;
    case "deaths":
      Object.assign(content, {title: texts.deaths.title, y_label: texts.deaths.y, from_zero: true});
      make.stack("starved_count", texts.deaths.starved, "orange");
      make.stack("poisoned_count", texts.deaths.poisoned, "vermilion");
      make.stack("colony:eaten_count", texts.deaths.eaten, "purple");
      make.stack("colony:old_count", texts.deaths.old, "grey");
      make.stack("alive_count", texts.deaths.alive, "green");
      make.compare("starved_count", texts.deaths.starved, "sky");
      make.compare("poisoned_count", texts.deaths.poisoned, "blue");
      break;
    case "food":
      Object.assign(content, {title: texts.food.title, y_label: texts.food.y(births), from_zero: true});
      make.line("food_eaten", texts.food.food, "green", plain, {compared: true, whole: true});
      make.line("poison_eaten", texts.food.poison, "vermilion", dashed, {compared: true, whole: true});
      break;
  }
  return content;
}

/** Whether a history is of a colony in which there was a predator. */
export function has_predators({table, island}: Pick<Subject, "table"|"island">): boolean {
  return table.column(island, "predators:count_mean").some((count) => count > 0);
}

function build_population(make: FigureBuilder, subject: Subject): void {
  const {title, y, prey, prey_lowest, predators, predators_lowest} = texts.population;
  Object.assign(make.content, {title, y_label: y, from_zero: true});
  make.line("colony:count_mean", prey, "purple", thick, {compared: true});
  make.line("colony:lowest_count", prey_lowest, "purple", thin, {compared: false, whole: true});
  if (has_predators(subject)) {
    make.line("predators:count_mean", predators, "orange", {...dashed, thickness: 2.8}, {compared: true});
    make.line("predators:lowest_count", predators_lowest, "orange", dotted, {compared: false, whole: true});
  }
}

function build_fitness(make: FigureBuilder, {subject, births}: FigureRequest): void {
  const {title, y, children, best, mean, median, worst} = texts.fitness;
  Object.assign(make.content, {title, y_label: births ? children : y, from_zero: starts_at_zero(subject)});
  make.line("fitness_best", best, "vermilion", plain, {compared: true});
  make.line("fitness_mean", mean, "blue", thick, {compared: true});
  make.line("fitness_median", median, "sky", dotted, {compared: false});
  make.line("fitness_worst", worst, "grey", thin, {compared: false});
  make.band(
    {mean: "fitness_mean", deviation: "fitness_deviation", least: "fitness_worst", greatest: "fitness_best"}, "blue");
}

function build_genes(make: FigureBuilder, {subject, genes, gene}: FigureRequest): void {
  const {title, of_one, y, y_of_weights, mean, greatest, least} = texts.genes;
  make.content.y_label = is_weight(gene || genes[0]) ? y_of_weights : y;
  if (gene === "") {
    make.content.title = title;
    make.gene_lines(genes, "mean");
    return;
  }
  make.content.title = of_one(gene);
  make.gene_line(gene, "mean", mean, "green", thick, true);
  make.gene_line(gene, "max", greatest, "grey", thin, false);
  make.gene_line(gene, "min", least, "grey", dotted, false);
  const index = subject.gene_names.indexOf(gene);
  if (index >= 0) {
    const of = (part: GenePart): Column => `gene:${index}:${part}`;
    make.band({mean: of("mean"), deviation: of("deviation"), least: of("min"), greatest: of("max")}, "green");
  }
}

function build_selection(make: FigureBuilder, {genes, gene, births = false}: FigureRequest): void {
  const {title, of_one, y, y_of_weights, change, selection, transmission, migration} = texts.selection;
  make.content.y_label = is_weight(gene || genes[0]) ? y_of_weights(births) : y(births);
  if (gene === "") {
    make.content.title = title;
    make.gene_lines(genes, "selection");
    return;
  }
  make.content.title = of_one(gene); // the change is the sum of the other series
  make.gene_line(gene, "change", change, "grey", thick, true);
  make.gene_line(gene, "selection", selection, "blue", plain, true);
  make.gene_line(gene, "transmission", transmission, "orange", dashed, true);
  make.gene_line(gene, "migration", migration, "purple", dotted, true);
}

/** Whether a gene is a weight of a network: "turn<hidden3". */
function is_weight(gene: string|undefined): boolean {
  return gene?.includes("<") ?? false;
}

/** Returns those of the genes that have changed most, the most changed first: in their mean or, for the quantity
 *  "selection", by selection. If there are at most `count_max`, returns all of them in their order. */
export function most_changed(
  quantity: Quantity, subject: Subject, genes: readonly string[], count_max = genes_in_plot_max): string[] {
  if (genes.length <= count_max) {
    return [...genes];
  }
  const change_of = (gene: string): number => {
    const column = gene_column(subject, gene, quantity === "selection" ? "selection" : "mean");
    const numbers = column === null ? [] : column_of(subject, column);
    const change = quantity === "selection" ?
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
    name: texts.values.organisms,
    colour: "green",
    in_legend: false,
    bar_width: width,
    whole: true,
    x: Array.from({length: count}, (_, i) => shown.min + (i + 0.5) * width),
    y: histogram(values, shown, count),
  }];
  return {
    title: texts.values.title(gene),
    series,
    x_label: gene,
    y_label: texts.values.y,
    from_zero: true,
    empty: texts.values.none
  };
}

/** Returns marks where all organisms of the history died, unless this happened in more than a tenth of the
 *  generations. */
export function extinctions(table: HistoryTable, island: Island): (Mark&{label: string})[] {
  const generation = table.column(island, "generation"), alive = table.column(island, "alive_count"),
        born = table.column(island, "organism_count");
  const found = generation.filter((_, i) => alive[i] === 0 && born[i]! > 0);
  return found.length * 10 > generation.length ?
    [] :
    found.map((x) => ({x, text: texts.all_died(x), label: texts.extinction}));
}
