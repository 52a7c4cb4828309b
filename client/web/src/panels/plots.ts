// Plots panel: the statistics of a run, generation by generation, while it runs; compared with another world or an
// earlier run.
import {marks_of} from "../plots/change_marks";
import {Comparison} from "../plots/comparison";
import {colony_quantities, extinctions, figure_of, has_predators, quantities} from "../plots/figures";
import {show_generation} from "../plots/fitness_curve";
import {history_csv} from "../plots/history_csv";
import {HistoryTable} from "../plots/history_table";
import {Plot} from "../plots/plot";
import {plot_texts} from "../texts/plot";
import {plots_panel_texts as texts} from "../texts/plots_panel";
import {h, set_text} from "../widgets/dom";
import {accept_drops, save_file} from "../widgets/files";
import {button, row} from "../widgets/form";
import type {Panel, PanelContext} from "../world/panel_context";
import {QuantityTabs, IslandAndMeanChoice} from "./plots_choices";
import {CompareChoice} from "./plots_compare";
import {GeneChoice} from "./plots_genes";
import {GeneHistogram} from "./plots_histogram";
import {PhasePlot} from "./plots_phase";

const plot_height = 270; // CSS pixels
const image_width = 1200, image_height = 700; // of a saved image, in pixels
const share_of_time = 0.1; // at most this share of the time is spent on building plots of long histories

