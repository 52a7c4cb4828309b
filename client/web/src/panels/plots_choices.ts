// What the user chooses in the panel "plots": QuantityTabs the quantity, ScopeChoice the island and the running mean,
// CompareChoice another world of the server or a CSV file, GeneChoice the genes. GeneHistogram shows the values of one
// gene in the shown generation, below the plot of its means.
import type {Comparison} from "../plots/comparison";
import {genes_in_plot_max, histogram_of, most_changed, quantities, type Quantity, type Subject} from "../plots/figures";
import type {Island} from "../plots/history_table";
import {Plot} from "../plots/plot";
import {plot_texts} from "../texts/plot";
import {plots_panel_texts as texts, quantity_texts} from "../texts/plots_panel";
import {set_options} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {button, row} from "../widgets/form";
import {open_button} from "../widgets/files";
import type {Server} from "../world/server";
import type {ViewedWorld} from "../world/world";

const windows = [1, 5, 10, 20, 50, 100]; // generations of a running mean; 1: none
const window_default = 10;

export class QuantityTabs {
  readonly #content: HTMLElement;
  readonly #on_change: () => void;
  readonly #tabs = quantities.map(
    (quantity) =>
      h("button", {
        class: "plots-tab",
        type: "button",
        role: "tab",
        id: `plot-tab-${quantity}`,
        "aria-controls": "plot-tab-content",
        onclick: () => this.choose(quantity),
        onkeydown: (event: KeyboardEvent) => this.#move(event),
      },
        quantity_texts[quantity]));
  readonly element = h("div", {class: "plots-tabs", role: "tablist", "aria-label": texts.quantity}, ...this.#tabs);
  #chosen: Quantity = "fitness";

  /** content    the element that the tabs control
   *  on_change  called after each choice */
  constructor(content: HTMLElement, on_change: () => void) {
    this.#content = content;
    this.#content.id = "plot-tab-content";
    this.#content.setAttribute("role", "tabpanel");
    this.#on_change = on_change;
    this.#show();
  }

  get chosen(): Quantity {
    return this.#chosen;
  }

  choose(quantity: Quantity): void {
    this.#chosen = quantity;
    this.#show();
    this.#on_change();
  }

  #show(): void {
    this.#tabs.forEach((tab, i) => {
      const chosen = quantities[i] === this.#chosen;
      tab.setAttribute("aria-selected", String(chosen));
      tab.tabIndex = chosen ? 0 : -1;
    });
    this.#content.setAttribute("aria-labelledby", `plot-tab-${this.#chosen}`);
  }

  #move(event: KeyboardEvent): void {
    const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    if (by !== 0) {
      event.preventDefault();
      event.stopPropagation();
      const next = (quantities.indexOf(this.#chosen) + by + quantities.length) % quantities.length;
      this.choose(quantities[next]!);
      this.#tabs[next]!.focus();
    }
  }
}

export class ScopeChoice {
  readonly #smooth: HTMLSelectElement;
  readonly #island: HTMLSelectElement;
  readonly element: HTMLElement;

  constructor(on_change: () => void) {
    this.#smooth = h(
      "select", {class: "field", "aria-label": texts.running_mean, title: texts.running_mean_help, onchange: on_change},
      ...windows.map(
        (window) =>
          h("option", {value: window, selected: window === window_default},
            window === 1 ? texts.each_generation : plot_texts.mean_of(window))));
    this.#island = h("select", {class: "field", "aria-label": texts.island, hidden: true, onchange: on_change});
    this.element = row(this.#smooth, this.#island);
  }

