// FreezerEntry: the chosen entry of the freezer: places copies of it, begins a world with it, saves it as a file,
// renames and deletes it, and compares its genes with those of the selected organism.
import {compared_genes, type ComparedGene, difference_counts, range_of_gene} from "../freezer/comparison";
import type {Freezer, Kept} from "../freezer/freezer";
import {body_genes, genes_of_organism, is_organism, type Population, population_text} from "../freezer/population_csv";
import {gene_label, gene_number} from "../organism/texts";
import {common_texts} from "../texts/common";
import {freezer_texts as texts} from "../texts/freezer";
import {number_in} from "../texts/numbers";
import {guarded_button, set_allowed, set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {save_file} from "../widgets/files";
import {gene_problem, name_characters_max} from "../world/names";
import type {PanelContext} from "../world/panel_context";
import {Refusal} from "../world/server";

import {new_world_dialog} from "./new_world";

const copies_max = 100;
const tries_max = 30; // for a free place, per copy
const margin_px = 20; // from the walls
const further_genes_max = 500; // shown in the table

interface Shown {
  kept: Kept;
  population: Population;
}

export class FreezerEntry {
  readonly element: HTMLElement;

  readonly #context: PanelContext;
  readonly #freezer: Freezer;
  readonly #choose: (name: string) => void;
  readonly #title = h("h3", {});
  readonly #island = this.#number_field(texts.island);
  readonly #organism = this.#number_field(texts.organism);
  readonly #which =
    h("div", {class: "row"}, ...this.#labelled(texts.island, this.#island),
      ...this.#labelled(texts.organism, this.#organism));
  readonly #copies =
    h("input", {class: "field freezer-number", inputmode: "numeric", value: "10", "aria-label": texts.copies});
  readonly #place: HTMLButtonElement;
  readonly #scatter: HTMLButtonElement;
  readonly #create: HTMLButtonElement;
  readonly #download = h("button", {type: "button", class: "button", onclick: () => this.#save()}, texts.download);
  readonly #rename = h("button", {type: "button", class: "button", onclick: () => this.#ask_rename()}, texts.rename);
  readonly #remove = h("button", {type: "button", class: "button", onclick: () => this.#ask_remove()}, texts.remove);
  readonly #new_name = h("input", {
    class: "field grow",
    "aria-label": texts.new_name,
    maxlength: name_characters_max,
    spellcheck: "false",
    autocomplete: "off"
  });
  readonly #rename_form: HTMLFormElement;
  readonly #question = h("p", {});
  readonly #confirm: HTMLElement;
  readonly #problem = h("p", {class: "error", role: "alert"});
  readonly #compared = h("p", {});
  readonly #genes = h("div", {});
  #shown: Shown|null = null;
  #drawn: unknown[] = []; // what the table of genes shows
  #placing = false;

  /** choose  shows another entry; the empty name: none */
  constructor(context: PanelContext, freezer: Freezer, choose: (name: string) => void) {
    this.#context = context;
    this.#freezer = freezer;
    this.#choose = choose;
    const {notify} = context;
    this.#place = guarded_button(texts.place, notify, () => this.#place_by_clicks());
    this.#scatter = guarded_button(texts.scatter, notify, () => void this.#place_anywhere());
    this.#create = guarded_button(
      texts.create, notify,
      () => void context.attempt(() => new_world_dialog(context).open(this.#shown?.kept.name ?? "")));
    const cancel = (form: () => HTMLElement, button: HTMLElement): HTMLElement =>
      h("button", {type: "button", class: "button", onclick: () => close(form(), button)}, common_texts.cancel);
    this.#rename_form =
      h("form", {
        class: "confirm",
        hidden: true,
        onsubmit: (event: Event) => {
          event.preventDefault();
          void this.#act(() => this.#do_rename());
        }
      },
        h("div", {class: "row"}, this.#new_name,
          h("button", {type: "submit", class: "button button-primary"}, texts.do_rename),
          cancel(() => this.#rename_form, this.#rename)));
    const remove = (): void => void this.#act(() => this.#do_remove());
    this.#confirm =
      h("div", {class: "confirm", hidden: true}, this.#question,
        h("div", {class: "row"},
          h("button", {type: "button", class: "button button-danger", onclick: remove}, texts.do_remove),
          cancel(() => this.#confirm, this.#remove)));
    this.element =
      h("section", {class: "panel freezer-entry", hidden: true}, this.#title,
        h("div", {class: "row"}, this.#create, this.#download, this.#rename, this.#remove), this.#rename_form,
        this.#confirm, this.#which, h("div", {class: "row"}, this.#place),
        h("div", {class: "row"}, h("label", {class: "row"}, this.#copies, texts.copies), this.#scatter), this.#problem,
        this.#compared, this.#genes);
  }

  /** Shows an entry; null: none. */
  show(shown: Shown|null): void {
    const before = this.#shown;
    if (shown && before?.kept.name === shown.kept.name && before.kept.kept_ms === shown.kept.kept_ms) {
      return;
    }
    this.#shown = shown;
    this.element.hidden = shown === null;
    this.#rename_form.hidden = this.#confirm.hidden = true;
    this.#island.value = this.#organism.value = "0";
    set_text(this.#problem, "");
    if (shown) {
      const {name} = shown.kept, is_one = is_organism(shown.population);
      set_text(this.#title, name);
      this.#which.hidden = is_one;
      this.#download.title = texts.download_help(`${name}.csv`);
      set_allowed(this.#create, "", is_one ? texts.create_copies_help : texts.create_help);
    }
    this.refresh();
  }

  refresh(): void {
    if (!this.#shown) {
      return;
    }
    const {server} = this.#context, world = this.#context.world();
    const {name, gene_names} = this.#shown.kept;
    const why = !world.info         ? common_texts.no_world :
      !server.features.has("place") ? texts.cannot_place :
      world.is_replay               ? texts.replay :
                                      server.why_not("place", world.shown) ||
        gene_problem(name, gene_names, world.name, world.gene_names);
    set_allowed(this.#place, why, texts.place_help);
    set_allowed(this.#scatter, why || (this.#placing ? texts.busy : ""), texts.scatter_help);
    set_allowed(
      this.#create, server.why_not("create_world"),
      is_organism(this.#shown.population) ? texts.create_copies_help : texts.create_help);
    this.#show_genes();
  }

  // ---- the chosen organism ----

  /** Which organism of the entry is compared and placed; or a sentence about a wrong number. */
  #chosen(): {island: number; organism: number}|string {
    const {population} = this.#shown!, gene_count = population.gene_names.length;
    const island = number_in(texts.island, this.#island.value, 0, population.islands.length - 1);
    if (typeof island === "string") {
      return island;
    }
    const organism =
      number_in(texts.organism, this.#organism.value, 0, population.islands[island]!.length / gene_count - 1);
    return typeof organism === "string" ? organism : {island, organism};
  }

  #number_field(label: string): HTMLInputElement {
    return h("input", {
      class: "field freezer-number",
      inputmode: "numeric",
      value: "0",
      id: `freezer-${label}`,
      oninput: () => this.refresh()
    });
  }

  #labelled(text: string, field: HTMLInputElement): HTMLElement[] {
    const label = h("label", {}, text);
    label.htmlFor = field.id;
    return [label, field];
  }

  // ---- genes ----

  #show_genes(): void {
    const {population} = this.#shown!, world = this.#context.world(), {info: organism} = world.selection;
    const chosen = this.#chosen(), wrong = typeof chosen === "string" ? chosen : "";
    set_attribute(this.#organism, "aria-invalid", wrong === "" ? null : "true");
    const drawn = [this.#shown, this.#island.value, this.#organism.value, organism?.genes?.join(), world.selection.id];
    if (drawn.every((one, i) => one === this.#drawn[i])) {
      return;
    }
    this.#drawn = drawn;
    set_text(this.#problem, wrong === "" ? "" : `${wrong}.`);
    this.#genes.hidden = this.#compared.hidden = wrong !== "";
    if (typeof chosen === "string") {
      return;
    }
    const genes = compared_genes(
      population.gene_names, genes_of_organism(population, chosen.island, chosen.organism), world.gene_names,
      organism?.genes ?? []);
    set_text(this.#compared, comparison_text(genes, organism ? world.selection.id : null));
    const other = organism ? world.selection.id : null, further = genes.slice(body_genes.length);
    this.#genes.replaceChildren(this.#table(genes.slice(0, body_genes.length), 0, other));
    if (further.length > 0) {
      this.#genes.append(this.#further(further, other));
    }
  }

  #table(genes: readonly ComparedGene[], first: number, other: number|null): HTMLElement {
    const {population} = this.#shown!, has_ranges = !is_organism(population);
    const headings = [
      ...texts.gene_headings, ...(has_ranges ? [texts.range_heading] : []),
      ...(other === null ? [] : [texts.other(other), texts.difference])
    ];
    const rows = genes.map((gene, i) => {
      const range = has_ranges ? range_of_gene(population, first + i) : null;
      const numbers = [
        gene_number(gene.kept), ...(range ? [`${gene_number(range.min)}…${gene_number(range.max)}`] : []),
        ...(
          other === null        ? [] :
            gene.other === null ? ["–", "–"] :
                                  [gene_number(gene.other), signed(gene.other - gene.kept)])
      ];
      return h(
        "tr", {}, h("th", {scope: "row"}, gene_label(gene.name)),
        ...numbers.map((text) => h("td", {class: "number"}, text)));
    });
    return h(
      "table", {class: "table"},
      h("thead", {},
        h("tr", {}, ...headings.map((text, i) => h("th", {scope: "col", class: i > 0 ? "number" : null}, text)))),
      h("tbody", {}, ...rows));
  }

  /** The genes behind those of the body. Their table is made when the user opens it. */
  #further(genes: readonly ComparedGene[], other: number|null): HTMLElement {
    const details: HTMLDetailsElement =
      h("details", {
        ontoggle: () => {
          if (details.open && details.children.length === 1) {
            details.append(this.#table(genes.slice(0, further_genes_max), body_genes.length, other));
            if (genes.length > further_genes_max) {
              details.append(h("p", {class: "hint"}, texts.genes_left_out(genes.length - further_genes_max)));
            }
          }
        }
      },
        h("summary", {}, texts.further_genes(genes.length)));
    return details;
  }

  // ---- placing ----

  /** The organism that is placed, with its name for people; or a sentence about a wrong number. */
  #model(): {name: string; genes: number[]; gene_names: string[]}|string {
    const {kept, population} = this.#shown!, chosen = this.#chosen();
    if (typeof chosen === "string") {
      return chosen;
    }
    const {island, organism} = chosen;
    const name =
      is_organism(population) ? kept.name : texts.organism_name(kept.name, island, organism, population.islands.length);
    return {name, genes: [...genes_of_organism(population, island, organism)], gene_names: kept.gene_names};
  }

  #place_by_clicks(): void {
    const model = this.#model();
    if (typeof model !== "string" && this.#context.place_by_clicks({...model, name: texts.a_copy_of(model.name)})) {
      this.#context.notify(texts.placing(model.name));
    }
  }

  async #place_anywhere(): Promise<void> {
    const world = this.#context.world(), {snapshot, shown, island} = world, model = this.#model();
    const wanted = number_in(texts.copies, this.#copies.value, 1, copies_max);
    const problem = typeof model === "string" ? model : typeof wanted === "string" ? wanted : "";
    set_attribute(this.#copies, "aria-invalid", typeof wanted === "string" ? "true" : null);
    set_text(this.#problem, problem === "" ? "" : `${problem}.`);
    if (typeof model === "string" || typeof wanted === "string" || !snapshot) {
      return;
    }
    this.#placing = true;
    this.refresh();
    await this.#act(async () => {
      for (let placed = 0; placed < wanted; ++placed) {
        const size = {x: snapshot.width_px, y: snapshot.height_px};
        if (!await this.#place_copy({world: shown, island}, model.genes, size)) {
          throw new Error(texts.no_room(placed, wanted));
        }
      }
      this.#context.notify(texts.scattered(model.name, wanted, world.name, island));
    });
    this.#placing = false;
    this.refresh();
  }

  /** Returns whether a free place was found. */
  async #place_copy(where: {world: string; island: number}, genes: number[], size: {x: number; y: number}):
    Promise<boolean> {
    const random = (length: number): number =>
      length > 2 * margin_px ? margin_px + Math.random() * (length - 2 * margin_px) : length / 2;
    for (let tries = 0; tries < tries_max; ++tries) {
      try {
        const organisms = [{x_px: random(size.x), y_px: random(size.y), genes}];
        await this.#context.server.request("place", {...where, organisms});
        return true;
      } catch (error) {
        const is_occupied = error instanceof Refusal && error.violations.some(({field}) => /\.[xy]_px$/.test(field));
        if (!is_occupied) {
          throw error;
        }
      }
    }
    return false;
  }

  // ---- files, names ----

  #save(): void {
    const {kept, population} = this.#shown!;
    save_file(new Blob([population_text(population)], {type: "text/csv"}), `${kept.name}.csv`);
  }

  #ask_rename(): void {
    this.#confirm.hidden = true;
    this.#rename_form.hidden = false;
    this.#new_name.value = this.#shown!.kept.name;
    this.#new_name.select();
    this.#new_name.focus();
  }

  async #do_rename(): Promise<void> {
    const name = await this.#freezer.rename(this.#shown!.kept.name, this.#new_name.value.trim());
    close(this.#rename_form, this.#rename);
    this.#choose(name);
  }

  #ask_remove(): void {
    set_text(this.#question, texts.ask_remove(this.#shown!.kept.name));
    this.#rename_form.hidden = true;
    this.#confirm.hidden = false;
    this.#confirm.querySelector("button")!.focus();
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

function comparison_text(genes: readonly ComparedGene[], other: number|null): string {
  if (other === null) {
    return texts.nothing_to_compare;
  }
  const {common, different} = difference_counts(genes), missing = genes.length - common;
  return (different === 0 ? texts.equal(other, common) : texts.different(other, different, common)) +
    (missing > 0 ? texts.not_common(missing) : "");
}

function signed(difference: number): string {
  const text = gene_number(difference);
  return difference > 0 ? `+${text}` : text;
}

function close(form: HTMLElement, button: HTMLElement): void {
  form.hidden = true;
  button.focus();
}
