// ShownTree: the tree, its common ancestors and its colours, computed again only when their subject changes. No DOM.
import {type ColourBy, type Colouring, colouring_of} from "./colouring";
import {type AncestorsOfAll, ancestors_of_all} from "./common_ancestors";
import type {FamilyData, Subject} from "./family_data";
import {name_key} from "./lineage";
import type {FamilyTree} from "./spot";
import {family_tree, type TreeForm} from "./tree";

export class ShownTree {
  tree: FamilyTree|null = null;
  colouring: Colouring|null = null;
  of_all: AncestorsOfAll|null = null; // of a whole generation
  organism_count = 0;
  layout_ms = 0; // the time that the last tree took, for measurements
  #made_of = "";
  #coloured_by = "";

  update(subject: Subject|null, data: FamilyData, form: TreeForm): void {
    const ancestors = data.lineage?.ancestors;
    const made_of = subject && ancestors ?
      [
        subject.run_id, subject.whole, name_key(subject.root), form.both_parents, form.generations, form.order,
        ancestors.size
      ].join("/") :
      "";
    if (made_of === this.#made_of) {
      return;
    }
    this.#made_of = made_of;
    this.#coloured_by = "";
    const begun = performance.now();
    this.tree = null;
    this.of_all = null;
    if (subject && ancestors) {
      const {whole, root} = subject;
      const is_root = (name: {generation: number; island: number}): boolean =>
        name.generation === root.generation && name.island === root.island;
      this.tree = family_tree(ancestors, whole ? [...ancestors.values()].filter(is_root) : [root], form);
      this.of_all = whole && this.tree ? ancestors_of_all(this.tree) : null;
    }
    this.organism_count = (this.tree?.rows ?? []).reduce((sum, row) => sum + row.length, 0);
    this.layout_ms = performance.now() - begun;
  }

  /** Returns whether the colours have changed. */
  colour(by: ColourBy, data: FamilyData): boolean {
    const coloured_by =
      [this.#made_of, by.kind, by.kind === "gene" ? by.gene : "", data.gene_progress?.loaded].join("/");
    if (!this.tree || coloured_by === this.#coloured_by) {
      return false;
    }
    this.#coloured_by = coloured_by;
    this.colouring = colouring_of(this.tree, by, data.genes);
    return true;
  }
}
