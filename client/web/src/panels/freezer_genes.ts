// FreezerGenes: the genes of an organism in the freezer, compared with those of the selected organism and with the
// population to which it belongs.
import {type ComparedGene, compared_genes, difference_counts, range_of_gene} from "../freezer/comparison";
import {is_organism, type Population} from "../freezer/population_csv";
import {gene_label, gene_number} from "../organism/texts";
import {freezer_texts as texts} from "../texts/freezer";
import {h, set_text} from "../widgets/dom";
import {hint} from "../widgets/form";

import type {ChosenOrganism, ShownEntry} from "./freezer_choice";
import {table_head} from "./rows";

const first_genes = 6; // those of the body, if there are any, are always shown
const further_genes_max = 500; // shown in the table

/** The selected organism; id null: none is selected. */
export interface Other {
  id: number|null;
  gene_names: readonly string[];
  genes: readonly number[];
}

export class FreezerGenes {
  readonly element: HTMLElement;
  readonly #summary = h("p", {});
  readonly #tables = h("div", {});
  #drawn = ""; // what the tables show
  #of: ShownEntry|null = null;

  constructor() {
    this.element = h("div", {class: "panel"}, this.#summary, this.#tables);
  }

  update(shown: ShownEntry, chosen: ChosenOrganism, other: Other): void {
    const drawn = [chosen.name, other.id, other.genes.join()].join("/");
    if (shown === this.#of && drawn === this.#drawn) {
      return;
    }
    this.#of = shown;
    this.#drawn = drawn;
    const {population} = shown;
    const genes = compared_genes(population.gene_names, chosen.genes, other.gene_names, other.genes);
    const further = genes.slice(first_genes), is_open = this.#tables.querySelector("details")?.open ?? false;
    set_text(this.#summary, summary_text(genes, other.id));
    this.#tables.replaceChildren(table(population, genes.slice(0, first_genes), 0, other.id));
    if (further.length > 0) {
      this.#tables.append(further_genes(population, further, other.id, is_open));
    }
  }
}

function summary_text(genes: readonly ComparedGene[], other: number|null): string {
  if (other === null) {
    return texts.nothing_to_compare;
  }
  const {common, different} = difference_counts(genes), missing = genes.length - common;
  return (different === 0 ? texts.equal(other, common) : texts.different(other, different, common)) +
    (missing > 0 ? texts.not_common(missing) : "");
}

/** first  number of the first of these genes in the chromosome */
function table(population: Population, genes: readonly ComparedGene[], first: number, other: number|null): HTMLElement {
  const has_ranges = !is_organism(population);
  const headings = [
    ...texts.gene_headings, ...(has_ranges ? [texts.range_heading] : []),
    ...(other === null ? [] : [texts.other(other), texts.difference])
  ];
  const cells = (gene: ComparedGene, i: number): string[] => {
    const range = has_ranges ? range_of_gene(population, first + i) : null;
    return [
      gene_number(gene.kept), ...(range ? [`${gene_number(range.min)}…${gene_number(range.max)}`] : []),
      ...(
        other === null        ? [] :
          gene.other === null ? ["–", "–"] :
                                [gene_number(gene.other), signed(gene.other - gene.kept)])
    ];
  };
  return h(
    "table", {class: "table", "aria-label": texts.gene_table}, table_head(headings, 1),
    h("tbody", {},
      ...genes.map(
        (gene, i) =>
          h("tr", {}, h("th", {scope: "row"}, gene_label(gene.name)),
            ...cells(gene, i).map((text) => h("td", {class: "number"}, text))))));
}

/** The genes behind the first ones. Their table is made when the user opens it. */
function further_genes(
  population: Population, genes: readonly ComparedGene[], other: number|null, is_open: boolean): HTMLElement {
  const fill = (): void => {
    if (details.open && details.children.length === 1) {
      details.append(table(population, genes.slice(0, further_genes_max), first_genes, other));
      if (genes.length > further_genes_max) {
        details.append(hint(texts.genes_left_out(genes.length - further_genes_max)));
      }
    }
  };
  const summary = h("summary", {}, texts.further_genes(genes.length));
  const details: HTMLDetailsElement = h("details", {open: is_open, ontoggle: fill}, summary);
  return details;
}

function signed(difference: number): string {
  return (difference > 0 ? "+" : "") + gene_number(difference);
}
