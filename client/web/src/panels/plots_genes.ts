// GeneChoice: which genes the plots show: all of a group together, or one.
import {genes_in_plot_max, most_changed} from "../plots/figures";
import type {Quantity, Subject} from "../plots/figures";
import {gene_name} from "../texts/genes";
import {plots_panel_texts as texts} from "../texts/plots_panel";
import {set_options} from "../widgets/controls";
import {h} from "../widgets/dom";
import type {ViewedWorld} from "../world/world";

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

  /** Chooses a gene. */
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
    const options = genes.map((gene) => ({value: gene, text: gene_name(gene)}));
    set_options(this.#genes, [{value: "", text: all}, ...options], this.#gene);
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
