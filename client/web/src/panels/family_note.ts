// FamilyNote: what is known about the organism that the pointer or the keyboard points at.
import {inheritance_of, mutation_text} from "../breeding/inheritance";
import type {Descendant} from "../core/protocol";
import type {ColourBy, Colouring} from "../family/colouring";
import type {CommonAncestors} from "../family/common_ancestors";
import type {GeneTable} from "../family/family_data";
import {name_key, type OrganismName} from "../family/lineage";
import type {FamilyTree, Place} from "../family/spot";
import {gene_label, gene_number} from "../organism/texts";
import {gene_text} from "../texts/breeding";
import {family_texts} from "../texts/family";
import {h, set_text} from "../widgets/dom";
import {button} from "../widgets/form";
import type {ViewedWorld} from "../world/world";
import {type MarksInTree, organism_at} from "./family_marks";

const wait_ms = 250; // before the breeding is requested
const texts_max = 20_000; // kept
const changes_shown_max = 8;
const no_row = 0xffffffff; // the first row of a list that is not wanted

/** Which genes of an organism mutated when it was bred. Reads the breeding of its generation when the pointer or
 *  the keyboard stays at the organism, a page of organisms at a time. */
export class FamilyChanges {
  #texts = new Map<string, string>(); // by organism
  #timer: ReturnType<typeof setTimeout>|undefined;
  #wanted = "";
  readonly #show: (text: string) => void;

  /** show  receives the sentence about the organism that was read last; "": none */
  constructor(show: (text: string) => void) {
    this.#show = show;
  }

  forget(): void {
    this.#texts.clear();
    this.read(null, null);
  }

  read(world: ViewedWorld|null, organism: OrganismName|null): void {
    clearTimeout(this.#timer);
    this.#wanted = organism ? name_key(organism) : "";
    const known = this.#texts.get(this.#wanted);
    if (!world || !organism || known !== undefined) {
      this.#show(known ?? "");
      return;
    }
    this.#show(family_texts.loading_changes);
    this.#timer = setTimeout(() => void this.#load(world, organism), wait_ms);
  }

  async #load(world: ViewedWorld, {generation, island, organism}: OrganismName): Promise<void> {
    const wanted = this.#wanted;
    let text: string|undefined;
    try {
      const breeding = await world.server.request("get_breeding", {
        world: world.shown,
        island,
        generation: generation - 1,
        first_contender: no_row,
        first_pick: no_row,
        first_descendant: organism,
      });
      if (this.#texts.size > texts_max) {
        this.#texts.clear();
      }
      for (const descendant of breeding.descendants ?? []) {
        this.#texts.set(
          name_key({generation, island, organism: descendant.id ?? 0}), changes_text(descendant, world.gene_names));
      }
      text = this.#texts.get(wanted) ?? "";
    } catch (error) {
      text = family_texts.changes_unknown(error instanceof Error ? error.message : String(error));
    }
    if (wanted === this.#wanted) {
      this.#show(text);
    }
  }
}

/** "Mutated genes: impulse 101.2 → 98.7 (creep)." */
function changes_text(descendant: Descendant, gene_names: readonly string[]): string {
  const changes = inheritance_of(descendant)?.changes ?? [], order = descendant.order_mutation;
  return family_texts.changed_genes(
           changes.slice(0, changes_shown_max).map((change) => ({
                                                     gene: gene_label(gene_names[change.gene] ?? String(change.gene)),
                                                     before: gene_text(change.before),
                                                     after: gene_text(change.after),
                                                     how: mutation_text(change.kind),
                                                   })),
           Math.max(0, changes.length - changes_shown_max)) +
    (order ? family_texts.order_mutated(order.method ?? "") : "");
}

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
