// FamilyMarks: the two organisms that the user has marked, A and B, and the sentence about their common ancestors.
import {type AncestorsOfTwo, ancestors_of_two, type CommonAncestors} from "../family/common_ancestors";
import {type Ancestor, name_key, type OrganismName} from "../family/lineage";
import type {FamilyTree, Place} from "../family/spot";
import {place_of} from "../family/tree";
import {family_texts} from "../texts/family";
import {h, set_text} from "../widgets/dom";
import {button} from "../widgets/form";

export function organism_at(tree: FamilyTree, at: Place): Ancestor {
  return tree.rows[at.row]![at.place]!.ancestor;
}

export function ancestors_in(tree: FamilyTree, {row, places}: CommonAncestors): Ancestor[] {
  return places.map((place) => organism_at(tree, {row, place}));
}

/** The marks that are in a tree. */
export interface MarksInTree {
  places: readonly Place[]; // A, B
  of_two: AncestorsOfTwo|null; // the common ancestors of both
}

export class FamilyMarks {
  readonly element: HTMLElement;
  #marked: readonly OrganismName[] = [];
  #shown: {tree: FamilyTree; marked: readonly OrganismName[]; result: MarksInTree}|null = null;
  readonly #text = h("p", {role: "status"});
  readonly #clear = button(family_texts.no_marks, () => this.clear());
  readonly #on_change: () => void;

  constructor(on_change: () => void) {
    this.#on_change = on_change;
    this.element = h("div", {class: "panel family-marks"}, this.#text, h("div", {class: "row"}, this.#clear));
  }

  clear(): void {
    this.#marked = [];
    this.#on_change();
  }

  /** Marks an organism, or removes its mark. A third mark replaces the older one. */
  toggle(organism: OrganismName): void {
    const key = name_key(organism), others = this.#marked.filter((name) => name_key(name) !== key);
    this.#marked = others.length < this.#marked.length ? others : [...others, organism].slice(-2);
    this.#on_change();
  }

  /** Updates the sentence. */
  show(tree: FamilyTree): MarksInTree {
    if (this.#shown?.tree !== tree || this.#shown.marked !== this.#marked) {
      this.#shown = {tree, marked: this.#marked, result: this.#compute(tree)};
    }
    return this.#shown.result;
  }

  #compute(tree: FamilyTree): MarksInTree {
    const places = this.#marked.flatMap((name) => place_of(tree, name) ?? []), [one, other] = places;
    const of_two = one && other ? ancestors_of_two(tree, one, other) : null;
    set_text(
      this.#text,
      !one     ? family_texts.mark_two :
        !other ? family_texts.mark_another(organism_at(tree, one)) :
                 family_texts.marked(organism_at(tree, one), organism_at(tree, other)) +
          sentence_of(tree, one, other, of_two));
    this.#clear.hidden = this.#marked.length === 0;
    return {places, of_two};
  }
}

function sentence_of(tree: FamilyTree, one: Place, other: Place, of_two: AncestorsOfTwo|null): string {
  if (!of_two) {
    return family_texts.two_have_none(tree.first_generation);
  }
  const is_common = ({row, place}: Place): boolean => row === of_two.row && of_two.places.includes(place);
  return is_common(one) ? family_texts.one_descends_from_other("A", "B") :
    is_common(other)    ? family_texts.one_descends_from_other("B", "A") :
                          family_texts.two_descend_from(ancestors_in(tree, of_two));
}
