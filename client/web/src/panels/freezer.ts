// FreezerPanel: keeps organisms and populations of the shown world, lists what is kept, and opens files of chromosomes.
// FreezerEntry shows the chosen entry.
import {
  file_bytes_max,
  genes_bytes_max,
  type Kept,
  kept_count,
  kept_organisms,
  name_of_origin,
  type Origin,
  type WorldOrigin
} from "../freezer/freezer";
import {read_population, type Population} from "../freezer/population_csv";
import {whole_population} from "../freezer/whole_population";
import {common_texts} from "../texts/common";
import {freezer_texts as texts} from "../texts/freezer";
import {guarded_button, set_allowed} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {hint, row, text_field} from "../widgets/form";
import {accept_drops, open_button} from "../widgets/files";
import {gene_choices} from "../world/gene_axes";
import {name_characters_max, name_of_file} from "../world/names";
import type {Panel, PanelContext} from "../world/panel_context";

import {FreezerEntry} from "./freezer_entry";
import {table_head, update_rows} from "./rows";

export class FreezerPanel implements Panel {
  readonly name = "freezer";
  readonly title = texts.title;
  readonly element: HTMLElement;

  readonly #context: PanelContext;
  readonly #freezer = kept_organisms();
  readonly #entry: FreezerEntry;
  readonly #name = text_field(texts.name, {maxlength: name_characters_max, placeholder: texts.name_hint});
  readonly #keep_selected: HTMLButtonElement;
  readonly #keep_healthiest: HTMLButtonElement;
  readonly #keep_population: HTMLButtonElement;
  readonly #problem = h("p", {class: "error", role: "alert"});
  readonly #rows = h("tbody", {});
  readonly #table: HTMLElement;
  readonly #usage = h("p", {class: "hint"});
  #kept: Kept[] = [];
  #chosen = ""; // name of the chosen entry; empty: none
  #busy = false; // something is being read or stored

