// FamilyNote: what is known about the organism that the pointer or the keyboard points at.
import type {ColourBy, Colouring} from "../family/colouring";
import type {CommonAncestors} from "../family/common_ancestors";
import type {GeneTable} from "../family/gene_table";
import type {FamilyTree, Place} from "../family/spot";
import {gene_label, gene_number} from "../organism/texts";
import {family_texts} from "../texts/family";
import {h, set_text} from "../widgets/dom";
import {button} from "../widgets/form";
import type {ViewedWorld} from "../world/world";
import {FamilyChanges} from "./family_changes";
import {type MarksInTree, organism_at} from "./family_marks";

/** What the note speaks about. */
export interface NoteSubject {
  tree: FamilyTree;
  of_all: CommonAncestors|null;
  marks: MarksInTree;
  colouring: Colouring;
  colour_by: ColourBy;
  genes: GeneTable;
  gene_names: readonly string[];
}

export class FamilyNote {
  readonly element: HTMLElement;
  /** The organism that is described; null: none yet. */
  at: Place|null = null;
  #subject: NoteSubject|null = null;
  readonly #text = h("p", {class: "family-note", "aria-live": "polite"});
  readonly #genes = h("p", {class: "hint family-changes", "aria-live": "polite"});
  readonly #mark: HTMLButtonElement;
  readonly #changes = new FamilyChanges((text) => set_text(this.#genes, text));

  constructor(mark: (at: Place) => void) {
    this.#mark = button(family_texts.mark, () => this.at && mark(this.at));
    this.element = h("div", {class: "family-reading"}, this.#text, this.#genes, h("div", {class: "row"}, this.#mark));
  }

  /** Describes another organism. */
  read(world: ViewedWorld, at: Place|null): void {
    this.at = at;
    this.#draw();
    const organism = at && this.#subject && organism_at(this.#subject.tree, at);
    const was_bred = organism !== null && organism.parents.length > 0;
    this.#changes.read(was_bred ? world : null, was_bred ? organism : null);
  }

  show(subject: NoteSubject): void {
    if (subject.tree !== this.#subject?.tree) {
      this.at = null;
      this.#changes.read(null, null);
    }
    this.#subject = subject;
    this.#draw();
  }

  /** Another run is shown. */
  forget(): void {
    this.#changes.forget();
  }

  #draw(): void {
    const at = this.at, subject = this.#subject;
    this.element.hidden = !at || !subject;
    if (!at || !subject) {
      return;
    }
    const {tree, of_all, marks, colouring, colour_by, genes, gene_names} = subject, organism = organism_at(tree, at);
    const founder = colouring.founder_of(at.row, at.place);
    const value = colour_by.kind === "gene" ? genes.value(organism, colour_by.gene) : NaN;
    const mark = marks.places.findIndex(({row, place}) => row === at.row && place === at.place);
    const is_in = (common: CommonAncestors|null): boolean =>
      common !== null && common.row === at.row && common.places.includes(at.place);
    set_text(
      this.#text,
      family_texts.organism(organism) + (founder ? family_texts.of_lineage(founder) : "") +
        (colour_by.kind === "gene" && !Number.isNaN(value) ?
           family_texts.gene_value(gene_label(gene_names[colour_by.gene] ?? ""), gene_number(value)) :
           "") +
        (is_in(of_all) ? family_texts.is_ancestor_of_all : "") +
        (is_in(marks.of_two) ? family_texts.is_ancestor_of_both : "") +
        (mark >= 0 ? family_texts.is_marked(mark === 0 ? "A" : "B") : ""));
    set_text(this.#mark, mark >= 0 ? family_texts.unmark : family_texts.mark);
  }
}
