// ParameterControl: what sets the value of a parameter: a field and a slider for numbers, a switch, or a drop-down.
import type {ParameterDescription, ParameterValue} from "../core/protocol";
import {parameter_texts as texts} from "../texts/parameters";
import {set_enabled, set_value} from "../widgets/controls";
import {h} from "../widgets/dom";
import {type ParameterEdits} from "../world/parameter_edits";
import {number_of, typed_number, value_of, value_text} from "../world/parameter_values";
import {allowed_text, is_number, label_of_choice, unit_text} from "../world/parameters";
import {number_at, share_of, stepped} from "../world/slider_scale";

const slider_places = 1000;

/** What the rows share. */
export interface RowContext {
  readonly edits: ParameterEdits;
  /** Why the values cannot be changed now, as a sentence; empty if they can. */
  readonly why_not: string;
  /** Call it after each edit: shows the present state, and asks the server to check the edits. */
  touch(): void;
  /** Call it when the user has set a value: with "apply at once" it is sent. */
  released(): void;
}

/** Attributes that name a control for screen readers, and the parameter for tests. */
export type ControlNames = {
  [attribute: string]: string
};

export class ParameterControl {
  /** The field, the switch or the drop-down. */
  readonly main: HTMLInputElement|HTMLSelectElement;
  readonly slider: HTMLInputElement|null = null;
  /** Why the typed text is not a value; empty if it is one. */
  typing_problem = "";

  readonly #context: RowContext;
  readonly #parameter: number;
  #dragging = false; // the user holds the slider
  #typing = false; // the text of the field is not finished

  constructor(context: RowContext, parameter: number, names: ControlNames) {
    this.#context = context;
    this.#parameter = parameter;
    if (is_number(this.#about)) {
      this.slider = this.#made_slider(names);
      this.main = this.#made_field(names);
    } else if (this.#about.kind === "PARAMETER_KIND_FLAG") {
      const flag: HTMLInputElement =
        h("input", {type: "checkbox", ...names, onchange: () => this.set({flag: flag.checked})});
      this.main = flag;
    } else {
      this.main = this.#made_choice(names);
    }
  }

  get #about(): ParameterDescription {
    return this.#context.edits.parameters[this.#parameter]!.about;
  }

  /** Shows the present value. */
  update(may: boolean, is_refused: boolean): void {
    const shown = this.#context.edits.parameters[this.#parameter]!.shown, title = may ? "" : this.#context.why_not;
    for (const control of [this.main, ...(this.slider ? [this.slider] : [])]) {
      set_enabled(control, may, title);
      control.setAttribute("aria-invalid", String(is_refused || this.typing_problem !== ""));
    }
    if (this.slider !== null) {
      const number = number_of(shown), unit = unit_text(this.#about, number);
      if (!this.#dragging) {
        this.slider.value = String(Math.round(share_of(this.#about, number) * slider_places));
      }
      this.slider.setAttribute("aria-valuetext", `${value_text(shown)} ${unit}`.trim());
      if (!this.#typing && this.typing_problem === "") {
        set_value(this.main, value_text(shown));
      }
    } else if (this.main instanceof HTMLSelectElement) {
      set_value(this.main, shown.choice ?? "");
    } else {
      this.main.checked = shown.flag === true;
    }
  }

  /** Edits the value as if the user had typed it. */
  set(value: ParameterValue): void {
    this.#typing = false;
    this.#edit(value);
    this.#context.released();
  }

  /** Forgets a text that was typed but is not a value. */
  forget(): void {
    this.#typing = this.#dragging = false;
    this.typing_problem = "";
  }

  // ---- elements ----

  #made_slider(names: ControlNames): HTMLInputElement {
    return h("input", {
      class: "parameter-slider",
      type: "range",
      min: 0,
      max: slider_places,
      ...names,
      oninput: () => this.#slide(),
      onchange: () => this.#release(),
      onkeydown: (event: KeyboardEvent) => this.#step(event, true),
    });
  }

  #made_field(names: ControlNames): HTMLInputElement {
    return h("input", {
      class: "field",
      type: "text",
      inputmode: "decimal",
      autocomplete: "off",
      ...names,
      oninput: () => this.#type(),
      onchange: () => this.#typed(),
      onblur: () => this.#typed(),
      onkeydown: (event: KeyboardEvent) => this.#step(event, false),
    });
  }

  #made_choice(names: ControlNames): HTMLSelectElement {
    const {choices = [], choice_help = []} = this.#about;
    const options =
      choices.map((choice, n) => h("option", {value: choice, title: choice_help[n] ?? null}, label_of_choice(choice)));
    const choice: HTMLSelectElement =
      h("select", {class: "field", ...names, onchange: () => this.set({choice: choice.value})}, ...options);
    return choice;
  }

  // ---- input ----

  #edit(value: ParameterValue): void {
    this.typing_problem = "";
    this.#context.edits.edit(this.#parameter, value);
    this.#context.touch();
  }

  #slide(): void {
    this.#dragging = true;
    this.#edit(value_of(this.#about, number_at(this.#about, Number(this.slider!.value) / slider_places)));
  }

  #release(): void {
    this.#dragging = false;
    this.#context.touch();
    this.#context.released();
  }

  #type(): void {
    this.#typing = true;
    const text = this.main.value, number = typed_number(this.#about, text);
    if (number !== null) {
      this.#edit(value_of(this.#about, number));
      return;
    }
    this.typing_problem =
      texts.wrong_text(text, this.#about.kind === "PARAMETER_KIND_COUNT", allowed_text(this.#about));
    this.#context.touch();
  }

  /** The user has left the field or pressed Enter. */
  #typed(): void {
    if (!this.#typing) {
      return;
    }
    this.#typing = false;
    if (this.main.value.trim() === "") { // an emptied field returns to the value
      this.typing_problem = "";
      this.#context.edits.revert(this.#parameter);
    }
    this.#context.touch();
    if (this.typing_problem === "") {
      this.#context.released();
    }
  }

  /** Arrow keys move by round steps. Enter in the field ends the edit, Escape removes it. */
  #step(event: KeyboardEvent, is_slider: boolean): void {
    if (event.ctrlKey || event.altKey || event.metaKey) {
      return;
    }
    if (event.key === "Enter" && !is_slider) {
      this.#typed();
      return;
    }
    if (event.key === "Escape" && !is_slider && this.#typing) {
      event.stopPropagation();
      this.forget();
      this.#context.edits.revert(this.#parameter);
      this.#context.touch();
      return;
    }
    const up = event.key === "ArrowUp" || event.key === "PageUp" || (is_slider && event.key === "ArrowRight");
    const down = event.key === "ArrowDown" || event.key === "PageDown" || (is_slider && event.key === "ArrowLeft");
    if (up || down) {
      event.preventDefault();
      event.stopPropagation();
      const number = number_of(this.#context.edits.parameters[this.#parameter]!.shown);
      this.set(value_of(this.#about, stepped(this.#about, number, up, event.key.startsWith("Page"))));
    }
  }
}
