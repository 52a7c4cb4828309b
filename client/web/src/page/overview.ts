// Overview: how the shown world does: its healthiest organisms, its live fitness curve and the best solution. It is the
// first panel of the column.
import {BestSolution} from "../panels/best_solution";
import {FitnessCurve, show_generation} from "../plots/fitness_curve";
import {column_texts as texts} from "../texts/column";
import {set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import type {Panel, PanelContext} from "../world/panel_context";

const named = 3; // healthiest organisms

export class Overview implements Panel {
  readonly name = "overview";
  readonly title = texts.overview;
  readonly element: HTMLElement;
  readonly #context: PanelContext;
  readonly #healthiest = h("span", {});
  readonly #healthiest_line: HTMLElement;
  readonly #buttons: readonly HTMLButtonElement[]; // of the healthiest organisms
  readonly #curve: FitnessCurve;
  readonly #best: BestSolution;

  /** evolution: the button that shows it. */
  constructor(context: PanelContext, evolution: HTMLElement) {
    this.#context = context;
    this.#curve = new FitnessCurve((generation) => void show_generation(context, generation));
    this.#best = new BestSolution(context);
    this.#buttons = Array.from(
      {length: named},
      (_, i) => h("button", {type: "button", class: "link", onclick: () => this.#select_healthiest(i)}));
    this.#healthiest_line = h("p", {class: "healthiest"}, this.#healthiest, ...this.#buttons);
    this.element =
      h("div", {class: "overview"}, this.#healthiest_line, evolution,
        h("div", {class: "curve"}, this.#curve.element), this.#best.element);
  }

  refresh(): void {
    const world = this.#context.world(), {feed: {healthiest}, selection: {id: selected}, snapshot} = world;
    this.#buttons.forEach((button, i) => {
      const organism = healthiest[i];
      button.hidden = !organism;
      set_text(button, organism ? texts.organism(organism.id, organism.health) : "");
      set_attribute(button, "aria-label", organism ? texts.organism_name(organism.id, organism.health) : null);
      set_attribute(button, "aria-pressed", String(organism !== undefined && organism.id === selected));
    });
    this.#healthiest_line.hidden = !world.has_bodies;
    set_text(
      this.#healthiest,
        healthiest.length > 0                 ? texts.healthiest :
        !snapshot                             ? "" :
        (snapshot.live?.alive_count ?? 0) > 0 ? texts.zoom_in :
                                                texts.none_alive);
    this.#curve.update(world);
    this.#best.update(world);
  }

  #select_healthiest(i: number): void {
    const world = this.#context.world(), organism = world.feed.healthiest[i];
    if (organism) {
      world.selection.select(organism.id);
    }
  }
}
