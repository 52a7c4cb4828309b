// OrganismOrigin and OrganismOffspring: why the selected organism exists, and which offspring it has.
import {distinct_parents} from "../organism/history";
import type {OrganismHistory} from "../organism/history";
import {birth_text, child_text, parents_text, picks_text} from "../organism/texts";
import {organism_texts as texts} from "../texts/organism";
import {h, set_text} from "../widgets/dom";
import {button, row} from "../widgets/form";
import type {PanelContext} from "../world/panel_context";
import {OriginNote} from "./origin_note";

const children_shown_max = 40;

/** What is known about the breeding, and what the buttons do. */
export interface OriginContext {
  has_bred(): boolean; // whether the generation of the organism has bred
  is_loading(): boolean;
  problem(): string; // why the picks are unknown
  origin_run(): string; // id of the run in which the parents bred, if the world is a fork of it
  go_to(generation: number, island: number, organism: number): void;
  open_picks(generation: number, island: number, organism: number): void; // in the glass box
}

export class OrganismOrigin {
  readonly #context: OriginContext;
  readonly #parents = h("p", {});
  readonly #parent_rows = h("div", {class: "organism-parents"});
  readonly #own_picks = h("p", {});
  readonly #show_picks_row: HTMLElement;
  readonly #show_picks = button(texts.show_picks, () => this.#open_own_picks());
  readonly #problem = h("p", {class: "error", role: "status"});
  readonly #note: OriginNote;
  readonly element: HTMLElement;
  #history: OrganismHistory|null = null;
  #built = ""; // the parents in the rows, and what is known about them

  constructor(panel: PanelContext, context: OriginContext) {
    this.#context = context;
    this.#note = new OriginNote(panel, () => undefined);
    this.#show_picks_row = row(this.#show_picks);
    this.element =
      h("section", {class: "panel organism-part"}, h("h3", {}, texts.why), this.#parent_rows, this.#parents,
        this.#own_picks, this.#show_picks_row, this.#problem, this.#note.element);
  }

  update(history: OrganismHistory): void {
    this.#history = history;
    const {info, picks, place} = history, problem = this.#context.problem();
    const parents = history.is_older ? [] : distinct_parents(info);
    const known = parents.map((parent) => `${parent}:${history.picks_of_parent(parent) !== null}`);
    const described = JSON.stringify([place, known, problem]);
    if (described !== this.#built) {
      this.#built = described;
      this.#parent_rows.replaceChildren(...parents.map((parent) => this.#parent_row(history, parent)));
    }
    const of_parents = parents.flatMap((parent) => {
      const of_parent = history.picks_of_parent(parent);
      return of_parent ? [picks_text(texts.its_parent(parent), of_parent)] : [];
    });
    const text = history.has_births ? birth_text(history) : info ? parents_text(info, history.origin) : "";
    set_text(this.#parents, text === "" ? "" : [`${text}.`, ...of_parents].join(" "));
    this.#show_picks_row.hidden = history.has_births;
    set_text(this.#own_picks, picks ? picks_text(texts.it, picks) : "");
    this.#own_picks.hidden = picks === null;
    this.#show_picks.disabled = picks === null;
    this.#show_picks.title = picks ? texts.show_picks_help :
      !this.#context.has_bred()    ? texts.not_bred :
      this.#context.is_loading()   ? texts.loading :
                                     texts.no_picks;
    const origin_run = this.#context.origin_run();
    set_text(this.#problem, problem ? texts.picks_problem(problem) : "");
    this.#note.update(origin_run, place.generation - 1, parents[0] ?? null);
  }

  #parent_row(history: OrganismHistory, parent: number): HTMLElement {
    if (history.has_births) { // of the same interval
      const {island, generation} = history.place;
      const go_to = button(texts.go_to_parent(parent), () => this.#context.go_to(generation, island, parent));
      return row(go_to);
    }
    const picks = history.picks_of_parent(parent), {island} = history.place, generation = history.place.generation - 1;
    // Only the picks contain whether the parent is a copy of an organism of another island.
    const origin = picks?.migrant ?? {island, organism: parent};
    return h(
      "div", {class: "row"},
      button(
        texts.go_to_parent(parent), () => this.#context.go_to(generation, origin.island, origin.organism),
        {disabled: picks === null && this.#context.problem() === "", title: texts.go_to_parent_help}),
      button(
        texts.why_parent(parent), () => this.#context.open_picks(generation, island, parent),
        {disabled: picks === null, title: texts.why_parent_help}));
  }

  #open_own_picks(): void {
    if (this.#history) {
      const {generation, island, id} = this.#history.place;
      this.#context.open_picks(generation, island, id);
    }
  }
}

export class OrganismOffspring {
  readonly #context: OriginContext;
  readonly #heading = h("h3", {}, texts.offspring);
  readonly #children = h("div", {class: "organism-children"});
  readonly element = h("section", {class: "panel organism-part"}, this.#heading, this.#children);
  #built = ""; // the children, and what is known about them

  constructor(context: OriginContext) {
    this.#context = context;
  }

  update({place, children, children_left_out, has_births}: OrganismHistory): void {
    this.element.hidden = has_births;
    const next = place.generation + 1, has_bred = this.#context.has_bred();
    const described = JSON.stringify([place, children?.length, children_left_out, has_bred]);
    if (described === this.#built) {
      return;
    }
    this.#built = described;
    const count = children?.length ?? 0;
    set_text(this.#heading, count > 0 ? texts.offspring_in(next, count) : texts.offspring);
    const buttons = (children ?? [])
                      .slice(0, children_shown_max)
                      .map(
                        (child) => button(
                          child_text(child), () => this.#context.go_to(next, place.island, child.id),
                          {class: "button organism-child", title: texts.child_help(child.id, next)}));
    const more = count - buttons.length;
    const hint = !has_bred ? texts.offspring_later :
      children_left_out    ? texts.offspring_too_many :
      children === null    ? texts.loading :
      count === 0          ? texts.no_offspring :
      more > 0             ? texts.more(more) :
                             "";
    this.#children.replaceChildren(...buttons, h("span", {class: "hint"}, hint));
  }
}
