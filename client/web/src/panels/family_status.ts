// FamilyStatus: what the panel "family" shows, what it has loaded, and what keeps it from showing a tree.
import {type FamilyData, type Subject} from "../family/family_data";
import {gene_values_max, organisms_max} from "../family/loading";
import type {ShownTree} from "../family/shown_tree";
import type {FamilyTree} from "../family/spot";
import {family_texts} from "../texts/family";
import {h, set_text} from "../widgets/dom";
import {button} from "../widgets/form";
import type {FamilyChoices} from "./family_choices";
import {ancestors_in} from "./family_marks";

export class FamilyStatus {
  readonly heading = h("h2", {});
  readonly problem: HTMLElement;
  readonly loaded = h("p", {class: "hint"});
  readonly sentence = h("p", {class: "family-sentence"}); // about the common ancestors of all
  readonly #text = h("p", {role: "status"});
  readonly #retry: HTMLButtonElement;
  readonly #choices: FamilyChoices;
  readonly #data: FamilyData;

  constructor(choices: FamilyChoices, data: FamilyData, refresh: () => void) {
    this.#choices = choices;
    this.#data = data;
    this.#retry = button(family_texts.retry, () => {
      data.try_again();
      refresh();
    });
    this.problem = h("div", {class: "panel"}, this.#text, this.#retry);
  }

  show(subject: Subject|null, shown: ShownTree): void {
    const {tree} = shown;
    const {problem, lineage} = this.#data;
    set_text(
      this.heading,
      !subject        ? family_texts.title :
        subject.whole ? family_texts.heading_whole(subject.root.generation, subject.root.island) :
                        family_texts.heading_ancestors(subject.root.organism, subject.root.generation));
    set_text(
      this.#text,
      !subject  ? (this.#choices.whole ? family_texts.no_world : family_texts.select_first) :
        problem ? family_texts.unknown(problem) :
        tree    ? "" :
        lineage ? family_texts.not_stored :
                  family_texts.loading);
    this.#text.classList.toggle("error", problem !== "");
    this.#retry.hidden = problem === "";
    this.problem.hidden = this.#text.textContent === "";
    set_text(this.loaded, subject && tree ? this.#loaded_text(subject, tree) : "");
    set_text(this.sentence, subject?.whole && tree ? this.#ancestors_of_all_text(tree, shown) : "");
    this.sentence.hidden = this.sentence.textContent === "";
  }

  #ancestors_of_all_text(tree: FamilyTree, {of_all}: ShownTree): string {
    const count = tree.rows[tree.rows.length - 1]!.length, last = tree.first_generation + tree.rows.length - 1;
    const first_parents = !this.#choices.form.both_parents;
    return count < 2 ? "" :
      !of_all        ? family_texts.no_ancestor_of_all(count, last, tree.first_generation, first_parents) :
                       family_texts.all_descend_from(count, last, ancestors_in(tree, of_all), first_parents) +
        (of_all.all_row === null ? "" : family_texts.all_are_ancestors(tree.first_generation + of_all.all_row));
  }

  #loaded_text(subject: Subject, tree: FamilyTree): string {
    const {lineage, gene_progress, genes_problem} = this.#data;
    if (!lineage) {
      return "";
    }
    const wanted = Math.min(this.#choices.form.generations, subject.root.generation);
    const is_limited = lineage.first_generation > subject.root.generation - wanted + 1;
    const of_genes = this.#choices.colour_by.kind !== "gene" || !gene_progress ? "" :
      genes_problem                            ? family_texts.genes_unknown(genes_problem) :
      gene_progress.loaded < gene_progress.all ? family_texts.loading_genes(gene_progress.loaded, gene_progress.all) :
      gene_progress.limited                    ? family_texts.genes_limited(gene_progress.all, gene_values_max) :
                                                 "";
    return [
      family_texts.loaded(lineage.ancestors.size, lineage.bytes),
      is_limited ? family_texts.limited(tree.rows.length, wanted, organisms_max) : "",
      lineage.generations_left_out > 0 ? family_texts.left_out(lineage.generations_left_out) : "", of_genes
    ].filter((text) => text !== "")
      .join(" ");
  }
}