export class PlotsPanel implements Panel {
  readonly name = "plots";
  readonly title = texts.title;
  readonly element: HTMLElement;
  readonly #context: PanelContext;
  readonly #comparison: Comparison;
  readonly #compare: CompareChoice;
  readonly #scope = new IslandAndMeanChoice(() => this.refresh());
  readonly #genes = new GeneChoice(() => this.#rebuild());
  readonly #explanation = h("p", {class: "hint"});
  readonly #content = h("div", {class: "panel"}, this.#genes.element, this.#explanation);
  readonly #tabs = new QuantityTabs(this.#content, () => this.#rebuild());
  readonly #plot =
    new Plot({height: plot_height, on_click: (generation) => void show_generation(this.#context, generation)});
  readonly #phase = new PhasePlot();
  readonly #histogram = new GeneHistogram();
  readonly #known = h("p", {class: "hint"});
  readonly #table = new HistoryTable();
  readonly #predators = new HistoryTable(); // the statistics of the predators
  #run = ""; // the pane, the world and the run that the plots show
  #drawn = ""; // what the plot shows
  #next_build_ms = 0;
  #timer = 0;
  #is_visible = false;

  constructor(context: PanelContext) {
    this.#context = context;
    this.#comparison = new Comparison(context.server, () => this.refresh());
    this.#compare = new CompareChoice(context.server, this.#comparison);
    this.#content.append(this.#plot.element, this.#phase.element, this.#histogram.element);
    const fit = () => {
      this.#plot.fit();
      this.#histogram.fit();
    };
    this.element =
      h("div", {class: "panel plots"}, this.#compare.element, this.#scope.element, this.#tabs.element, this.#content,
        row(
          button(texts.fit, fit, {title: texts.fit_help}),
          button(texts.save_csv, () => this.#save_csv(), {title: texts.save_csv_help}),
          button(texts.save_png, () => void this.#save_png(), {title: texts.save_png_help(image_width, image_height)}),
          this.#known));
    accept_drops(this.element, (files) => this.#compare.take(files));
    new IntersectionObserver((entries) => {
      this.#is_visible = entries[entries.length - 1]!.isIntersecting;
      this.#need_population();
    }).observe(this.element);
    this.refresh();
  }

  refresh(): void {
    const world = this.#context.world();
    if (!world.name) {
      return;
    }
    const run = `${world.feed.pane} ${world.name} ${this.#run_id()}`;
    if (run !== this.#run) {
      this.#run = run;
      this.#drawn = "";
      this.#plot.fit();
    }
    const {generations} = world.history;
    this.#table.set_history(generations);
    this.#predators.set_history(generations.flatMap((one) => one.predators ?? []));
    const of_two = has_predators({table: this.#table, island: null});
    this.#compare.update(world.name);
    this.#tabs.offer(generations.at(-1)?.colony === undefined ? [] : of_two ? colony_quantities : ["population"]);
    this.#scope.update(this.#table.island_count, of_two, colony_quantities.includes(this.#tabs.chosen));
    this.#need_population();
    const wait = this.#next_build_ms - performance.now();
    if (wait > 0) {
      if (this.#timer === 0) {
        this.#timer = window.setTimeout(() => {
          this.#timer = 0;
          this.refresh();
        }, wait);
      }
      return;
    }
    const begun = performance.now();
    this.#build();
    this.#next_build_ms = performance.now() + (performance.now() - begun) / share_of_time;
  }

  /** subject: {quantity: "genes", gene: "impulse"} */
  show(subject: {[key: string]: unknown}): void {
    if (typeof subject.gene === "string") {
      this.#genes.show(this.#context.world(), subject.gene);
    }
    this.#tabs.choose(quantities.find((one) => one === subject.quantity) ?? this.#tabs.chosen);
  }

  // ---- data ----

  #run_id(): string {
    return this.#context.server.worlds.find(this.#context.world().name)?.run_id ?? "";
  }

  #need_population(): void {
    this.#histogram.need(
      this.#context.world(), this.#is_visible && this.#tabs.chosen === "genes" && this.#genes.gene !== "");
  }

  // ---- plots ----

  /** Draws another plot, soon. */
  #rebuild(): void {
    this.#drawn = "";
    this.#next_build_ms = 0;
    this.refresh();
  }

  #build(): void {
    const world = this.#context.world(), quantity = this.#tabs.chosen, {island} = this.#scope;
    const births = world.has_births, of_colony = colony_quantities.includes(quantity);
    const window = of_colony ? 1 : this.#scope.window; // the numbers are means of a generation already
    const of_genes = quantity === "genes" || quantity === "selection";
    this.#genes.element.hidden = !of_genes;
    const description = JSON.stringify([
      this.#table.revision, world.history.changes.length, world.history.is_complete, this.#comparison.revision,
      quantity, island, this.#genes.described, window, world.gene_names.length, this.#scope.of_predators, births
    ]);
    if (description !== this.#drawn) {
      this.#drawn = description;
      const {name, history: {changes}, gene_names} = world;
      const marks = [...marks_of(changes), ...extinctions(this.#table, island)].sort((a, b) => a.x - b.x);
      const table = this.#scope.of_predators && !of_colony ? this.#predators : this.#table;
      const subject = {table, island, name, gene_names, changes: marks},
            other = this.#comparison.subject(island);
      const genes = of_genes ? this.#genes.update(world, quantity, subject) : [];
      const gene = of_genes ? this.#genes.gene : "";
      const empty = !world.history.is_complete                       ? texts.loading :
        quantity === "selection" && this.#table.generation_count > 0 ? texts.from_second(births) :
                                                                       texts.none_ended(births);
      const content = figure_of({quantity, subject, other, genes, gene, window, births});
      this.#plot.element.hidden = quantity === "phase";
      this.#phase.element.hidden = quantity !== "phase";
      if (quantity === "phase") {
        this.#phase.update(this.#table, island, births);
      }
      this.#plot.set_content(
        {...content, note_end: plot_texts.click_shows(this.#context.world().past.range?.first_generation ?? 1), empty});
      set_text(
        this.#explanation,
        quantity !== "selection" ? "" :
          gene === ""            ? texts.selection_of_all :
                                   texts.selection_of_one);
      set_text(
        this.#known,
        this.#table.generation_count === 0 ?
          "" :
          texts.known(this.#table.generation_count, this.#table.last_generation, births));
    }
    this.#histogram.update(world, quantity === "genes" ? this.#genes.gene : "");
  }

  // ---- files ----

  /** "evod-default-3f2a9c01-fitness-generation-120" */
  #file_name(what: string): string {
    return `evod-${this.#context.world().name}-${this.#run_id().slice(0, 8)}-${what}-generation-${
      this.#table.last_generation}`;
  }

  #save_csv(): void {
    const {history: {generations: history}, gene_names} = this.#context.world();
    save_file(new Blob([history_csv(history, gene_names)], {type: "text/csv"}), `${this.#file_name("history")}.csv`);
  }

  async #save_png(): Promise<void> {
    const {gene} = this.#genes, quantity = this.#tabs.chosen;
    const what = gene !== "" && quantity === "genes" ? gene :
      gene !== "" && quantity === "selection"        ? `${gene}-selection` :
                                                       quantity;
    const image = await this.#plot.image(image_width, image_height);
    if (image !== null) {
      save_file(image, `${this.#file_name(what.replace(/[^A-Za-z0-9_-]+/g, "_"))}.png`);
    }
  }
}
