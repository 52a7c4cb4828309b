// FreezerEntry: the chosen entry of the freezer: begins a world with it, saves it as a file, renames and deletes it,
// places copies and compares genes.
import type {Freezer} from "../freezer/freezer";
import {is_organism, population_text} from "../freezer/population_csv";
import {freezer_texts as texts} from "../texts/freezer";
import {guarded_button, set_allowed} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {save_file} from "../widgets/files";
import {button, Question, row, text_field} from "../widgets/form";
import {gene_choices} from "../world/gene_axes";
import {name_characters_max} from "../world/names";
import type {PanelContext} from "../world/panel_context";

import {FreezerChoice, type ShownEntry} from "./freezer_choice";
import {FreezerGenes} from "./freezer_genes";
import {FreezerPlacing, type Model} from "./freezer_placing";
import {new_world_dialog} from "./new_world";

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
  readonly #download = button(texts.download, () => this.#save(this.#shown!));
  readonly #rename = button(texts.rename, () => this.#ask_rename());
  readonly #remove = button(texts.remove, () => this.#ask_remove());
  readonly #new_name = text_field(texts.new_name, {maxlength: name_characters_max});
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

  /** Shows an entry; null: none. */
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
      this.#create, this.#context.server.access.why_not("create_world"),
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

  // ---- files, names ----

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

  /** The file contains the texts of choices if the entry comes from the shown world, whose choices are known. */
  #save({kept, population}: ShownEntry): void {
    const {name, info} = this.#context.world(), {origin} = kept;
    const choices = "world" in origin && origin.world === name ? gene_choices(info) : undefined;
    save_file(new Blob([population_text(population, choices)], {type: "text/csv"}), `${kept.name}.csv`);
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
