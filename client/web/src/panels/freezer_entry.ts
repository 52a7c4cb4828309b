// FreezerEntry: the chosen entry of the freezer: begins a world with it, saves it as a file, renames and deletes it,
// places copies and compares genes.
import {compared_genes, type ComparedGene, difference_counts, range_of_gene} from "../freezer/comparison";
import type {Freezer, Kept} from "../freezer/freezer";
import {body_genes, genes_of_organism, is_organism, type Population, population_text} from "../freezer/population_csv";
import {gene_label, gene_number} from "../organism/texts";
import {common_texts} from "../texts/common";
import {freezer_texts as texts} from "../texts/freezer";
import {number_in} from "../texts/numbers";
import {guarded_button, set_allowed, set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {Question, hint, labelled, row} from "../widgets/form";
import {save_file} from "../widgets/files";
import {gene_problem, name_characters_max} from "../world/names";
import type {PanelContext} from "../world/panel_context";
import {place} from "../world/placing";
import {Refusal} from "../world/server";
import type {ViewedWorld} from "../world/world";
import {new_world_dialog} from "./new_world";
import {table_head} from "./rows";

export interface ShownEntry {
  kept: Kept;
  population: Population;
}

export interface ChosenOrganism {
  name: string; // for people: "leader", "organism 3 of ancestors"
  genes: Float32Array;
}

/** Which organism of the shown entry of the freezer is meant. */
export class FreezerChoice {
  readonly element: HTMLElement;

  readonly #on_change: () => void;
  readonly #island = this.#field("freezer-island");
  readonly #organism = this.#field("freezer-organism");
  #shown: ShownEntry|null = null;

  constructor(on_change: () => void) {
    this.#on_change = on_change;
    this.element =
      row(labelled(texts.island, this.#island), this.#island, labelled(texts.organism, this.#organism), this.#organism);
  }

  show(shown: ShownEntry): void {
    this.#shown = shown;
    this.#island.value = this.#organism.value = "0";
    this.element.hidden = is_organism(shown.population);
  }

  /** The organism; or a sentence about a wrong number, without a full stop. */
  chosen(): ChosenOrganism|string {
    const {kept, population} = this.#shown!, islands = population.islands.length;
    const island = number_in(texts.island, this.#island.value, 0, islands - 1);
    const count = typeof island === "string" ? 0 : kept.organism_counts[island]!;
    const organism = typeof island === "string" ? 0 : number_in(texts.organism, this.#organism.value, 0, count - 1);
    set_attribute(this.#island, "aria-invalid", typeof island === "string" ? "true" : null);
    set_attribute(this.#organism, "aria-invalid", typeof organism === "string" ? "true" : null);
    if (typeof island === "string") {
      return island;
    }
    return typeof organism === "string" ? organism : {
      name: is_organism(population) ? kept.name : texts.organism_name(kept.name, island, organism, islands),
      genes: genes_of_organism(population, island, organism)
    };
  }

  #field(id: string): HTMLInputElement {
    return h("input", {class: "field freezer-number", inputmode: "numeric", id, oninput: () => this.#on_change()});
  }
}

const copies_max = 100;
const tries_max = 30; // for a free place, per copy
const margin_px = 20; // from the walls
const place_field = /^place\.organisms\[0\](\.[xy]_px)?$/; // of refusals because something is in the way

/** What is placed: the chosen organism and the names of its genes; a sentence if none is chosen. */
export type Model = {
  organism: ChosenOrganism; gene_names: string[]
}|string;

/** Places copies of an organism of the freezer in the shown world: by clicks, or at random places. */
export class FreezerPlacing {
  readonly element: HTMLElement;

  readonly #context: PanelContext;
  readonly #model: () => Model;
  readonly #on_problem: (problem: string) => void;
  readonly #by_clicks: HTMLButtonElement;
  readonly #scatter: HTMLButtonElement;
  readonly #copies =
    h("input", {class: "field freezer-number", inputmode: "numeric", value: "10", "aria-label": texts.copies});
  #busy = false; // copies are being placed

  /** on_problem  is called with why nothing was placed, as a sentence; with the empty text when it is tried again */
  constructor(context: PanelContext, model: () => Model, on_problem: (problem: string) => void) {
    this.#context = context;
    this.#model = model;
    this.#on_problem = on_problem;
    this.#by_clicks = guarded_button(texts.place, context.notify, () => this.#place_by_clicks());
    this.#scatter = guarded_button(texts.scatter, context.notify, () => void this.#place_anywhere());
    this.element =
      h("div", {class: "panel"}, row(this.#by_clicks),
        row(h("label", {class: "row"}, this.#copies, texts.copies), this.#scatter));
  }

  /** name, gene_names: of the entry */
  refresh(name: string, gene_names: readonly string[]): void {
    const {server} = this.#context, world = this.#context.world();
    const why = !world.info         ? common_texts.no_world :
      !server.features.has("place") ? texts.cannot_place :
      world.is_replay               ? texts.replay :
                                      server.why_not("place", world.shown) ||
        gene_problem(name, gene_names, world.name, world.gene_names);
    set_allowed(this.#by_clicks, why, texts.place_help);
    set_allowed(this.#scatter, why, texts.scatter_help);
  }

  #place_by_clicks(): void {
    const model = this.#model();
    if (typeof model === "string") {
      return;
    }
    const {organism: {name, genes}, gene_names} = model;
    if (this.#context.place_by_clicks({name: texts.a_copy_of(name), genes: [...genes], gene_names})) {
      this.#context.notify(texts.placing(name));
    }
  }

  async #place_anywhere(): Promise<void> {
    const model = this.#model(), wanted = number_in(texts.copies, this.#copies.value, 1, copies_max);
    set_attribute(this.#copies, "aria-invalid", typeof wanted === "string" ? "true" : null);
    this.#on_problem(typeof wanted === "string" ? `${wanted}.` : "");
    if (typeof model === "string" || typeof wanted === "string" || this.#busy) {
      return;
    }
    this.#busy = true;
    try {
      await this.#place_copies(model.organism, wanted);
    } catch (error) {
      this.#on_problem((error as Error).message);
    }
    this.#busy = false;
  }

  async #place_copies({name, genes}: ChosenOrganism, wanted: number): Promise<void> {
    const world = this.#context.world(), {snapshot, island} = world;
    if (!snapshot) {
      return;
    }
    for (let placed = 0; placed < wanted; ++placed) {
      const size = {x: snapshot.width_px, y: snapshot.height_px};
      if (!await this.#place_copy(world, [...genes], size)) {
        throw new Error(texts.no_room(placed, wanted));
      }
    }
    this.#context.notify(texts.scattered(name, wanted, world.name, island));
  }

  async #place_copy(world: ViewedWorld, genes: number[], size: {x: number; y: number}): Promise<boolean> {
    const random = (length: number): number =>
      length > 2 * margin_px ? margin_px + Math.random() * (length - 2 * margin_px) : length / 2;
    for (let tries = 0; tries < tries_max; ++tries) {
      try {
        const organisms = [{x_px: random(size.x), y_px: random(size.y), genes}];
        await place(world, {organisms});
        return true;
      } catch (error) {
        const is_occupied = error instanceof Refusal && error.violations.some(({field}) => place_field.test(field));
        if (!is_occupied) {
          throw error;
        }
      }
    }
    return false;
  }
}

const further_genes_max = 500; // shown in the table

/** The selected organism; id null: none is selected. */
export interface Other {
  id: number|null;
  gene_names: readonly string[];
  genes: readonly number[];
}

/** The genes of an organism in the freezer, compared with those of the selected organism and with the population to
 *  which it belongs. */
export class FreezerGenes {
  readonly element: HTMLElement;
  readonly #summary = h("p", {});
  readonly #tables = h("div", {});
  #drawn = ""; // what the tables show
  #of: ShownEntry|null = null;

  constructor() {
    this.element = h("div", {class: "panel"}, this.#summary, this.#tables);
  }

  update(shown: ShownEntry, chosen: ChosenOrganism, other: Other): void {
    const drawn = [chosen.name, other.id, other.genes.join()].join("/");
    if (shown === this.#of && drawn === this.#drawn) {
      return;
    }
    this.#of = shown;
    this.#drawn = drawn;
    const {population} = shown;
    const genes = compared_genes(population.gene_names, chosen.genes, other.gene_names, other.genes);
    const further = genes.slice(body_genes.length), is_open = this.#tables.querySelector("details")?.open ?? false;
    set_text(this.#summary, summary_text(genes, other.id));
    this.#tables.replaceChildren(table(population, genes.slice(0, body_genes.length), 0, other.id));
    if (further.length > 0) {
      this.#tables.append(further_genes(population, further, other.id, is_open));
    }
  }
}

function summary_text(genes: readonly ComparedGene[], other: number|null): string {
  if (other === null) {
    return texts.nothing_to_compare;
  }
  const {common, different} = difference_counts(genes), missing = genes.length - common;
  return (different === 0 ? texts.equal(other, common) : texts.different(other, different, common)) +
    (missing > 0 ? texts.not_common(missing) : "");
}

/** first  number of the first of these genes in the chromosome */
function table(population: Population, genes: readonly ComparedGene[], first: number, other: number|null): HTMLElement {
  const has_ranges = !is_organism(population);
  const headings = [
    ...texts.gene_headings, ...(has_ranges ? [texts.range_heading] : []),
    ...(other === null ? [] : [texts.other(other), texts.difference])
  ];
  const cells = (gene: ComparedGene, i: number): string[] => {
    const range = has_ranges ? range_of_gene(population, first + i) : null;
    return [
      gene_number(gene.kept), ...(range ? [`${gene_number(range.min)}…${gene_number(range.max)}`] : []),
      ...(
        other === null        ? [] :
          gene.other === null ? ["–", "–"] :
                                [gene_number(gene.other), signed(gene.other - gene.kept)])
    ];
  };
  return h(
    "table", {class: "table"}, table_head(headings, 1),
    h("tbody", {},
      ...genes.map(
        (gene, i) =>
          h("tr", {}, h("th", {scope: "row"}, gene_label(gene.name)),
            ...cells(gene, i).map((text) => h("td", {class: "number"}, text))))));
}

/** The genes behind those of the body. Their table is made when the user opens it. */
function further_genes(
  population: Population, genes: readonly ComparedGene[], other: number|null, is_open: boolean): HTMLElement {
  const fill = (): void => {
    if (details.open && details.children.length === 1) {
      details.append(table(population, genes.slice(0, further_genes_max), body_genes.length, other));
      if (genes.length > further_genes_max) {
        details.append(hint(texts.genes_left_out(genes.length - further_genes_max)));
      }
    }
  };
  const summary = h("summary", {}, texts.further_genes(genes.length));
  const details: HTMLDetailsElement = h("details", {open: is_open, ontoggle: fill}, summary);
  return details;
}

function signed(difference: number): string {
  return (difference > 0 ? "+" : "") + gene_number(difference);
}

export class FreezerEntry {
  readonly element: HTMLElement;

  readonly #context: PanelContext;
  readonly #freezer: Freezer;
  readonly #choose: (name: string) => void;
  readonly #choice = new FreezerChoice(() => this.refresh());
  readonly #placing: FreezerPlacing;
  readonly #genes = new FreezerGenes();
  readonly #title = h("h3", {});
  readonly #create: HTMLButtonElement;
  readonly #download =
    h("button", {type: "button", class: "button", onclick: () => save(this.#shown!)}, texts.download);
  readonly #rename = h("button", {type: "button", class: "button", onclick: () => this.#ask_rename()}, texts.rename);
  readonly #remove = h("button", {type: "button", class: "button", onclick: () => this.#ask_remove()}, texts.remove);
  readonly #new_name = h("input", {
    class: "field grow",
    "aria-label": texts.new_name,
    maxlength: name_characters_max,
    spellcheck: "false",
    autocomplete: "off"
  });
  readonly #rename_form = new Question(
    {before: [], field: this.#new_name}, texts.do_rename, () => void this.#act(() => this.#do_rename()),
    () => this.#rename);
  readonly #question = h("p", {});
  readonly #confirm = new Question(
    {before: [this.#question]}, texts.do_remove, () => void this.#act(() => this.#do_remove()), () => this.#remove);
  readonly #wrong = h("p", {class: "error", role: "alert"}); // about the chosen organism
  readonly #problem = h("p", {class: "error", role: "alert"}); // of the last action
  #shown: ShownEntry|null = null;

  /** choose  shows another entry; the empty name: none */
  constructor(context: PanelContext, freezer: Freezer, choose: (name: string) => void) {
    this.#context = context;
    this.#freezer = freezer;
    this.#choose = choose;
    this.#placing = new FreezerPlacing(context, () => this.#model(), (problem) => set_text(this.#problem, problem));
    this.#create = guarded_button(
      texts.create, context.notify,
      () => void context.attempt(() => new_world_dialog(context).open(this.#shown?.kept.name ?? "")));
    this.element =
      h("section", {class: "panel freezer-entry", hidden: true}, this.#title,
        row(this.#create, this.#download, this.#rename, this.#remove), this.#rename_form.element, this.#confirm.element,
        this.#choice.element, this.#wrong, this.#placing.element, this.#problem, this.#genes.element);
  }

  show(shown: ShownEntry|null): void {
    const before = this.#shown?.kept;
    if (shown && before?.name === shown.kept.name && before.kept_ms === shown.kept.kept_ms) {
      return;
    }
    this.#shown = shown;
    this.element.hidden = shown === null;
    this.#rename_form.element.hidden = this.#confirm.element.hidden = true;
    set_text(this.#problem, "");
    if (shown) {
      set_text(this.#title, shown.kept.name);
      this.#download.title = texts.download_help(`${shown.kept.name}.csv`);
      this.#choice.show(shown);
    }
    this.refresh();
  }

  refresh(): void {
    const shown = this.#shown;
    if (!shown) {
      return;
    }
    const {kept, population} = shown, world = this.#context.world(), chosen = this.#choice.chosen();
    set_allowed(
      this.#create, this.#context.server.why_not("create_world"),
      is_organism(population) ? texts.create_copies_help : texts.create_help);
    this.#placing.refresh(kept.name, kept.gene_names);
    set_text(this.#wrong, typeof chosen === "string" ? `${chosen}.` : "");
    this.#genes.element.hidden = typeof chosen === "string";
    if (typeof chosen !== "string") {
      const {selection: {info: organism}, gene_names} = world;
      this.#genes.update(
        shown, chosen, {id: organism ? world.selection.id : null, gene_names, genes: organism?.genes ?? []});
    }
  }

  #model(): Model {
    const organism = this.#choice.chosen();
    return typeof organism === "string" ? organism : {organism, gene_names: this.#shown!.kept.gene_names};
  }

  #ask_rename(): void {
    this.#confirm.element.hidden = true;
    this.#new_name.value = this.#shown!.kept.name;
    this.#rename_form.open();
  }

  async #do_rename(): Promise<void> {
    const name = await this.#freezer.rename(this.#shown!.kept.name, this.#new_name.value.trim());
    this.#rename_form.close();
    this.#choose(name);
  }

  #ask_remove(): void {
    set_text(this.#question, texts.ask_remove(this.#shown!.kept.name));
    this.#rename_form.element.hidden = true;
    this.#confirm.open();
  }

  async #do_remove(): Promise<void> {
    await this.#freezer.remove(this.#shown!.kept.name);
    this.#choose("");
  }

  async #act(what: () => Promise<void>): Promise<void> {
    set_text(this.#problem, "");
    try {
      await what();
    } catch (error) {
      set_text(this.#problem, (error as Error).message);
    }
  }
}

function save({kept, population}: ShownEntry): void {
  save_file(new Blob([population_text(population)], {type: "text/csv"}), `${kept.name}.csv`);
}
