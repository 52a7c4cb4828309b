// ClassPanel: the classes of a teacher, and a form that creates one whose worlds begin like the shown world.
import {first_population} from "../freezer/first_population";
import {whole_population} from "../freezer/whole_population";
import {type Kept, kept_organisms} from "../freezer/freezer";
import type {Population} from "../freezer/population_csv";
import {class_panel_texts as texts} from "../texts/class";
import {panels_texts} from "../texts/panels";
import type {ClassInfo, CreateClass, QuotaRange} from "../core/protocol";
import {set_attribute, set_options} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {button, hint, labelled, Question, row} from "../widgets/form";
import {experiment_json} from "../world/experiment_text";
import type {Panel, PanelContext} from "../world/panel_context";
import {typed_number} from "../world/parameter_values";
import {is_number, label_of} from "../world/parameters";

import {spaced} from "./codes";
import {class_style} from "./style";

const of_seed = "", of_world = "world", of_freezer = "kept "; // values of options
const worlds_max = 8;

interface RangeRow {
  element: HTMLElement;
  parameter: HTMLSelectElement;
  min: HTMLInputElement;
  max: HTMLInputElement;
}

export class ClassPanel implements Panel {
  readonly name = "class";
  readonly title = panels_texts.class;
  readonly element: HTMLElement;
  readonly #context: PanelContext;
  readonly #list = h("ul", {class: "class-list"});
  readonly #none = h("p", {class: "hint"});
  readonly #about = h("p", {class: "hint"});
  readonly #name =
    h("input", {class: "field grow", id: "class-name", maxlength: 24, spellcheck: "false", autocomplete: "off"});
  readonly #population = h("select", {class: "field grow", id: "class-population"});
  readonly #seeds =
    h("select", {class: "field grow", id: "class-seeds"}, h("option", {value: "CLASS_SEEDS_SAME"}, texts.seeds_same),
      h("option", {value: "CLASS_SEEDS_OWN"}, texts.seeds_own));
  readonly #worlds =
    h("input", {class: "field wall-number", id: "class-worlds", type: "number", min: 1, max: worlds_max, value: "3"});
  readonly #lesson = h("input", {class: "field grow", id: "class-lesson", spellcheck: "false", autocomplete: "off"});
  readonly #range_list = h("div", {class: "class-ranges"});
  readonly #error = h("p", {class: "error", role: "alert"});
  readonly #create = h("button", {type: "submit", class: "button button-primary"}, texts.create);
  readonly #question = h("p", {});
  readonly #confirm = new Question(
    {before: [this.#question]}, texts.do_remove, () => void this.#do_delete(),
    () => this.#opener?.isConnected ? this.#opener : this.#name);
  #deleted = "";
  #opener: HTMLElement|null = null;
  #ranges: RangeRow[] = [];
  #classes: ClassInfo[]|null = null; // null: not read yet

  constructor(context: PanelContext) {
    this.#context = context;
    void class_style();
    const submit = (event: Event): void => {
      event.preventDefault();
      void this.#send();
    };
    const field = (text: string, control: HTMLElement): HTMLElement[] => [labelled(text, control), control];
    this.element =
      h("div", {class: "panel panel-class"}, this.#list, this.#confirm.element, this.#none,
        h("form", {class: "panel", "aria-label": texts.new_class, onsubmit: submit}, h("h3", {}, texts.new_class),
          this.#about,
          h("div", {class: "labelled"}, ...field(texts.name, this.#name), ...field(texts.population, this.#population),
            ...field(texts.seeds, this.#seeds), ...field(texts.worlds, this.#worlds),
            ...field(texts.lesson, this.#lesson)),
          h("details", {}, h("summary", {}, texts.ranges), hint(texts.ranges_help), this.#range_list,
            row(button(texts.add_range, () => this.#add_range()))),
          this.#error, row(this.#create)));
    context.server.events.listen((event) => {
      if (event.class_changed && !this.element.hidden) {
        void this.#read();
      }
    });
    void this.#read();
    void this.#list_populations();
  }

  refresh(): void {
    const world = this.#context.world(), why = this.#context.server.access.why_not("create_class");
    set_text(this.#about, why || texts.about(world.name));
    this.#create.disabled = why !== "" || world.parameters.set === null;
  }

  async #read(): Promise<void> {
    try {
      this.#classes = (await this.#context.server.request("list_classes", {})).classes ?? [];
    } catch {
      // The session ended, or the role allows no classes.
    }
    this.#show();
  }

  #show(): void {
    const classes = this.#classes ?? [];
    set_text(this.#none, this.#classes === null ? "" : classes.length === 0 ? texts.none : "");
    this.#list.replaceChildren(...classes.map((one) => {
      const {name = "", code = "", members = [], frozen = false, teacher = ""} = one;
      const present = members.filter(({removed}) => !removed),
            here = present.filter(({sessions = 0}) => sessions > 0).length;
      const open = button(texts.open(name), () => this.#context.open_class(name), {class: "button button-primary"});
      const facts = [
        texts.members(here, present.length), code === "" ? texts.closed : texts.code(spaced(code)),
        frozen ? texts.frozen : "",
        teacher && teacher !== this.#context.server.state.welcome?.user ? texts.teacher(teacher) : ""
      ];
      const remove: HTMLButtonElement = button(texts.remove, () => this.#ask_delete(name, remove));
      remove.setAttribute("aria-label", texts.remove_name(name));
      return h("li", {}, open, remove, h("span", {class: "hint"}, facts.filter(Boolean).join(" · ")));
    }));
  }

  #ask_delete(name: string, opener: HTMLElement): void {
    this.#deleted = name;
    this.#opener = opener;
    set_text(this.#question, texts.ask_remove(name));
    this.#confirm.open();
  }

  async #do_delete(): Promise<void> {
    this.#confirm.close();
    await this.#context.attempt(() => this.#context.server.request("delete_class", {class: this.#deleted}));
    await this.#read();
  }

  async #list_populations(): Promise<void> {
    let kept: Kept[] = [];
    try {
      kept = await kept_organisms().list();
    } catch {
      // The browser forbids its storage.
    }
    const names = kept.map(({name}) => ({value: of_freezer + name, text: texts.kept(name)}));
    set_options(
      this.#population, [{value: of_seed, text: texts.from_seed}, {value: of_world, text: texts.from_world}, ...names],
      of_seed);
  }

  // ---- ranges ----

  #add_range(): void {
    const {parameters} = this.#context.server;
    const options = parameters.filter(is_number).map((about) => h("option", {value: about.name}, label_of(about)));
    const parameter = h("select", {class: "field grow", "aria-label": texts.parameter}, ...options);
    const bound = (label: string): HTMLInputElement =>
      h("input", {class: "field wall-number", inputmode: "decimal", "aria-label": label});
    const min = bound(texts.least), max = bound(texts.greatest);
    const remove = button("✕", () => {
      this.#ranges = this.#ranges.filter((one) => one.element !== element);
      element.remove();
    }, {"aria-label": texts.remove_range});
    const element = row(parameter, min, "–", max, remove);
    const suggest = (): void => {
      const about = parameters.find(({name}) => name === parameter.value);
      min.value = String(about?.min ?? 0);
      max.value = String(about?.max ?? 0);
    };
    parameter.addEventListener("change", suggest);
    suggest();
    this.#ranges.push({element, parameter, min, max});
    this.#range_list.append(element);
  }

  /** null: a bound is not a number. */
  #quota(): QuotaRange[]|null {
    const ranges = this.#ranges.map(({parameter, min, max}) => ({
                                      parameter: parameter.value,
                                      min: typed_number({kind: "PARAMETER_KIND_REAL"}, min.value),
                                      max: typed_number({kind: "PARAMETER_KIND_REAL"}, max.value)
                                    }));
    return ranges.every(({min, max}) => min !== null && max !== null) ? ranges as QuotaRange[] : null;
  }

  // ---- creation ----

  async #send(): Promise<void> {
    const name = this.#name.value.trim(), is_name = /^[a-z][a-z0-9-]{0,23}$/.test(name), quota = this.#quota();
    set_attribute(this.#name, "aria-invalid", is_name ? null : "true");
    set_text(this.#error, !is_name ? texts.wrong_name : quota === null ? texts.wrong_range : "");
    if (!is_name || quota === null) {
      return;
    }
    this.#create.disabled = true;
    try {
      const {server} = this.#context, world = this.#context.world();
      const wanted: CreateClass = {
        name,
        template: await this.#template(),
        seeds: this.#seeds.value as CreateClass["seeds"] & string,
        member_worlds_max: Number(this.#worlds.value),
        lesson: this.#lesson.value.trim(),
        ...(quota.length > 0 ? {ranges: {ranges: quota}} : {})
      };
      await server.request("create_class", wanted);
      this.#name.value = "";
      await this.#read();
      this.#context.open_class(name);
      set_text(this.#about, texts.about(world.name));
    } catch (error) {
      set_text(this.#error, error instanceof Error ? error.message : String(error));
    } finally {
      this.#create.disabled = false;
    }
  }

  /** The world with which each student begins. Rejects with a sentence. */
  async #template(): Promise<NonNullable<CreateClass["template"]>> {
    const {server} = this.#context, world = this.#context.world(), {seed, free_genes} = world.info ?? {};
    const text = experiment_json(await server.request("get_parameters", {world: world.shown}));
    const chosen = this.#population.value;
    const population = chosen === of_seed ? null :
      chosen === of_world                 ? await this.#population_of_world() :
                                            await kept_organisms().population(chosen.slice(of_freezer.length));
    const first = population === null ? {} : first_population(population, text, server.parameters);
    if (typeof first === "string") {
      throw new Error(first);
    }
    return {
      experiment_json: text,
      ...(seed === undefined ? {} : {seed}),
      ...(free_genes === undefined ? {} : {free_genes}),
      ...first
    };
  }

  async #population_of_world(): Promise<Population> {
    const {server} = this.#context, world = this.#context.world(), islands = world.info?.island_count ?? 1;
    const {population} = await whole_population(
      (fields) => server.request("get_population", fields), world.shown, islands, world.gene_names);
    return population;
  }
}
