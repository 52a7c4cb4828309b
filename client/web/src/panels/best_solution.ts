// BestSolution: the best organism of the run: its fitness, where it lived, its genes by name, and a way to its
// ancestors. The genes are read from the run while they are shown.
import {best_solution_texts as texts} from "../texts/best_solution";
import {capitalised} from "../texts/numbers";
import {h, set_text} from "../widgets/dom";
import {BestOrganism} from "../world/best_organism";
import type {EndedGeneration} from "../world/history";
import type {PanelContext} from "../world/panel_context";
import type {ViewedWorld} from "../world/world";

const wait_ms = 1000; // after a reading, before the genes of a better organism are read

export class BestSolution {
  readonly element: HTMLElement;
  readonly #context: PanelContext;
  readonly #best = new BestOrganism();
  readonly #fitness = h("strong", {});
  readonly #place = h("span", {});
  readonly #note = h("p", {class: "hint", role: "status"});
  readonly #rows = h("tbody", {});
  readonly #table = h(
    "table", {class: "table", "aria-label": texts.table},
    h("thead", {}, h("tr", {}, h("th", {}, texts.headings[0]), h("th", {class: "number"}, texts.headings[1]))),
    this.#rows);
  readonly #details = h("details", {}, h("summary", {}, texts.genes), this.#note, this.#table);
  #shown: EndedGeneration|null = null;
  #of = ""; // run, generation, island and organism of the genes that were read last, or could not be read
  #due_ms = 0;
  #pending = false;

  constructor(context: PanelContext) {
    this.#context = context;
    const ancestors = h(
      "button", {type: "button", class: "link", title: texts.ancestors_help, onclick: () => this.#show_ancestors()},
      texts.ancestors);
    this.element = h(
      "section", {class: "best-solution", "aria-label": texts.title, hidden: true},
      h("p", {}, `${texts.title}: `, this.#fitness, ", ", this.#place, " ", ancestors), this.#details);
    this.#details.addEventListener("toggle", () => this.update(this.#context.world()));
  }

  update(world: ViewedWorld): void {
    const best = this.#shown = this.#best.in(world.history.generations);
    this.element.hidden = best === null;
    if (best === null) {
      return;
    }
    const {generation, island, best_organism = 0, fitness_best = 0} = best;
    set_text(this.#fitness, texts.fitness(fitness_best));
    set_text(
      this.#place, texts.place(best_organism, (world.info?.island_count ?? 1) > 1 ? island : null, generation));
    const of = [world.name, world.info?.run_id, generation, island, best_organism].join(" ");
    const is_due = !this.#pending && performance.now() >= this.#due_ms;
    if (this.#details.open && of !== this.#of && is_due && world.server.state.phase === "open") {
      this.#of = of;
      void this.#read(world, best);
    }
  }

  #show_ancestors(): void {
    if (this.#shown !== null) {
      const {generation, island, best_organism: organism = 0} = this.#shown;
      this.#context.open("family", {generation, island, organism});
    }
  }

  async #read(world: ViewedWorld, best: EndedGeneration): Promise<void> {
    this.#pending = true;
    if (this.#rows.childElementCount === 0) {
      set_text(this.#note, texts.loading);
    }
    let problem = "";
    try {
      const {genes_of_best} = await import("./loaded_later"), genes = await genes_of_best(world, best);
      problem = genes === null ? texts.missing(best.generation) : "";
      this.#rows.replaceChildren(
        ...(genes ?? []).map(([name, value]) => h(
                               "tr", {}, h("th", {scope: "row"}, name), h("td", {class: "number"}, value))));
    } catch (error) {
      problem = `${capitalised((error as Error).message)}.`;
      this.#rows.replaceChildren();
    } finally {
      this.#pending = false;
      this.#due_ms = performance.now() + wait_ms;
    }
    set_text(this.#note, problem);
    this.#table.hidden = problem !== "";
  }
}
