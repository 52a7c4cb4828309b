// FamilyTable: the organisms of one generation of a family tree as a table, for those who cannot see the drawing, and
// to copy. It is built only while it is open.
import type {CommonAncestors} from "../family/common_ancestors";
import type {FamilyTree, Spot} from "../family/spot";
import {family_texts} from "../texts/family";
import {fitness_text, with_separators} from "../texts/numbers";
import {set_options} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {button} from "../widgets/form";

const rows_max = 100; // at a time

export interface TableSubject {
  tree: FamilyTree;
  of_all: CommonAncestors|null;
  of_two: CommonAncestors|null;
}

export class FamilyTable {
  readonly element: HTMLDetailsElement;
  #subject: TableSubject|null = null;
  #row = 0;
  #first = 0;

  readonly #generation: HTMLSelectElement = h("select", {
    class: "field",
    "aria-label": family_texts.table_of,
    onchange: () => this.#show(Number(this.#generation.value), 0)
  });
  readonly #range = h("span", {class: "hint", role: "status"});
  readonly #previous = button(family_texts.previous_rows, () => this.#show(this.#row, this.#first - rows_max));
  readonly #next = button(family_texts.next_rows, () => this.#show(this.#row, this.#first + rows_max));
  readonly #body = h("tbody", {});

  constructor() {
    this.element =
      h("details", {ontoggle: () => this.#build()}, h("summary", {}, family_texts.table),
        h("div", {class: "row"}, this.#generation, this.#range, this.#previous, this.#next),
        h("div", {class: "glass-table", tabindex: 0, role: "group", "aria-label": family_texts.table},
          h("table", {class: "table", "aria-label": family_texts.table},
            h("thead", {}, h("tr", {}, ...family_texts.table_columns.map((name) => h("th", {scope: "col"}, name)))),
            this.#body)));
  }

  show(subject: TableSubject|null): void {
    if (subject?.tree !== this.#subject?.tree) {
      this.#row = (subject?.tree.rows.length ?? 1) - 1;
      this.#first = 0;
    }
    this.#subject = subject;
    this.#build();
  }

  #show(row: number, first: number): void {
    this.#row = row;
    this.#first = first;
    this.#build();
  }

  #build(): void {
    const subject = this.#subject;
    if (!this.element.open || !subject) {
      this.#body.replaceChildren();
      return;
    }
    const {tree} = subject, spots = tree.rows[this.#row] ?? [];
    const last = Math.min(spots.length, this.#first + rows_max);
    set_options(
      this.#generation,
      tree.rows.map((_, i) => ({value: String(i), text: with_separators(tree.first_generation + i)})).reverse(),
      String(this.#row));
    set_text(this.#range, family_texts.table_rows(this.#first + 1, last, spots.length));
    this.#previous.hidden = this.#first === 0;
    this.#next.hidden = last >= spots.length;
    this.#body.replaceChildren(
      ...spots.slice(this.#first, last).map((spot, i) => this.#table_row(subject, spot, this.#first + i)));
  }

  #table_row({of_all, of_two}: TableSubject, {ancestor}: Spot, place: number): HTMLElement {
    const name = (organism: number, island: number): string =>
      island === 0 ? String(organism) : family_texts.on_island(organism, island);
    const is_in = (common: CommonAncestors|null): boolean =>
      common !== null && common.row === this.#row && common.places.includes(place);
    const common = [
      ...(is_in(of_all) ? [family_texts.table_ancestor_of_all] : []),
      ...(is_in(of_two) ? [family_texts.table_ancestor_of_both] : []),
    ].join(", ");
    return h(
      "tr", {}, h("th", {scope: "row"}, name(ancestor.organism, ancestor.island)),
      h("td", {}, family_texts.kinds[ancestor.origin] ?? ancestor.origin),
      h("td", {}, ancestor.parents.map((parent) => name(parent.organism, parent.island)).join(", ")),
      h("td", {class: "number"}, ancestor.fitness === null ? "" : fitness_text(ancestor.fitness)),
      h("td", {class: "number"}, with_separators(ancestor.child_count)),
      h("td", {class: "number"}, with_separators(ancestor.kept_count)), h("td", {}, common));
  }
}
