// BestSolution: the best organism of the run: its fitness, where it lived, its genes by name, and a way to its
// ancestors. The genes are read from the run while they are shown.
import {csv_records, CsvError} from "../core/csv";
import {best_solution_texts as texts} from "../texts/best_solution";
import {capitalised, shown_number} from "../texts/numbers";
import {h, set_text} from "../widgets/dom";
import {BestOrganism} from "../world/best_organism";
import {gene_axes} from "../world/gene_axes";
import type {EndedGeneration} from "../world/history";
import type {PanelContext} from "../world/panel_context";
import {read_export} from "../world/run_export";
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
      const genes = shown_genes(world, best) ?? await stored_genes(world, best);
      problem = genes === null ? texts.missing(best.generation) : "";
      this.#rows.replaceChildren(...(genes === null ? [] : gene_rows(world, genes)));
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

function gene_rows(world: ViewedWorld, genes: ReadonlyMap<string, number>): HTMLElement[] {
  return gene_axes(world.info, world.parameters.set).filter(({name}) => genes.has(name)).map(({name, choices}) => {
    const value = genes.get(name)!;
    return h(
      "tr", {}, h("th", {scope: "row"}, name),
      h("td", {class: "number"}, choices[Math.round(value)] ?? shown_number(value)));
  });
}

/** The genes by name if the shown population contains the organism. */
function shown_genes(world: ViewedWorld, {generation, island, best_organism = 0}: EndedGeneration):
  ReadonlyMap<string, number>|null {
  const {columns} = world.population, count = columns?.genes[0]?.length ?? 0;
  return columns?.generation === generation && columns.island === island && best_organism < count ?
    new Map(columns.gene_names.map((name, gene) => [name, columns.genes[gene]![best_organism]!])) :
    null;
}

/** The genes by name from the run file; null if it does not contain the organism. Rejects with a refusal. */
async function stored_genes(world: ViewedWorld, {generation, island, best_organism = 0}: EndedGeneration):
  Promise<ReadonlyMap<string, number>|null> {
  let heading: string[]|null = null, found: ReadonlyMap<string, number>|null = null;
  const take = (lines: string[]): void => {
    for (const record of csv_records(lines.join("\n"))) {
      if (record instanceof CsvError) {
        return;
      }
      if (heading === null) {
        heading = record.cells;
      } else if (Number(record.cells[0]) === island && Number(record.cells[1]) === best_organism) {
        found = new Map(heading.map((name, i) => [name, Number(record.cells[i])]));
      }
    }
  };
  await read_export(
    world.server, {world: world.name, table: "RUN_TABLE_POPULATION", format: "TEXT_FORMAT_CSV", generation}, take,
    () => found !== null);
  return found;
}
