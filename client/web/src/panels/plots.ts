// Plots panel: the statistics of a run, generation by generation, while it runs; compared with another world or an earlier run.
import {marks_of} from "../plots/change_marks";
import {
  extinctions,
  figure_of,
  genes_in_plot_max,
  histogram_of,
  most_changed,
  quantities,
  running_mean_name
} from "../plots/figures";
import {h, set_text} from "../widgets/dom";

import type {Quantity, Subject} from "../plots/figures";
import {HistoryTable} from "../plots/history_table";
import type {Island} from "../plots/history_table";
import {history_csv, read_history_csv} from "../plots/history_csv";
import {shown_number, with_separators} from "../texts/numbers";
import {OtherHistory} from "../plots/other_history";
import {LinkedX} from "../plots/linked_x";
import {Plot} from "../plots/plot";
import type {ViewedWorld} from "../world/world";
import type {Panel, PanelContext} from "../world/panel_context";

const plot_height = 270, histogram_height = 170; // CSS pixels
const windows = [1, 5, 10, 20, 50, 100]; // generations of a running mean; 1: none
const window_default = 10;
const image_width = 1200, image_height = 700; // of a saved image, in pixels
const share_of_time = 0.1; // at most this share of the time is spent on building plots of long histories

const selection_of_all =
  "Price equation: by how much selection changed the mean of each gene. Above 0, organisms with more of it had more offspring.";
const selection_of_one =
  "Price equation: the change of the mean is selection (which organisms had offspring) + transmission (crossover and mutation) + migration.";

const group_names: {[group: string]: string} = {
  GENE_GROUP_BODY: "body",
  GENE_GROUP_BRAIN: "brain",
  GENE_GROUP_FREE: "free"
};

type Compared = {
  history: OtherHistory
}|{
  file: HistoryTable;
  name: string;
  gene_names: string[]
}
|null;

export class PlotsPanel implements Panel {
  readonly name = "plots";
  readonly title = "Plots";
  readonly element: HTMLElement;

