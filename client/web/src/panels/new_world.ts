// NewWorldDialog: creates a world from one of the experiments that evod brings along, with the parameters of the shown world, or
// from the text of an experiment file.
import annealing from "../../../../experiments/annealing.json";
import brains from "../../../../experiments/brains.json";
import classic from "../../../../experiments/classic.json";
import standard from "../../../../experiments/default.json";
import islands from "../../../../experiments/islands.json";
import rooy from "../../../../experiments/rooy.json";
import trade_offs from "../../../../experiments/trade_offs.json";
import {with_separators} from "../texts/numbers";
import {capitalised} from "../texts/texts";
import {Dialog, set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";

import type {Message} from "../core/messages";
import type {PanelContext} from "../world/panel_context";

const presets: [string, {description: string}][] = [
  ["default", standard], ["annealing", annealing], ["brains", brains], ["classic", classic], ["islands", islands],
  ["rooy", rooy], ["trade_offs", trade_offs]
];
const name_bytes_max = 64;
const seed_max = (1n << 64n) - 1n;

/** What is wrong with the name of a world; empty if nothing is. */
export function name_problem(field: string, name: string): string {
  return /^[A-Za-z0-9_-]{1,64}$/.test(name) ?
    "" :
    `${field}: got "${name}", allowed 1 to ${name_bytes_max} characters of a-z A-Z 0-9 _ -`;
}

/** `base`, or `base` with the first number that makes it unused: "default-2". */
export function unused_name(base: string, used: string[]): string {
  if (!used.includes(base)) {
    return base;
  }
  const stem = base.replace(/-\d+$/, "");
  for (let number = 2;; ++number) {
    const end = `-${number}`, name = stem.slice(0, name_bytes_max - end.length) + end;
    if (!used.includes(name)) {
      return name;
    }
  }
}

/** The text of an experiment file with the parameters and the schedule of a ParameterSet. */
export function experiment_json(set: Message): string {
  const value_of = (value: Message|undefined): unknown => value?.real ?? value?.count ?? value?.flag ?? value?.choice;
  const experiment: {[name: string]: unknown} = {};
  for (const parameter of set.parameters ?? []) {
    const now = value_of(parameter.pending ?? parameter.value);
    const later: Message[] = (set.schedule ?? []).filter((one: Message) => one.name === parameter.name);
    experiment[parameter.name] = later.length === 0 ?
      now :
      Object.fromEntries([["1", now], ...later.map((one) => [String(one.generation), value_of(one.value)])]);
  }
  return JSON.stringify(experiment, null, 2);
}

export class NewWorldDialog {
  #dialog = new Dialog("New world", "new-world");
  #choices = h("div", {class: "choices", role: "radiogroup", "aria-label": "Experiment"});
  #name =
    h("input",
      {class: "field grow", id: "new-world-name", maxlength: name_bytes_max, spellcheck: "false", autocomplete: "off"});
  #seed = h("input", {
    class: "field grow",
    id: "new-world-seed",
    inputmode: "numeric",
    placeholder: "empty: chosen at random",
    autocomplete: "off"
  });
  #text = h("textarea", {class: "field", rows: 8, spellcheck: "false", "aria-label": "Text of the experiment"});
  #beside = h("input", {type: "checkbox"});
  #error = h("p", {class: "error grow", role: "alert"});
  #create: HTMLButtonElement;
  #same_label = h("span", {});
  #same: HTMLInputElement;
  #name_edited = false;

  readonly #context: PanelContext;

  constructor(context: PanelContext) {
    this.#context = context;
    presets.forEach(
      ([name, {description}], i) =>
        this.#choices.append(this.#choice(h("span", {}, name), description, i === 0, () => this.#choose(name))));
    const same = this.#choice(
      this.#same_label, "The parameters and the schedule that this world has now.", false,
      () => void this.#choose_same());
    this.#same = same.querySelector("input")!;
    this.#choices.append(same);
    const file = h("input", {
                   type: "file",
                   accept: ".json,application/json,text/plain",
                   class: "visually-hidden",
                   tabindex: -1,
                   onchange: () => void this.#read(file)
                 }) as HTMLInputElement;
    this.#name.addEventListener("input", () => (this.#name_edited = true));
    this.#text.addEventListener("input", () => this.#choose_none());
    this.#create = h("button", {type: "submit", class: "button button-primary"}, "Create");
    this.#dialog.body.append(h(
      "form", {
        class: "panel",
        onsubmit: (event: Event) => {
          event.preventDefault();
          void this.#send();
        }
      },
      this.#choices,
      h("div", {class: "labelled"},
        h("label",
          { for: "new-world-name"
          },
          "name"),
        this.#name,
        h("label",
          { for: "new-world-seed"
          },
          "seed"),
        this.#seed),
      h("p", {class: "hint"},
        "The seed determines everything that is random. Two worlds with equal seeds and parameters are equal."),
      h("details", {}, h("summary", {}, "Parameters as text"),
        h("p", {class: "hint"}, "The text of the experiment. A parameter that it does not name has its default value."),
        this.#text,
        h("div", {class: "row"},
          h("button", {type: "button", class: "button", onclick: () => file.click()}, "Open a file …"), file)),
      h("label", {class: "check"}, this.#beside, "show it beside this world"),
      h("div", {class: "row dialog-end"}, this.#error,
        h("button", {type: "button", class: "button", onclick: () => this.#dialog.close()}, "Cancel"), this.#create)));
  }

  open(): void {
    const world = this.#context.world();
    this.#name_edited = false;
    set_text(this.#error, "");
    set_attribute(this.#name, "aria-invalid", null);
    set_attribute(this.#seed, "aria-invalid", null);
    set_text(this.#same_label, `same as ${world.name}`);
    this.#same.disabled = !world.parameters.set;
    this.#choices.querySelector("input")!.checked = true;
    this.#choose(presets[0]![0]);
    this.#dialog.open();
    this.#choices.querySelector("input")!.focus();
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
      this.#name.value = unused_name(base, this.#context.server.world_names);
    }
  }

  async #read(field: HTMLInputElement): Promise<void> {
    const file = field.files?.[0];
    if (file) {
      this.#text.value = await file.text();
      this.#suggest(
        file.name.replace(/\.json$/, "").replace(/[^A-Za-z0-9_-]/g, "_").slice(0, name_bytes_max) || "world");
      this.#choose_none();
    }
    field.value = "";
  }

  async #send(): Promise<void> {
    const name = this.#name.value.trim(), seed = this.#seed.value.trim();
    const seed_wrong = seed !== "" && !(/^\d{1,20}$/.test(seed) && BigInt(seed) <= seed_max);
    const problem = name_problem("name", name) ||
      (seed_wrong ? `seed: got "${seed}", allowed whole numbers from 0 to ${with_separators(seed_max)}` : "");
    set_attribute(this.#name, "aria-invalid", name_problem("name", name) ? "true" : null);
    set_attribute(this.#seed, "aria-invalid", seed_wrong ? "true" : null);
    set_text(this.#error, capitalised(problem));
    if (problem) {
      return;
    }
    this.#create.disabled = true;
    try {
      await this.#context.server.request(
        "create_world", {name, experiment_json: this.#text.value, ...(seed ? {seed: BigInt(seed)} : {})});
      this.#dialog.close();
      if (this.#beside.checked) {
        this.#context.show_beside(name);
      } else {
        this.#context.world().show(name);
      }
    } catch (error) {
      set_text(this.#error, (error as Error).message);
    } finally {
      this.#create.disabled = false;
    }
  }
}
