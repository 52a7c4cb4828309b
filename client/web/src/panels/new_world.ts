// NewWorldDialog: creates a world from one of the experiments that evod brings along, with the parameters of the shown
// world, or from the text of an experiment file. The first generation is drawn from the seed or comes from the freezer.
import annealing from "../../../../experiments/annealing.json";
import brains from "../../../../experiments/brains.json";
import classic from "../../../../experiments/classic.json";
import colony from "../../../../experiments/colony.json";
import standard from "../../../../experiments/default.json";
import islands from "../../../../experiments/islands.json";
import predators from "../../../../experiments/predators.json";
import rooy from "../../../../experiments/rooy.json";
import trade_offs from "../../../../experiments/trade_offs.json";
import {first_population} from "../freezer/first_population";
import {type Kept, kept_count, kept_organisms} from "../freezer/freezer";
import {common_texts} from "../texts/common";
import {freezer_texts} from "../texts/freezer";
import {new_world_texts as texts} from "../texts/new_world";
import {capitalised} from "../texts/numbers";
import {Dialog, set_attribute, set_options} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {button, check, hint, labelled, row} from "../widgets/form";
import {open_button} from "../widgets/files";
import {experiment_json} from "../world/experiment_text";
import {gene_problem, name_characters_max, name_of_file, name_problem, unused_name} from "../world/names";

import type {PanelContext} from "../world/panel_context";

const presets: [string, {description: string}][] = [
  ["default", standard], ["annealing", annealing], ["brains", brains], ["classic", classic], ["colony", colony],
  ["islands", islands], ["predators", predators], ["rooy", rooy], ["trade_offs", trade_offs]
];
const seed_max = (1n << 64n) - 1n;

let dialog: NewWorldDialog|null = null;

/** The dialog of the page. */
export function new_world_dialog(context: PanelContext): NewWorldDialog {
  dialog ??= new NewWorldDialog(context);
  return dialog;
}

