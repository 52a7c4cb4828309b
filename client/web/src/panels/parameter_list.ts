// ParameterList: the parameters in groups, and the search.
import {parameters_texts as texts} from "../texts/parameters";
import {h} from "../widgets/dom";
import {grouped, matches, most_used, type ParameterGroup} from "../world/parameters";

import {ParameterRow} from "./parameter_row";
import type {RowContext} from "./parameter_value";

interface Group {
  group: ParameterGroup;
  element: HTMLDetailsElement;
  rows: ParameterRow[];
  is_open: boolean; // as the user left it
  is_extra: boolean; // its parameters also belong to other groups
}

export class ParameterList {
  readonly search = h("input", {
    class: "field",
    type: "search",
    placeholder: texts.search_hint,
    "aria-label": texts.search,
    oninput: () => this.#filter()
  });
  readonly element = h("div", {class: "parameters-list"});
  readonly nothing_found = h("p", {class: "hint", hidden: true}, texts.nothing_found);

  readonly #context: RowContext;
  #groups: Group[] = [];

  constructor(context: RowContext) {
    this.#context = context;
  }

  /** Makes a row for each parameter of the registry. */
  build(): void {
    const {registry} = this.#context.edits;
    const groups =
      [this.#group(most_used(registry), true), ...grouped(registry).map((group) => this.#group(group, false))];
    this.#groups = groups.filter(({rows}) => rows.length > 0);
    this.element.replaceChildren(...this.#groups.map((group) => group.element));
    this.#filter();
  }

  /** Shows the parameters that match a text. */
  search_for(text: string): void {
    this.search.value = text;
    this.#filter();
  }

  update(may: boolean): void {
    this.#rows().forEach((row) => row.update(may));
  }

  /** Forgets texts that were typed but are not values. */
  forget(): void {
    this.#rows().forEach((row) => row.forget());
  }

  /** The first row whose typed text is not a value. */
  wrong_row(): ParameterRow|undefined {
    return this.#rows().find((row) => row.typing_problem !== "");
  }

  /** Opens the groups with rejected values, and scrolls to the first one. */
  open_violations(): void {
    const {edits} = this.#context;
    const rejected = this.#groups.filter(({is_extra}) => !is_extra)
                       .flatMap((group) => group.rows.map((row) => ({group, row})))
                       .filter(({row}) => edits.violation(row.parameter) !== null);
    for (const {group, row} of rejected) {
      group.element.hidden = row.element.hidden = false;
      group.element.open = true;
    }
    rejected[0]?.row.element.scrollIntoView({block: "nearest"});
  }

  #rows(): ParameterRow[] {
    return this.#groups.flatMap((group) => group.rows);
  }

  #group(group: ParameterGroup, is_extra: boolean): Group {
    const {registry} = this.#context.edits, id = group.title.toLowerCase().replace(/[^a-z]+/g, "-");
    const rows = group.members.map((i) => new ParameterRow(this.#context, i, `${id}-${registry[i]!.name}`));
    const summary = h("summary", {}, group.title);
    const element = h("details", {class: "parameters-group", open: true}, summary, ...rows.map((row) => row.element));
    const made: Group = {group, element, rows, is_open: true, is_extra};
    summary.addEventListener("click", () => {
      made.is_open = this.search.value === "" ? !element.open : made.is_open;
    });
    return made;
  }

  #filter(): void {
    const text = this.search.value.trim();
    let any = false;
    for (const {group, element, rows, is_open, is_extra} of this.#groups) {
      let hits = 0;
      for (const row of rows) {
        const about = this.#context.edits.registry[row.parameter]!;
        const hit = text === "" || (!is_extra && matches(about, group.title, text));
        row.element.hidden = !hit;
        hits += hit ? 1 : 0;
      }
      element.hidden = hits === 0;
      element.open = text !== "" || is_open;
      any = any || hits > 0;
    }
    this.nothing_found.hidden = any || this.#groups.length === 0;
  }
}