  constructor(context: PanelContext) {
    this.#context = context;
    const {notify} = context;
    this.#keep_selected = guarded_button(texts.keep_selected, notify, () => void this.#act(() => this.#selected()));
    this.#keep_healthiest =
      guarded_button(texts.keep_healthiest, notify, () => void this.#act(() => this.#healthiest()));
    this.#keep_population =
      guarded_button(texts.keep_population, notify, () => void this.#act(() => this.#population()));
    this.#entry = new FreezerEntry(context, this.#freezer, (name) => this.#choose(name));
    const [open, field] = open_button(texts.open_files, ".csv,text/csv", true, (files) => void this.#open(files));
    open.title = texts.open_files_help;
    this.#table =
      h("table", {class: "table rows-table", "aria-label": texts.list}, table_head(texts.list_headings, Infinity),
        this.#rows);
    this.element =
      h("div", {class: "panel panel-freezer"}, hint(texts.about),
        h("div", {class: "row", role: "group", "aria-label": texts.keep}, h("span", {}, texts.keep),
          this.#keep_selected, this.#keep_healthiest, this.#keep_population),
        row(h("span", {}, texts.as), this.#name, open, field), this.#problem, this.#table, this.#usage,
        this.#entry.element, hint(texts.where(location.host)));
    accept_drops(this.element, (files) => void this.#open(files));
    this.#freezer.changes.listen(() => void this.#list());
    void this.#list();
  }

  refresh(): void {
    const world = this.#context.world();
    const why = this.#busy ? texts.busy : world.info ? "" : common_texts.no_world;
    const why_none = why || (world.feed.healthiest.length > 0 ? "" : texts.none_alive);
    set_allowed(this.#keep_selected, why || (world.selection.info ? "" : texts.no_selection), texts.keep_selected_help);
    set_allowed(this.#keep_healthiest, why_none, texts.keep_healthiest_help);
    set_allowed(this.#keep_population, why, texts.keep_population_help);
    this.#entry.refresh();
  }

  // ---- the list ----

  async #list(): Promise<void> {
    try {
      this.#kept = await this.#freezer.list();
    } catch (error) {
      this.#kept = [];
      set_text(this.#problem, (error as Error).message);
    }
    if (!this.#kept.some((kept) => kept.name === this.#chosen)) {
      this.#chosen = "";
    }
    this.#table.hidden = this.#kept.length === 0;
    update_rows(
      this.#rows,
      this.#kept.map((kept) => ({
                       name: kept.name,
                       chosen: kept.name === this.#chosen,
                       act: () => this.#choose(kept.name),
                       cells: [
                         texts.content(kept_count(kept), kept.organism_counts.length, kept.gene_names.length),
                         origin_text(kept.origin)
                       ]
                     })),
      Infinity);
    const bytes = this.#kept.reduce((sum, kept) => sum + kept.genes_bytes, 0);
    set_text(
      this.#usage, this.#kept.length === 0 ? texts.nothing : texts.usage(this.#kept.length, bytes, genes_bytes_max));
    await this.#show_chosen();
  }

  /** Shows an entry; the empty name: none. */
  #choose(name: string): void {
    this.#chosen = name;
    void this.#list();
  }

  async #show_chosen(): Promise<void> {
    const name = this.#chosen, kept = this.#kept.find((one) => one.name === name) ?? null;
    try {
      const population = kept ? await this.#freezer.population(name) : null;
      if (name === this.#chosen) {
        this.#entry.show(kept && population ? {kept, population} : null);
      }
    } catch (error) {
      set_text(this.#problem, (error as Error).message);
    }
  }

  // ---- keeping ----

  /** Runs one action at a time, and shows why it failed. */
  async #act(what: () => Promise<void>): Promise<void> {
    this.#busy = true;
    set_text(this.#problem, "");
    this.refresh();
    try {
      await what();
    } catch (error) {
      set_text(this.#problem, (error as Error).message);
    } finally {
      this.#busy = false;
      this.refresh();
    }
  }

  async #keep(name: string, population: Population, origin: Origin): Promise<void> {
    const kept_as = await this.#freezer.keep(name, population, origin);
    this.#choose(kept_as);
    const count = population.islands.reduce((sum, one) => sum + one.length / population.gene_names.length, 0);
    this.#context.notify(texts.kept(kept_as, count));
  }

  async #keep_from_world(population: Population, origin: WorldOrigin): Promise<void> {
    const name = this.#name.value.trim() || name_of_origin(origin);
    await this.#keep(name, population, origin);
    this.#name.value = "";
  }

  async #selected(): Promise<void> {
    const world = this.#context.world(), {info: organism} = world.selection;
    if (organism) {
      await this.#keep_organism(
        world.gene_names, organism.genes ?? [], Number(organism.generation ?? 0), world.selection.id ?? 0);
    }
  }

  async #healthiest(): Promise<void> {
    const world = this.#context.world(), first = world.feed.healthiest[0];
    if (first) {
      const info = await this.#context.server.request(
        "get_organism", {world: world.shown, island: world.island, organism: first.id});
      await this.#keep_organism(world.gene_names, info.genes ?? [], Number(info.generation ?? 0), first.id);
    }
  }

  async #keep_organism(gene_names: string[], genes: readonly number[], generation: number, organism: number):
    Promise<void> {
    const {name, island} = this.#context.world();
    await this.#keep_from_world(
      {gene_names: [...gene_names], islands: [Float32Array.from(genes)]}, {world: name, generation, island, organism});
  }

  async #population(): Promise<void> {
    const {server} = this.#context, {name, shown, info, gene_names} = this.#context.world();
    const {generation, population} = await whole_population(
      (fields) => server.request("get_population", fields), shown, Number(info?.island_count ?? 1), gene_names);
    await this.#keep_from_world(population, {world: name, generation});
  }

  async #open(files: readonly File[]): Promise<void> {
    await this.#act(async () => {
      const problems: string[] = [], choices = gene_choices(this.#context.world().info);
      for (const file of files) {
        const read = file.size > file_bytes_max ? texts.file_too_large(file.size, file_bytes_max) :
                                                  read_population(await file.text(), choices);
        if (typeof read === "string") {
          problems.push(texts.of_file(file.name, read));
        } else {
          await this.#keep(name_of_file(file.name, "file"), read, {file: file.name});
        }
      }
      if (problems.length > 0) {
        throw new Error(problems.join(" "));
      }
    });
  }
}

function origin_text(origin: Origin): string {
  if ("file" in origin) {
    return texts.from_file(origin.file);
  }
  const {world, generation, island, organism} = origin;
  return organism === undefined ? texts.from_population(world, generation) :
                                  texts.from_organism(world, generation, island ?? 0, organism);
}
