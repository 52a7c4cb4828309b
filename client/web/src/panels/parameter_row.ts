// ParameterRow: one parameter: its name with unit and remarks, its value, and when it takes effect.
import type {ParameterDescription, ParameterValue} from "../core/protocol";
import {effect_texts, parameter_texts as texts} from "../texts/parameters";
import {allowed_words} from "../texts/registry";
import {h, set_text} from "../widgets/dom";
import {type EditedParameter, planned_values} from "../world/parameter_edits";
import {number_of, value_text} from "../world/parameter_values";
import {allowed_text, is_number, label_of, label_of_choice, unit_text} from "../world/parameters";

import {ParameterControl, type RowContext} from "./parameter_value";

export class ParameterRow {
  readonly element: HTMLElement;

  readonly #context: RowContext;
  readonly #about: ParameterDescription;
  readonly #control: ParameterControl;
  readonly #mark = h("span", {class: "parameter-mark", title: texts.not_default});
  readonly #toggle: HTMLButtonElement;
  readonly #remarks = h("span", {class: "parameter-remarks"});
  readonly #refused = h("p", {class: "error parameter-wide"});
  readonly #effect = h("span", {});
  readonly #help = h("div", {class: "parameter-help parameter-wide", hidden: true});
  readonly #default_button: HTMLButtonElement;
  #described = ""; // what the help shows

  /** parameter  its index in the registry */
  constructor(context: RowContext, readonly parameter: number, id: string) {
    this.#context = context;
    const about = this.#about = context.edits.registry[parameter]!, usual = value_text(about.default_value ?? {});
    const label = h("span", {class: "parameter-label", id: `label-${id}`}, label_of(about));
    this.#toggle =
      h("button", {
        class: "parameter-name",
        type: "button",
        "aria-expanded": "false",
        title: `${about.name}\n${about.help ?? ""}`,
        onclick: () => this.#toggle_help()
      },
        label, this.#mark);
    this.#remarks.id = `remarks-${id}`;
    this.#refused.id = `refused-${id}`;
    this.#control = new ParameterControl(context, parameter, {
      "aria-labelledby": label.id,
      "aria-describedby": `${this.#remarks.id} ${this.#refused.id}`,
      "data-parameter": about.name ?? ""
    });
    this.#default_button =
      h("button", {
        class: "parameter-default",
        type: "button",
        title: texts.to_default_help(usual),
        "aria-label": texts.to_default_name(label_of(about), usual),
        onclick: () => this.#control.set(about.default_value ?? {}),
      },
        texts.to_default);
    this.element =
      h("div", {class: "parameter", "data-name": about.name}, h("div", {}, this.#toggle, this.#remarks),
        h("div", {class: "parameter-value"}, this.#control.main),
        h("div", {class: "parameter-effect"}, this.#effect, this.#default_button),
        this.#control.slider, this.#refused, this.#help);
  }

  /** Why the typed text is not a value; empty if it is one. */
  get typing_problem(): string {
    return this.#control.typing_problem;
  }

  /** Shows the present state. */
  update(may: boolean): void {
    const {is_default, violation, edit} = this.#state;
    this.#control.update(may, violation !== null);
    this.element.classList.toggle("parameter-edited", edit !== null);
    this.element.classList.toggle("parameter-refused", violation !== null || this.typing_problem !== "");
    set_text(this.#mark, is_default ? "" : " •");
    const {effect = "PARAMETER_EFFECT_UNSPECIFIED"} = this.#state.about;
    const {word, sentence} = effect_texts[effect] ?? {word: "", sentence: ""};
    set_text(this.#effect, word);
    this.#effect.title = sentence;
    this.#effect.classList.toggle("parameter-now", effect === "PARAMETER_EFFECT_NEXT_TICK");
    this.#default_button.hidden = is_default || !may;
    set_text(this.#remarks, this.#remarks_text());
    set_text(
      this.#refused,
      this.typing_problem !== "" ? this.typing_problem :
        violation === null       ? "" :
                                   texts.refused(violation.got, allowed_words(violation.allowed)));
    this.#update_help();
  }

  /** Forgets a text that was typed but is not a value. */
  forget(): void {
    this.#control.forget();
  }

  focus(): void {
    this.element.closest("details")!.open = true;
    this.element.hidden = false;
    this.#control.main.focus();
  }

  get #state(): EditedParameter {
    return this.#context.edits.parameters[this.parameter]!;
  }

  #remarks_text(): string {
    const {edit, pending, requested, value, shown, client_of_last_change: client} = this.#state;
    const planned = planned_values(this.#context.edits, this.#about.name);
    return [
      this.#unit(shown),
      edit !== null      ? texts.was(value_text(requested)) :
        pending !== null ? texts.still(value_text(value)) :
                           "",
      client === "" ? "" : texts.set_by(client),
      planned.length === 0 ? "" : texts.planned(planned),
    ].filter((part) => part !== "")
      .join(" · ");
  }

  #unit(shown: ParameterValue): string {
    return !is_number(this.#about) ? "" : unit_text(this.#about, number_of(shown)) || (this.#about.unit ?? "");
  }

  #toggle_help(): void {
    this.#help.hidden = !this.#help.hidden;
    this.#toggle.setAttribute("aria-expanded", String(!this.#help.hidden));
    this.#update_help();
  }

  #update_help(): void {
    if (this.#help.hidden) {
      return;
    }
    const {about, pending, requested, value} = this.#state, current = value_text(value);
    const facts = texts.facts(
      allowed_text(about) + (about.unit ? ` ${about.unit}` : ""), value_text(about.default_value ?? {}),
      pending !== null ? texts.now_and_then(current, value_text(requested)) : current);
    if (this.#described === facts) {
      return;
    }
    this.#described = facts;
    const {choices = [], choice_help = []} = about;
    const explained = choices.flatMap(
      (choice, n) =>
        choice_help[n] === undefined ? [] : [h("li", {}, h("b", {}, label_of_choice(choice)), `: ${choice_help[n]}`)]);
    this.#help.replaceChildren(
      h("p", {}, h("code", {}, about.name)), h("p", {}, about.help ?? ""),
      explained.length > 0 ? h("ul", {}, ...explained) : "", h("p", {}, facts),
      h("p", {}, effect_texts[about.effect ?? "PARAMETER_EFFECT_UNSPECIFIED"]?.sentence ?? ""));
  }
}