  /** Generations of the running mean; 1: none. */
  get window(): number {
    return Number(this.#smooth.value);
  }

  get island(): Island {
    return this.#island.value === "" ? null : Number(this.#island.value);
  }

  update(island_count: number): void {
    this.#island.hidden = island_count < 2;
    const islands = Array.from(
      {length: this.#island.hidden ? 0 : island_count}, (_, i) => ({value: String(i), text: texts.island_name(i)}));
    const is_known = Number(this.#island.value) < Math.max(island_count, 1);
    set_options(this.#island, [{value: "", text: texts.all_islands}, ...islands], is_known ? this.#island.value : "");
  }
}

const file_value = "file", world_value = "world "; // of options

export class CompareChoice {
  readonly element: HTMLElement;
  readonly #server: Server;
  readonly #comparison: Comparison;
  readonly #compare = h("select", {class: "field", onchange: () => this.#choose()});
  readonly #file_name = h("span", {class: "grow"});
  readonly #run =
    h("select",
      {class: "field grow", "aria-label": texts.run, onchange: () => this.#comparison.choose_run(this.#run_index())});
  readonly #remove = button(texts.remove, () => this.#remove_file());
  readonly #file_row = h("div", {class: "row plots-file", hidden: true}, this.#file_name, this.#run, this.#remove);
  readonly #problem = h("p", {class: "error", role: "alert"});

  constructor(server: Server, comparison: Comparison) {
    this.#server = server;
    this.#comparison = comparison;
    const [open, field] = open_button(texts.open_file, ".csv,text/csv", false, (files) => this.take(files));
    open.title = texts.open_file_help;
    this.element =
      h("div", {class: "panel"},
        h("div", {class: "row plots-choices"},
          h("label", {class: "row grow"}, h("span", {}, texts.compare), this.#compare), open, field),
        this.#file_row, this.#problem);
  }

  take(files: readonly File[]): void {
    if (files[0] !== undefined) {
      void this.#comparison.choose_file(files[0]);
    }
  }

  update(world: string): void {
    const names = this.#server.worlds.filter((one) => !one.replay && one.name !== world).map((one) => String(one.name));
    const {file} = this.#comparison, compared = this.#comparison.world;
    if (compared !== "" && !names.includes(compared)) { // it was deleted, or is shown itself now
      this.#comparison.choose_world("");
      return;
    }
    set_options(
      this.#compare,
      [
        {value: "", text: texts.nothing}, ...names.map((name) => ({value: world_value + name, text: name})),
        ...(file === null ? [] : [{value: file_value, text: file.name}])
      ],
      file !== null     ? file_value :
        compared === "" ? "" :
                          world_value + compared);
    this.#file_row.hidden = file === null;
    if (file !== null) {
      set_text(this.#file_name, texts.compared_file(file.name));
      this.#remove.title = texts.remove_help(file.name);
      this.#run.hidden = file.csv.runs.length < 2;
      set_options(this.#run, file.csv.runs.map(({name}, i) => ({value: String(i), text: name})), String(file.run));
    }
    set_text(this.#problem, this.#comparison.problem);
  }

  #choose(): void {
    if (this.#compare.value !== file_value) {
      this.#comparison.choose_world(this.#compare.value.slice(world_value.length));
    }
  }

  #run_index(): number {
    return this.#run.selectedIndex;
  }

  #remove_file(): void {
    this.#comparison.choose_world("");
    this.#compare.focus();
  }
}

const group_names: {[group: string]: string} = {
  GENE_GROUP_BODY: texts.body,
  GENE_GROUP_BRAIN: texts.brain,
  GENE_GROUP_FREE: texts.free
};

export class GeneChoice {
  readonly #on_change: () => void;
  readonly #group = h("select", {
    class: "field",
    "aria-label": texts.group,
    hidden: true,
    onchange:
      () => {
        this.#gene = "";
        this.#on_change();
      }
  });
  readonly #genes = h("select", {
    class: "field grow",
    "aria-label": texts.gene,
    onchange:
      () => {
        this.#gene = this.#genes.value;
        this.#on_change();
      }
  });
  readonly element = h("div", {class: "row plots-genes"}, this.#group, this.#genes);
  #gene = "";

  /** on_change: the user has chosen. */
  constructor(on_change: () => void) {
    this.#on_change = on_change;
  }

  /** The one gene that is shown; empty: several. */
  get gene(): string {
    return this.#gene;
  }

  /** What is chosen, for a comparison. */
  get described(): string {
    return `${this.#gene}/${this.#group.value}`;
  }

  show(world: ViewedWorld, gene: string): void {
    this.#gene = gene;
    const groups = groups_of(world), group = groups[world.gene_names.indexOf(gene)];
    if (group !== undefined) {
      this.#fill_groups([...new Set(groups)], group);
    }
  }

  /** Fills the choices. Returns the genes that are plotted together if none is chosen. */
  update(world: ViewedWorld, quantity: Quantity, subject: Subject): string[] {
    const groups = groups_of(world), distinct = [...new Set(groups)];
    const is_grouped = distinct.length > 1;
    this.#group.hidden = !is_grouped;
    this.#fill_groups(distinct, distinct.includes(this.#group.value) ? this.#group.value : distinct[0] ?? "");
    const genes =
      is_grouped ? world.gene_names.filter((_, i) => groups[i] === this.#group.value) : [...world.gene_names];
    const together = most_changed(quantity, subject, genes);
    if (!genes.includes(this.#gene)) {
      this.#gene = "";
    }
    const selects = quantity === "selection";
    const all = genes.length > genes_in_plot_max ?
      (selects ? texts.most_selected : texts.most_changed)(together.length) :
      is_grouped ? (selects ? texts.selection_of_group : texts.means_of_group) :
                   (selects ? texts.selection_of_genes : texts.means_of_all);
    set_options(this.#genes, [{value: "", text: all}, ...genes.map((gene) => ({value: gene, text: gene}))], this.#gene);
    return together;
  }

  #fill_groups(groups: readonly string[], chosen: string): void {
    set_options(
      this.#group, groups.map((group) => ({value: group, text: texts.genes_of(group_names[group] ?? texts.free)})),
      chosen);
  }
}

function groups_of(world: ViewedWorld): string[] {
  return world.feed.gene_groups.length === world.gene_names.length ? world.feed.gene_groups : [];
}

const height = 170; // CSS pixels

export class GeneHistogram {
  readonly #plot = new Plot({height});
  readonly #title = h("p", {class: "hint"});
  readonly element = h("div", {hidden: true}, this.#title, this.#plot.element);
  #world: ViewedWorld|null = null; // whose population is kept up to date
  #release: (() => void)|null = null;
  #drawn: unknown = null; // the columns in the histogram
  #drawn_gene = "";

  fit(): void {
    this.#plot.fit();
  }

  /** Keeps the population of a world up to date while it is needed. */
  need(world: ViewedWorld, needed: boolean): void {
    if (this.#release !== null && (!needed || world !== this.#world)) {
      this.#release();
      this.#release = null;
    }
    if (needed && this.#release === null) {
      this.#world = world;
      this.#release = world.population.need();
    }
  }

  /** gene: empty: no histogram is shown. */
  update(world: ViewedWorld, gene: string): void {
    const {columns: population} = world.population;
    this.element.hidden = gene === "";
    if (gene === "" || (population === this.#drawn && gene === this.#drawn_gene)) {
      return;
    }
    this.#drawn = population;
    this.#drawn_gene = gene;
    const index = population?.gene_names.indexOf(gene) ?? -1;
    this.#plot.set_content(histogram_of(gene, population?.genes[index] ?? []));
    set_text(
      this.#title,
      population === null                   ? texts.loading :
        (world.info?.island_count ?? 1) > 1 ? texts.organisms_of_island(population.generation, population.island) :
                                              texts.organisms_of(population.generation));
  }
}
