// FamilyChoices: what the panel "family" shows, and in which order and colours.
import type {ColourBy} from "../family/colouring";
import type {TreeForm} from "../family/tree";
import {gene_label} from "../organism/texts";
import {family_texts} from "../texts/family";
import {set_options} from "../widgets/controls";
import {h} from "../widgets/dom";
import {check, row} from "../widgets/form";

const generation_choices = [5, 10, 20, 30, 50, 100];
const gene_prefix = "gene ";

export class FamilyChoices {
  readonly element: HTMLElement;
  readonly #subject: HTMLSelectElement;
  readonly #generations: HTMLSelectElement;
  readonly #both: HTMLInputElement;
  readonly #order: HTMLSelectElement;
  readonly #colours: HTMLSelectElement;

  constructor(on_change: () => void) {
    const select = (label: string, options: [string, string][], chosen: string, act = on_change): HTMLSelectElement =>
      h("select", {class: "field", "aria-label": label, onchange: act},
        ...options.map(([value, text]) => h("option", {value, selected: value === chosen}, text)));
    this.#subject =
      select(family_texts.subject, [["one", family_texts.ancestors], ["whole", family_texts.whole]], "one", () => {
        if (this.whole && this.colour_by.kind === "nothing") {
          this.#colours.value = "lineage";
        }
        on_change();
      });
    this.#generations = select(
      family_texts.generations,
      generation_choices.map((count) => [String(count), family_texts.generation_count(count)]), "10");
    this.#both = h("input", {type: "checkbox", checked: true, onchange: on_change});
    this.#order = select(
      family_texts.order, [["lines", family_texts.order_lines], ["fitness", family_texts.order_fitness]], "lines");
    this.#colours = select(family_texts.colours, [["", family_texts.colour_nothing]], "");
    this.element =
      row(this.#subject, this.#generations, check(this.#both, family_texts.both_parents), this.#order, this.#colours);
  }

  get whole(): boolean {
    return this.#subject.value === "whole";
  }

  set whole(whole: boolean) {
    this.#subject.value = whole ? "whole" : "one";
  }

  get form(): TreeForm {
    return {
      both_parents: this.#both.checked,
      generations: Number(this.#generations.value),
      order: this.#order.value === "fitness" ? "fitness" : "lines",
    };
  }

  get colour_by(): ColourBy {
    const value = this.#colours.value;
    return value === "lineage" || value === "fitness" ? {kind: value} :
      value.startsWith(gene_prefix)                   ? {kind: "gene", gene: Number(value.slice(gene_prefix.length))} :
                                                        {kind: "nothing"};
  }

  set_genes(names: readonly string[]): void {
    set_options(
      this.#colours,
      [
        {value: "", text: family_texts.colour_nothing}, {value: "lineage", text: family_texts.colour_lineage},
        {value: "fitness", text: family_texts.colour_fitness},
        ...names.map(
          (name, gene) => ({value: `${gene_prefix}${gene}`, text: family_texts.colour_gene(gene_label(name))}))
      ],
      this.#colours.value);
  }
}