  readonly #table = new HistoryTable();
  #world: ViewedWorld|null = null;
  #world_name = "";
  #run_id = "";
  #quantity: Quantity = "Fitness";
  #compared: Compared = null;
  #gene = ""; // the one gene that is shown; empty: several
  #drawn = ""; // what the plot shows
  #histogram_drawn: unknown = null; // the columns in the histogram
  #histogram_gene = "";
  #next_build_ms = 0;
  #timer = 0;
  #release_population: (() => void)|null = null;
  #is_visible = false;
  readonly #link = new LinkedX();
  readonly #plot: Plot;
  readonly #histogram = new Plot({height: histogram_height});
  readonly #compare = h("select", {class: "field", onchange: () => this.#choose_compared()});
  readonly #file =
    h("input", {type: "file", accept: ".csv,text/csv", hidden: true, onchange: () => void this.#read_file()});
  readonly #smooth =
    h("select", {
      class: "field",
      "aria-label": "Running mean",
      onchange: () => this.refresh(),
      title:
        "Running mean: each point is the mean of that generation and the ones before it. Pale lines show each generation.",
    },
      ...windows.map(
        (window) =>
          h("option", {value: window, selected: window === window_default},
            window === 1 ? "each generation" : running_mean_name(window))));
  readonly #island =
    h("select", {class: "field", "aria-label": "Island", hidden: true, onchange: () => this.refresh()});
  readonly #tabs = quantities.map(
    (quantity) =>
      h("button", {
        class: "plots-tab",
        type: "button",
        role: "tab",
        id: `plot-tab-${quantity}`,
        "aria-controls": "plot-tab-content",
        onclick: () => this.#choose_quantity(quantity),
        onkeydown: (event: KeyboardEvent) => this.#move_tab(event),
      },
        quantity));
  readonly #group =
    h("select", {class: "field", "aria-label": "Group of genes", hidden: true, onchange: () => this.#choose_group()});
  readonly #genes = h("select", {class: "field grow", "aria-label": "Gene", onchange: () => this.#choose_gene()});
  readonly #gene_row = h("div", {class: "row plots-genes"}, this.#group, this.#genes);
  readonly #explanation = h("p", {class: "hint"});
  readonly #problem = h("p", {class: "error", role: "alert"});
  readonly #histogram_title = h("p", {class: "hint"});
  readonly #histogram_part = h("div", {hidden: true}, this.#histogram_title, this.#histogram.element);
  readonly #known = h("p", {class: "hint"});

  readonly #context: PanelContext;

  constructor(context: PanelContext) {
    this.#context = context;
    this.#plot =
      new Plot({height: plot_height, link: this.#link, on_click: (generation) => void this.#show_past(generation)});
    const save = (name: string, action: () => void, title: string): HTMLElement =>
      h("button", {class: "button", type: "button", title, onclick: action}, name);
    this.element =
      h("div", {class: "panel plots"},
        h("div", {class: "row plots-choices"},
          h("label", {class: "row grow"}, h("span", {}, "compare with"), this.#compare), this.#file, this.#smooth,
          this.#island),
        h("div", {class: "plots-tabs", role: "tablist", "aria-label": "Quantity"}, ...this.#tabs),
        h("div", {class: "panel", id: "plot-tab-content", role: "tabpanel"}, this.#gene_row, this.#explanation,
          this.#problem, this.#plot.element, this.#histogram_part),
        h("div", {class: "row"}, save("Fit", () => this.#fit(), "Shows all generations."),
          save("Save CSV", () => this.#save_csv(), "Saves the history of all islands as a table."),
          save(
            "Save PNG", () => void this.#save_png(),
            `Saves the plot as an image of ${image_width} × ${image_height} pixels.`),
          this.#known));
    new IntersectionObserver((entries) => {
      this.#is_visible = entries[entries.length - 1]!.isIntersecting;
      this.#update_population();
    }).observe(this.element);
    this.#choose_quantity("Fitness");
  }

  refresh(): void {
    if (!this.#context.world().name) {
      return;
    }
    this.#follow();
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

  /** subject: {quantity: "Genes", gene: "impulse"} */
  show(subject: {[key: string]: unknown}): void {
    const quantity = quantities.find((one) => one === subject.quantity);
    if (typeof subject.gene === "string") {
      this.#gene = subject.gene;
      const group = this.#gene_groups()[this.#context.world().gene_names.indexOf(this.#gene)];
      if (group !== undefined) {
        this.#update_genes();
        this.#group.value = group;
      }
    }
    this.#choose_quantity(quantity ?? this.#quantity);
  }

  // ---- data ----

  #follow(): void {
    const world = this.#context.world();
    const run_id: string = this.#context.server.world(world.name)?.run_id ?? "";
    if (world !== this.#world || world.name !== this.#world_name || run_id !== this.#run_id) {
      this.#release_population?.();
      this.#release_population = null;
      this.#world = world;
      this.#world_name = world.name;
      this.#run_id = run_id;
      this.#drawn = "";
      this.#link.fit();
    }
    this.#table.set_history(world.history.generations);
    this.#update_compare();
    this.#update_islands();
    this.#update_population();
  }

  #subject(): Subject {
    const world = this.#context.world(), island = this.#chosen_island();
    const marks = [...marks_of(world.history.changes), ...extinctions(this.#table, island)].sort((a, b) => a.x - b.x);
    return {table: this.#table, island, name: world.name, gene_names: world.gene_names, changes: marks};
  }

  #other(): Subject|null {
    const island = this.#chosen_island(), compared = this.#compared;
    if (compared === null) {
      return null;
    }
    return "history" in compared ?
      {
        table: compared.history.table,
        island,
        name: compared.history.world,
        gene_names: compared.history.gene_names,
        changes: compared.history.changes
      } :
      {table: compared.file, island, name: compared.name, gene_names: compared.gene_names, changes: []};
  }

  #chosen_island(): Island {
    return this.#island.value === "" ? null : Number(this.#island.value);
  }

  #update_population(): void {
    const needed = this.#is_visible && this.#quantity === "Genes" && this.#gene !== "" && this.#world !== null;
    if (needed && this.#release_population === null) {
      this.#release_population = this.#world!.population.need();
    } else if (!needed && this.#release_population !== null) {
      this.#release_population();
      this.#release_population = null;
    }
  }

  async #show_past(generation: number): Promise<void> {
    await this.#context.attempt(() => this.#context.world().past.show(generation));
  }

  // ---- choices ----

  #choose_quantity(quantity: Quantity): void {
    this.#quantity = quantity;
    this.#tabs.forEach((tab) => {
      const chosen = tab.textContent === quantity;
      tab.setAttribute("aria-selected", String(chosen));
      tab.tabIndex = chosen ? 0 : -1;
    });
    this.element.querySelector("#plot-tab-content")!.setAttribute("aria-labelledby", `plot-tab-${quantity}`);
    this.#drawn = "";
    this.#next_build_ms = 0;
    this.refresh();
  }

  #move_tab(event: KeyboardEvent): void {
    const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    if (by !== 0) {
      event.preventDefault();
      event.stopPropagation();
      const next = (quantities.indexOf(this.#quantity) + by + quantities.length) % quantities.length;
      this.#choose_quantity(quantities[next]!);
      this.#tabs[next]!.focus();
    }
  }

  #update_compare(): void {
    const {server} = this.#context;
    const worlds: string[] =
      server.worlds.filter((world) => !world.replay && world.name !== this.#world_name).map((world) => world.name);
    const chosen = this.#compared === null ? "" :
      "history" in this.#compared          ? `world ${this.#compared.history.world}` :
                                             "compared file";
    const entries: [string, string][] =
      [["", "nothing"], ...worlds.map((name): [string, string] => [`world ${name}`, name])];
    if (this.#compared !== null && !entries.some(([value]) => value === chosen)) {
      if ("history" in this.#compared) { // the world was deleted, or is shown itself now
        this.#compared.history.close();
        this.#compared = null;
      } else {
        entries.push([chosen, this.#compared.name]);
      }
    }
    entries.push(["file", "a CSV file …"]);
    fill_options(this.#compare, entries, this.#compared === null ? "" : chosen);
  }

  #choose_compared(): void {
    const chosen = this.#compare.value;
    if (chosen === "file") {
      this.#file.value = "";
      this.#file.click();
      this.#update_compare();
      return;
    }
    if (chosen !== "compared file") {
      this.#end_compared();
      this.#compared = chosen === "" ?
        null :
        {history: new OtherHistory(this.#context.server, chosen.slice("world ".length), () => this.refresh())};
    }
    this.#drawn = "";
    this.refresh();
  }

  #end_compared(): void {
    if (this.#compared !== null && "history" in this.#compared) {
      this.#compared.history.close();
    }
    this.#compared = null;
    set_text(this.#problem, "");
  }

  async #read_file(): Promise<void> {
    const file = this.#file.files?.[0];
    if (file === undefined) {
      return;
    }
    const read = read_history_csv(await file.text());
    this.#end_compared();
    if (typeof read === "string") {
      set_text(this.#problem, `${file.name}: ${read}.`);
    } else {
      const table = new HistoryTable();
      table.add(read.history);
      this.#compared = {file: table, name: file.name, gene_names: read.gene_names};
    }
    this.#drawn = "";
    this.refresh();
  }

  #update_islands(): void {
    const count = Math.max(this.#table.island_count, 1);
    this.#island.hidden = count < 2;
    const entries: [string, string][] = [
      ["", "all islands"],
      ...Array.from({length: count < 2 ? 0 : count}, (_, i): [string, string] => [String(i), `island ${i}`])
    ];
    fill_options(this.#island, entries, Number(this.#island.value) < count ? this.#island.value : "");
  }

  #gene_groups(): string[] {
    const world = this.#context.world();
    return world.feed.gene_groups.length === world.gene_names.length ? world.feed.gene_groups : [];
  }

  /** Fills the choices of genes. Returns the genes of the chosen group, and those that are plotted together. */
  #update_genes(): {genes: string[]; together: string[]} {
    const world = this.#context.world(), groups = this.#gene_groups();
    const distinct = [...new Set(groups)];
    const is_grouped = distinct.length > 1;
    this.#group.hidden = !is_grouped;
    fill_options(
      this.#group, distinct.map((group): [string, string] => [group, `genes: ${group_names[group] ?? "free"}`]),
      distinct.includes(this.#group.value) ? this.#group.value : distinct[0] ?? "");
    const genes =
      is_grouped ? world.gene_names.filter((_, i) => groups[i] === this.#group.value) : [...world.gene_names];
    const together = most_changed(this.#quantity, this.#subject(), genes);
    const quantity = this.#quantity === "Selection" ? "selection of" : "means of";
    const all = genes.length > genes_in_plot_max ? `${quantity} the ${together.length} most changed` :
      is_grouped ? `${quantity} all of the group` :
                   `${quantity} all genes`;
    if (!genes.includes(this.#gene)) {
      this.#gene = "";
    }
    fill_options(this.#genes, [["", all], ...genes.map((gene): [string, string] => [gene, gene])], this.#gene);
    return {genes, together};
  }

  #choose_group(): void {
    this.#gene = "";
    this.#drawn = "";
    this.refresh();
  }

  #choose_gene(): void {
    this.#gene = this.#genes.value;
    this.#update_population();
    this.#drawn = "";
    this.refresh();
  }

  #fit(): void {
    this.#plot.fit();
    this.#histogram.fit();
  }

  // ---- plots ----

  #build(): void {
    const world = this.#context.world(), quantity = this.#quantity, compared = this.#compared;
    const of_genes = quantity === "Genes" || quantity === "Selection";
    this.#gene_row.hidden = !of_genes;
    const other_revision = compared === null ? -1 :
      "history" in compared                  ? compared.history.table.revision + compared.history.changes.length :
                                               0;
    const window = Number(this.#smooth.value);
    const description = [
      this.#table.revision, world.history.changes.length, world.history.is_complete, other_revision, quantity,
      this.#island.value, this.#gene, this.#group.value, window, world.gene_names.length
    ].join(" ");
    if (description !== this.#drawn) {
      this.#drawn = description;
      const together = of_genes ? this.#update_genes().together : [];
      const content = figure_of(quantity, this.#subject(), this.#other(), together, of_genes ? this.#gene : "", window);
      content.note_end = "A click shows this generation in a replay.";
      content.empty = world.history.is_complete ? quantity === "Selection" && this.#table.generation_count > 0 ?
                                                  "Known from the second generation on" :
                                                  "No generation has ended yet" :
                                                  "…";
      this.#plot.set_content(content);
      set_text(
        this.#explanation,
        quantity !== "Selection" ? "" :
          this.#gene === ""      ? selection_of_all :
                                   selection_of_one);
      if (compared !== null && "history" in compared) {
        set_text(
          this.#problem,
          compared.history.problem === "" ? "" : `${compared.history.world}: ${compared.history.problem}`);
      }
      const generations = this.#table.column(null, "generation");
      set_text(
        this.#known,
        generations.length === 0 ?
          "" :
          `${with_separators(generations.length)} ${generations.length === 1 ? "generation" : "generations"}, up to ${
            shown_number(generations[generations.length - 1]!)}`);
    }
    this.#build_histogram();
  }

  #build_histogram(): void {
    const world = this.#context.world(), {columns: population} = world.population;
    const shown = this.#quantity === "Genes" && this.#gene !== "";
    this.#histogram_part.hidden = !shown;
    if (!shown || (population === this.#histogram_drawn && this.#gene === this.#histogram_gene)) {
      return;
    }
    this.#histogram_drawn = population;
    this.#histogram_gene = this.#gene;
    const index = population?.gene_names.indexOf(this.#gene) ?? -1;
    const values = index >= 0 ? population!.genes[index] ?? [] : [];
    this.#histogram.set_content(histogram_of(this.#gene, values));
    set_text(
      this.#histogram_title,
      population === null ? "…" :
                            `All organisms of generation ${with_separators(population.generation)}${
                              (world.info?.island_count ?? 1) > 1 ? `, island ${population.island}` : ""}`);
  }

  // ---- files ----

  /** "evod-default-3f2a9c01-fitness-generation-120" */
  #file_name(what: string): string {
    const generations = this.#table.column(null, "generation");
    return `evod-${this.#world_name}-${this.#run_id.slice(0, 8)}-${what}-generation-${
      generations[generations.length - 1] ?? 0}`;
  }

  #save_csv(): void {
    const world = this.#context.world();
    save_file(
      new Blob([history_csv(world.history.generations, world.gene_names)], {type: "text/csv"}),
      `${this.#file_name("history")}.csv`);
  }

  async #save_png(): Promise<void> {
    const what = this.#gene === "" || (this.#quantity !== "Genes" && this.#quantity !== "Selection") ?
      this.#quantity.toLowerCase() :
      this.#quantity === "Genes" ? this.#gene :
                                   `${this.#gene}-selection`;
    const image = await this.#plot.image(image_width, image_height);
    if (image !== null) {
      save_file(image, `${this.#file_name(what.replace(/[^A-Za-z0-9_-]+/g, "_"))}.png`);
    }
  }
}

/** Sets the options of a drop-down if they differ, and the chosen one. */
function fill_options(select: HTMLSelectElement, entries: readonly(readonly[string, string])[], chosen: string): void {
  const described = JSON.stringify(entries);
  if (select.dataset.entries !== described) {
    select.dataset.entries = described;
    select.replaceChildren(...entries.map(([value, text]) => h("option", {value}, text)));
  }
  if (select.value !== chosen) {
    select.value = chosen;
  }
}

function save_file(content: Blob, name: string): void {
  const url = URL.createObjectURL(content);
  h("a", {href: url, download: name}).click();
  setTimeout(() => URL.revokeObjectURL(url), 10_000);
}