class NewWorldDialog {
  #dialog = new Dialog(texts.title, "new-world");
  #choices = h("div", {class: "choices", role: "radiogroup", "aria-label": texts.experiments});
  #name = h("input", {
    class: "field grow",
    id: "new-world-name",
    maxlength: name_characters_max,
    spellcheck: "false",
    autocomplete: "off",
    oninput: () => (this.#name_edited = true)
  });
  #seed = h("input", {
    class: "field grow",
    id: "new-world-seed",
    inputmode: "numeric",
    placeholder: texts.seed_hint,
    autocomplete: "off"
  });
  #population =
    h("select", {class: "field grow", id: "new-world-population", onchange: () => this.#describe_population()});
  #population_help = h("p", {class: "hint"});
  #text = h(
    "textarea",
    {class: "field", rows: 8, spellcheck: "false", "aria-label": texts.text_label, oninput: () => this.#choose_none()});
  #beside = h("input", {type: "checkbox"});
  #error = h("p", {class: "error grow", role: "alert"});
  #create = h("button", {type: "submit", class: "button"}, texts.create);
  #create_and_run =
    h("button", {type: "button", class: "button button-primary", onclick: () => void this.#send(true)},
      texts.create_and_run);
  #same_label = h("span", {});
  #same: HTMLInputElement;
  #name_edited = false;
  #kept: Kept[] = []; // what the first generation can be

  readonly #context: PanelContext;

  constructor(context: PanelContext) {
    this.#context = context;
    presets.forEach(([name, {description}], i) => {
      const about = texts.descriptions[name] ?? description;
      this.#choices.append(this.#choice(h("span", {}, name), about, i === 0, () => this.#choose(name)));
    });
    const same = this.#choice(this.#same_label, texts.same_help, false, () => void this.#choose_same());
    this.#same = same.querySelector("input")!;
    this.#choices.append(same);
    this.#dialog.body.append(this.#form());
  }

  /** population: the name of the entry of the freezer with which the world begins; empty: drawn from the seed */
  async open(population = ""): Promise<void> {
    const world = this.#context.world();
    this.#name_edited = false;
    set_text(this.#error, "");
    set_attribute(this.#name, "aria-invalid", null);
    set_attribute(this.#seed, "aria-invalid", null);
    set_text(this.#same_label, texts.same(world.name));
    this.#same.disabled = !world.parameters.set;
    this.#choices.querySelector("input")!.checked = true;
    this.#choose(presets[0]![0]);
    await this.#list_populations(population);
    if (population) { // an experiment with the genes of the population is more useful than the default
      const genes = this.#kept.find((kept) => kept.name === population)?.gene_names;
      if (genes && world.parameters.set && !gene_problem(population, genes, world.name, world.gene_names)) {
        this.#same.checked = true;
        await this.#choose_same();
      }
      this.#suggest(population);
    }
    this.#dialog.open();
    this.#choices.querySelector<HTMLInputElement>("input:checked")!.focus();
  }

  #form(): HTMLElement {
    const [open, field] =
      open_button(texts.open_file, ".json,application/json,text/plain", false, (files) => void this.#read(files[0]));
    const submit = (event: Event): void => {
      event.preventDefault();
      void this.#send(false);
    };
    return h(
      "form", {class: "panel", onsubmit: submit}, this.#choices,
      h("div", {class: "labelled"}, labelled(texts.name, this.#name), this.#name, labelled(texts.seed, this.#seed),
        this.#seed, labelled(texts.population, this.#population), this.#population),
      this.#population_help, hint(texts.seed_help),
      h("details", {}, h("summary", {}, texts.text), hint(texts.text_help), this.#text, row(open, field)),
      check(this.#beside, texts.beside),
      h("div", {class: "row dialog-end"}, this.#error, button(common_texts.cancel, () => this.#dialog.close()),
        this.#create, this.#create_and_run));
  }

  #choice(label: HTMLElement, description: string, checked: boolean, act: () => void): HTMLElement {
    return h(
      "label", {class: "choice"}, h("input", {type: "radio", name: "experiment", checked, onchange: act}), label,
      h("span", {class: "hint"}, description));
  }

  #choose(name: string): void {
    this.#text.value = JSON.stringify(presets.find(([preset]) => preset === name)![1], null, 2);
    this.#suggest(name);
  }

  async #choose_same(): Promise<void> {
    const world = this.#context.world();
    await this.#context.attempt(async () => {
      this.#text.value = experiment_json(await this.#context.server.request("get_parameters", {world: world.shown}));
      this.#suggest(world.name);
    });
  }

  /** The text is not, or no longer, that of one of the choices. */
  #choose_none(): void {
    for (const choice of this.#choices.querySelectorAll("input")) {
      choice.checked = false;
    }
  }

  #suggest(base: string): void {
    if (!this.#name_edited) {
      this.#name.value = unused_name(base, this.#context.server.worlds.names);
    }
  }

  async #read(file: File|undefined): Promise<void> {
    if (file) {
      this.#text.value = await file.text();
      this.#suggest(name_of_file(file.name, "world"));
      this.#choose_none();
    }
  }

  // ---- the first population ----

  async #list_populations(chosen: string): Promise<void> {
    let problem = "";
    try {
      this.#kept = await kept_organisms().list();
    } catch (error) {
      this.#kept = [];
      problem = texts.freezer_problem((error as Error).message);
    }
    const content = (kept: Kept): string =>
      freezer_texts.content(kept_count(kept), kept.organism_counts.length, kept.gene_names.length);
    set_options(
      this.#population,
      [
        {value: "", text: texts.from_seed},
        ...this.#kept.map((kept) => ({value: kept.name, text: `${kept.name} (${content(kept)})`}))
      ],
      chosen);
    this.#describe_population();
    if (problem) {
      set_text(this.#population_help, problem);
    }
  }

  #describe_population(): void {
    const chosen = this.#kept.find((kept) => kept.name === this.#population.value);
    set_text(
      this.#population_help,
      !chosen                    ? "" :
        kept_count(chosen) === 1 ? texts.copies_help :
                                   texts.population_help);
  }

  /** The fields of CreateWorld for the chosen population; a sentence if the world cannot begin with it. */
  async #population_fields(): Promise<object|string> {
    const name = this.#population.value;
    return name === "" ?
      {} :
      first_population(await kept_organisms().population(name), this.#text.value, this.#context.server.parameters);
  }

  // ---- creation ----

  async #send(runs: boolean): Promise<void> {
    const name = this.#name.value.trim(), seed = this.#seed.value.trim();
    const seed_wrong = seed !== "" && !(/^\d{1,20}$/.test(seed) && BigInt(seed) <= seed_max);
    const problem = name_problem(name) || (seed_wrong ? common_texts.wrong_seed(seed, seed_max) : "");
    set_attribute(this.#name, "aria-invalid", name_problem(name) ? "true" : null);
    set_attribute(this.#seed, "aria-invalid", seed_wrong ? "true" : null);
    set_text(this.#error, capitalised(problem));
    if (problem) {
      return;
    }
    this.#create.disabled = this.#create_and_run.disabled = true;
    try {
      const population = await this.#population_fields();
      if (typeof population === "string") {
        set_text(this.#error, capitalised(population));
        return;
      }
      await this.#context.server.request(
        "create_world",
        {name, experiment_json: this.#text.value, ...(seed ? {seed: BigInt(seed)} : {}), ...population});
      this.#dialog.close();
      if (this.#beside.checked) {
        this.#context.show_beside(name);
      } else {
        this.#context.world().show(name);
      }
      if (runs) {
        await this.#context.attempt(() => this.#context.server.request("run", {world: name}));
      }
    } catch (error) {
      set_text(this.#error, (error as Error).message);
    } finally {
      this.#create.disabled = this.#create_and_run.disabled = false;
    }
  }
}
