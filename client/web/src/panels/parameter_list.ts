// ParameterList: the parameters in groups, and the search.
import type {ParameterDescription, ParameterValue} from "../core/protocol";
import {effect_texts, parameter_texts as texts, parameters_texts} from "../texts/parameters";
import {set_enabled, set_value} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {type EditedParameter, type ParameterEdits, planned_values} from "../world/parameter_edits";
import {
  allowed_text,
  grouped,
  is_number,
  label_of,
  label_of_choice,
  matches,
  most_used,
  number_at,
  number_of,
  type ParameterGroup,
  share_of,
  stepped,
  typed_number,
  unit_text,
  value_of,
  value_text
} from "../world/parameters";

const slider_places = 1000;

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

/** What sets the value of a parameter: a field and a slider for numbers, a switch, or a drop-down. */
export class ParameterControl {
  readonly main: HTMLInputElement|HTMLSelectElement;
  readonly slider: HTMLInputElement|null = null;
  /** Why the typed text is not a value; empty if it is one. */
  typing_problem = "";

  readonly #context: RowContext;
  readonly #about: ParameterDescription;
  readonly #parameter: number;
  #dragging = false; // the user holds the slider
  #typing = false; // the text of the field is not finished

  constructor(context: RowContext, parameter: number, names: ControlNames) {
    this.#context = context;
    this.#parameter = parameter;
    this.#about = context.edits.registry[parameter]!;
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

/** One parameter: its name with unit and remarks, its value, and when it takes effect. */
export class ParameterRow {
  readonly element: HTMLElement;

  readonly #context: RowContext;
  readonly #about: ParameterDescription;
  readonly #control: ParameterControl;
  readonly #mark = h("span", {class: "parameter-mark", title: texts.not_default});
  readonly #toggle: HTMLButtonElement;
  readonly #remarks = h("span", {class: "parameter-remarks"});
  readonly #refused = h("p", {class: "error parameter-wide"});
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
    const {effect = "PARAMETER_EFFECT_UNSPECIFIED"} = this.#about;
    const {word, sentence} = effect_texts[effect] ?? {word: "", sentence: ""};
    const is_now = effect === "PARAMETER_EFFECT_NEXT_TICK";
    this.element =
      h("div", {class: "parameter", "data-name": about.name}, h("div", {}, this.#toggle, this.#remarks),
        h("div", {class: "parameter-value"}, this.#control.main),
        h("div", {class: "parameter-effect"},
          h("span", {class: is_now ? "parameter-now" : null, title: sentence}, word), this.#default_button),
        this.#control.slider, this.#refused, this.#help);
  }

  get typing_problem(): string {
    return this.#control.typing_problem;
  }

  update(may: boolean): void {
    const {is_default, violation, edit} = this.#state;
    this.#control.update(may, violation !== null);
    this.element.classList.toggle("parameter-edited", edit !== null);
    this.element.classList.toggle("parameter-refused", violation !== null || this.typing_problem !== "");
    set_text(this.#mark, is_default ? "" : " •");
    this.#default_button.hidden = is_default || !may;
    set_text(this.#remarks, this.#remarks_text());
    set_text(
      this.#refused,
      this.typing_problem !== "" ? this.typing_problem :
        violation === null       ? "" :
                                   texts.refused(violation.got, violation.allowed));
    this.#update_help();
  }

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
    const about = this.#about, {pending, requested, value} = this.#state, current = value_text(value);
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

interface Group {
  group: ParameterGroup;
  element: HTMLDetailsElement;
  rows: ParameterRow[];
  is_open: boolean; // as the user left it
  is_extra: boolean; // its parameters also belong to other groups
}

export class ParameterList {
  readonly search = h("input", {
    class: "field",
    type: "search",
    placeholder: parameters_texts.search_hint,
    "aria-label": parameters_texts.search,
    oninput: () => this.#filter()
  });
  readonly element = h("div", {class: "parameters-list"});
  readonly nothing_found = h("p", {class: "hint", hidden: true}, parameters_texts.nothing_found);

  readonly #context: RowContext;
  #groups: Group[] = [];

  constructor(context: RowContext) {
    this.#context = context;
  }

  build(): void {
    const {registry} = this.#context.edits;
    const groups =
      [this.#group(most_used(registry), true), ...grouped(registry).map((group) => this.#group(group, false))];
    this.#groups = groups.filter(({rows}) => rows.length > 0);
    this.element.replaceChildren(...this.#groups.map((group) => group.element));
    this.#filter();
  }

  search_for(text: string): void {
    this.search.value = text;
    this.#filter();
  }

  update(may: boolean): void {
    this.#rows().forEach((row) => row.update(may));
  }

  /** Forgets texts that were typed but are no values. */
  forget(): void {
    this.#rows().forEach((row) => row.forget());
  }

  /** The first row whose typed text is not a value. */
  wrong_row(): ParameterRow|undefined {
    return this.#rows().find((row) => row.typing_problem !== "");
  }

  /** Opens the groups with rejected values, and scrolls to the first one. */
  open_violations(): void {
    const {edits} = this.#context;
    const rejected = this.#groups.filter(({is_extra}) => !is_extra)
                       .flatMap((group) => group.rows.map((row) => ({group, row})))
                       .filter(({row}) => edits.parameters[row.parameter]!.violation !== null);
    for (const {group, row} of rejected) {
      group.element.hidden = row.element.hidden = false;
      group.element.open = true;
    }
    rejected[0]?.row.element.scrollIntoView({block: "nearest"});
  }

  #rows(): ParameterRow[] {
    return this.#groups.flatMap((group) => group.rows);
  }

  #group(group: ParameterGroup, is_extra: boolean): Group {
    const {registry} = this.#context.edits, id = group.title.toLowerCase().replace(/[^a-z]+/g, "-");
    const rows = group.members.map((i) => new ParameterRow(this.#context, i, `${id}-${registry[i]!.name}`));
    const summary = h("summary", {}, group.title);
    const element = h("details", {class: "parameters-group", open: true}, summary, ...rows.map((row) => row.element));
    const made: Group = {group, element, rows, is_open: true, is_extra};
    summary.addEventListener("click", () => {
      made.is_open = this.search.value === "" ? !element.open : made.is_open;
    });
    return made;
  }

  #filter(): void {
    const text = this.search.value.trim();
    let any = false;
    for (const {group, element, rows, is_open, is_extra} of this.#groups) {
      let hits = 0;
      for (const row of rows) {
        const about = this.#context.edits.registry[row.parameter]!;
        const hit = text === "" || (!is_extra && matches(about, group.title, text));
        row.element.hidden = !hit;
        hits += hit ? 1 : 0;
      }
      element.hidden = hits === 0;
      element.open = text !== "" || is_open;
      any = any || hits > 0;
    }
    this.nothing_found.hidden = any || this.#groups.length === 0;
  }
}
