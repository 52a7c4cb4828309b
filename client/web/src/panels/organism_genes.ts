// OrganismGenes: the genes of the selected organism: those of the body as bars in the range of its generation, free
// genes as a list. The weights of its network are in BrainView.
import {genes_of} from "../organism/genes";
import type {OrganismHistory, Range} from "../organism/history";
import {gene_label, gene_number} from "../texts/genes";
import {organism_texts as texts} from "../texts/organism";
import {h, set_text} from "../widgets/dom";
import type {ViewedWorld} from "../world/world";

const free_genes_open_max = 12;

export class OrganismGenes {
  readonly #bars_element = h("div", {class: "organism-genes"});
  readonly #hint = h("p", {class: "hint"});
  readonly #free = h("div", {class: "organism-free-genes"});
  readonly #free_summary = h("summary", {});
  readonly #free_part = h("details", {}, this.#free_summary, this.#free);
  readonly element =
    h("section", {class: "panel organism-part"}, h("h3", {}, texts.genes), this.#bars_element, this.#hint,
      this.#free_part);
  #built = ""; // the genes that have bars
  #bars: GeneBar[] = [];

  update(world: ViewedWorld, history: OrganismHistory): void {
    const names = world.gene_names, genes = history.info?.genes ?? [];
    const weights = genes_of(world.feed.gene_groups, "brain", names.length);
    const free = genes_of(world.feed.gene_groups, "free", names.length);
    const described = JSON.stringify([history.place.run_id, names, genes.length]);
    if (described !== this.#built) {
      this.#built = described;
      const is_in = (gene: number, {first, count}: {first: number; count: number}): boolean =>
        gene >= first && gene < first + count;
      const shown = names.map((_, gene) => gene)
                      .filter((gene) => gene < genes.length && !is_in(gene, weights) && !is_in(gene, free));
      this.#bars = shown.map((gene) => new GeneBar(gene, gene_label(names[gene]!)));
      this.#bars_element.replaceChildren(...this.#bars.map((bar) => bar.element));
      this.#free.replaceChildren();
      this.#free_part.open = free.count <= free_genes_open_max;
    }
    for (const bar of this.#bars) {
      bar.update(genes[bar.gene]!, history.ranges[bar.gene] ?? null);
    }
    set_text(this.#hint, history.ranges.length > 0 ? texts.genes_hint : "");
    this.#free_part.hidden = free.count === 0 || genes.length < free.first + free.count;
    if (!this.#free_part.hidden) {
      set_text(this.#free_summary, texts.free_genes(free.count));
      for (let i = 0; i < free.count; ++i) {
        const item = this.#free.children[i] ?? this.#free.appendChild(h("span", {}));
        set_text(item, texts.free_gene(names[free.first + i]!, genes[free.first + i]!));
      }
    }
  }
}

/** A gene as a bar between the least and the greatest value in the generation, with a line at the mean. */
class GeneBar {
  readonly gene: number;
  readonly #value = h("span", {class: "gene-value"});
  readonly #fill = h("div", {class: "gene-fill"});
  readonly #mean = h("div", {class: "gene-mean"});
  readonly #bar = h("div", {class: "gene-bar", role: "meter"}, this.#fill, this.#mean);
  readonly element: HTMLElement;

  constructor(gene: number, label: string) {
    this.gene = gene;
    this.#bar.setAttribute("aria-label", label);
    this.element = h("div", {class: "gene"}, h("span", {class: "gene-name"}, label), this.#value, this.#bar);
  }

  update(value: number, range: Range|null): void {
    set_text(this.#value, gene_number(value));
    this.#bar.hidden = range === null;
    if (!range) {
      return;
    }
    const share = (of: number): number =>
      range.max > range.min ? Math.min(1, Math.max(0, (of - range.min) / (range.max - range.min))) : 0.5;
    this.#fill.style.width = `${(100 * share(value)).toFixed(1)}%`;
    this.#mean.style.left = `${(100 * share(range.mean)).toFixed(1)}%`;
    const range_text = texts.gene_range(range.min, range.max, range.mean);
    this.element.title = range_text;
    this.#bar.setAttribute("aria-valuemin", range.min.toFixed(2));
    this.#bar.setAttribute("aria-valuemax", range.max.toFixed(2));
    this.#bar.setAttribute("aria-valuenow", value.toFixed(2));
    this.#bar.setAttribute("aria-valuetext", texts.gene_of_range(value, range_text));
  }
}
