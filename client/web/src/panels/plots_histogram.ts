// GeneHistogram: the values of one gene in the shown generation, below the plot of its means.
import {histogram_of} from "../plots/figures";
import {Plot} from "../plots/plot";
import {plots_panel_texts as texts} from "../texts/plots_panel";
import {h, set_text} from "../widgets/dom";
import type {ViewedWorld} from "../world/world";

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
