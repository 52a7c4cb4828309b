// Parameters panel: searches, edits, applies, plans and undoes the parameters of the viewed world. The server's registry describes them.
//
// ParameterEdits stores the edits and the server's answers. The panel shows them and sends the requests. While the user edits, the server
// checks the edits with dry runs, so that a wrong value is marked before it is applied.
import {with_separators} from "../texts/numbers";
import {h, set_text} from "../widgets/dom";
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
  ParameterEdits,
  share_of,
  stepped,
  typed_number,
  unit_text,
  value_of,
  value_text,
  when_text,
} from "../world/parameter_edits";

import type {ParameterGroup, ParameterValue, When} from "../world/parameter_edits";
import {Refusal} from "../world/server";
import {actor_text} from "../texts/texts";
import type {Message} from "../core/messages";
import type {Panel, PanelContext} from "../world/panel_context";

const check_delay_ms = 400; // after the last edit, before a dry run
const slider_places = 1000;
const ticks_ahead = 1000; // of the tick that the field of a planned change suggests

const effects: {[effect: string]: {word: string; sentence: string}} = {
  PARAMETER_EFFECT_NEXT_TICK:
    {word: "now", sentence: "Takes effect at the next tick; breeding parameters, at the next breeding."},
  PARAMETER_EFFECT_NEXT_GENERATION: {word: "next gen.", sentence: "Takes effect with the next generation."},
  PARAMETER_EFFECT_RESET: {word: "reset", sentence: "Takes effect when the world is reset."},
};

interface Group {
  group: ParameterGroup;
  element: HTMLDetailsElement;
  rows: Row[];
  is_open: boolean; // as the user left it
}

export class ParametersPanel implements Panel {
  readonly name = "parameters";
  readonly title = "Parameters";
  readonly element: HTMLElement;
  readonly edits = new ParameterEdits();
  /** Why the values cannot be changed now; empty if they can. */
  why_not = "";

  #world = ""; // the followed world and run
  #run_id = "";
  #set: Message|null = null; // the ParameterSet that was taken last
  #transaction = 0; // answers to earlier transactions are ignored
  #groups: Group[] = [];
  #apply_again = false; // an edit was made while a transaction was pending
  #check_timer = 0;
  #changed = true; // the elements do not show the present state yet
  readonly #apply_button =
    h("button", {class: "button button-primary", type: "button", onclick: () => this.#apply()}, "Apply");
  readonly #discard_button =
    h("button", {class: "button", type: "button", title: "Removes all edits.", onclick: () => this.#discard()},
      "Discard");
  readonly #undo_button =
    h("button", {
      class: "button",
      type: "button",
      title: "Ctrl+Z: restores the values before your last change, except values that others have changed since.",
      onclick: () => this.#undo(false),
    },
      "Undo");
  readonly #redo_button =
    h("button", {
      class: "button",
      type: "button",
      title: "Ctrl+Shift+Z: applies the last undone change again.",
      onclick: () => this.#undo(true)
    },
      "Redo");
  readonly #at_once = h("input", {type: "checkbox", onchange: () => this.touch()});
  readonly #when =
    h("select", {class: "field", "aria-label": "When the edits are applied", onchange: () => this.#choose_when()},
      h("option", {value: "now"}, "now"), h("option", {value: "generation"}, "in generation"),
      h("option", {value: "tick"}, "after tick"));
  readonly #when_number = h("input", {
    class: "field parameters-when",
    inputmode: "numeric",
    "aria-label": "generation or tick",
    hidden: true,
    oninput: () => this.touch()
  });
  readonly #when_row = h("label", {class: "row"}, h("span", {}, "Apply"), this.#when, this.#when_number);
  readonly #reason = h("p", {class: "warning"});
  readonly #problem = h("p", {class: "error", role: "alert"});
  readonly #status = h("p", {class: "hint", role: "status"});
  readonly #search = h("input", {
    class: "field",
    type: "search",
    placeholder: "search in names, groups and descriptions",
    "aria-label": "Search parameters",
    oninput: () => this.#filter()
  });
  readonly #planned_list = h("ul", {class: "parameters-planned-list"});
  readonly #planned_title = h("summary", {});
  readonly #planned =
    h("details", {class: "parameters-planned", hidden: true}, this.#planned_title, this.#planned_list);
  readonly #list = h("div", {class: "parameters-list"});
  readonly #nothing = h("p", {class: "hint", hidden: true}, "No parameter matches.");

  readonly #context: PanelContext;

  constructor(context: PanelContext) {
    this.#context = context;
    this.element =
      h("div", {class: "panel parameters", onkeydown: (event: KeyboardEvent) => this.#key_down(event)}, this.#reason,
        h("div", {class: "parameters-head"},
          h("div", {class: "row"}, this.#apply_button, this.#discard_button, this.#undo_button, this.#redo_button),
          this.#problem, this.#status),
        h("div", {class: "row"}, this.#when_row,
          h("label", {class: "check", title: "Applies each change as soon as you make it."}, this.#at_once,
            "apply at once")),
        this.#planned, this.#search, this.#list, this.#nothing);
    context.server.on_event((event) => this.#take_event(event));
  }

  refresh(): void {
    this.#follow();
    const why_not = this.#find_why_not();
    if (this.#changed || why_not !== this.why_not) {
      this.#changed = false;
      this.why_not = why_not;
      this.#update();
    }
  }

  /** subject: {search: "mutation"} */
  show(subject: {[key: string]: unknown}): void {
    if (typeof subject.search === "string") {
      this.#search.value = subject.search;
      this.#filter();
    }
  }

  /** Makes the elements show the present state, and asks the server to check the edits. */
  touch(): void {
    this.#changed = true;
    this.refresh();
    clearTimeout(this.#check_timer);
    if (this.edits.edit_count > 0 && !this.#at_once.checked) {
      this.#check_timer = window.setTimeout(() => void this.#check(), check_delay_ms);
    }
  }

  /** The user has set a value: with "apply at once" it is sent. */
  released(): void {
    if (this.#at_once.checked && this.edits.edit_count > 0) {
      this.#apply();
    }
  }

  #key_down(event: KeyboardEvent): void {
    const key = event.key.toLowerCase();
    const in_text =
      event.target instanceof HTMLInputElement && event.target.type !== "range" && event.target.type !== "checkbox";
    if (in_text || !(event.ctrlKey || event.metaKey) || event.altKey || (key !== "z" && key !== "y")) {
      return; // a text field undoes its own changes
    }
    event.preventDefault();
    event.stopPropagation();
    if (this.why_not === "") {
      this.#undo(key === "y" || event.shiftKey);
    }
  }

  // ---- exchange with the server ----

  #follow(): void {
    const {server} = this.#context, world = this.#context.world();
    if (server.parameters !== this.edits.registry && server.parameters.length > 0) {
      this.edits.describe(server.parameters);
      this.#build_list();
      this.#forget();
    }
    const run_id: string = world.info?.run_id ?? "";
    if (world.shown !== this.#world || run_id !== this.#run_id) {
      this.#world = world.shown;
      this.#run_id = run_id;
      this.#forget();
    }
    if (world.parameters.set !== null && world.parameters.set !== this.#set && this.edits.registry.length > 0) {
      this.#set = world.parameters.set;
      this.edits.update_all(this.#set);
      this.#changed = true;
    }
  }

  #forget(): void {
    this.edits.forget();
    this.#set = null;
    this.#transaction += 1;
    this.#apply_again = false;
    this.#groups.forEach((group) => group.rows.forEach((row) => row.forget()));
    this.#changed = true;
  }

  #find_why_not(): string {
    const {server} = this.#context, world = this.#context.world();
    if (world.is_replay) {
      return "This world is a replay and cannot be changed.";
    }
    return server.why_not("set_parameters", world.shown);
  }

  #take_event(event: Message): void {
    if (event.world === this.#world && event.run_id === this.#run_id && event.parameters_changed && this.edits.known) {
      if (!this.edits.update_changed(event.parameters_changed)) {
        void this.#read();
      }
      this.#changed = true;
    }
  }

  /** Requests the complete set. */
  async #read(): Promise<void> {
    const world = this.#world, transaction = this.#transaction;
    try {
      const set = await this.#context.server.request("get_parameters", {world});
      if (world === this.#world && transaction === this.#transaction) {
        this.edits.update_all(set);
        this.#changed = true;
        this.refresh();
      }
    } catch {
      // The session ended: the next one reads the parameters.
    }
  }

  async #check(): Promise<void> {
    const when = this.#chosen_when();
    const check = this.why_not === "" && typeof when !== "string" ? this.edits.check(this.#world, when) : null;
    if (check === null) {
      return;
    }
    let refusal: Refusal|null = null;
    try {
      await this.#context.server.request("set_parameters", check.fields);
    } catch (error) {
      refusal = error as Refusal;
    }
    this.edits.checked(check.number, refusal);
    this.#changed = true;
    this.refresh();
  }

  #apply(): void {
    if (this.edits.busy) {
      this.#apply_again = true;
      return;
    }
    const wrong = this.#groups.flatMap((group) => group.rows).find((row) => row.typing_problem !== "");
    if (wrong !== undefined) {
      this.#context.notify("Nothing was sent: see the marked parameter.");
      wrong.focus();
      return;
    }
    const when = this.#chosen_when();
    if (typeof when === "string") {
      this.edits.problem = when;
      this.touch();
      return;
    }
    void this.#send(this.edits.apply(this.#world, when));
  }

  #undo(redo: boolean): void {
    void this.#send(redo ? this.edits.redo(this.#world) : this.edits.undo(this.#world));
  }

  #discard(): void {
    this.edits.revert_all();
    this.#groups.forEach((group) => group.rows.forEach((row) => row.forget()));
    this.touch();
  }

  async #send(fields: Message|null): Promise<void> {
    clearTimeout(this.#check_timer);
    const transaction = this.#transaction;
    this.#changed = true;
    this.refresh();
    if (fields === null) {
      return;
    }
    let stale = false;
    try {
      const response = await this.#context.server.respond("set_parameters", fields);
      if (transaction !== this.#transaction) {
        return;
      }
      stale = this.edits.answered({set: response.parameters ?? null});
      const count = (fields.parameters as Message[]).length, what = count === 1 ? "1 change" : `${count} changes`;
      this.#context.notify(
        response.planned_change ? `Planned ${what} ${when_text(response.planned_change)}.` :
                                  `Applied ${what} from tick ${with_separators(response.applied_tick ?? 0)}.`);
    } catch (error) {
      if (transaction !== this.#transaction) {
        return;
      }
      stale = this.edits.answered(error instanceof Refusal && error.code !== "" ? {refusal: error} : {lost: true});
      this.#open_violations();
    }
    if (stale) {
      void this.#read();
    }
    this.#changed = true;
    this.refresh();
    if (this.#apply_again) {
      this.#apply_again = false;
      this.released();
    }
  }

  async #cancel(change: Message): Promise<void> {
    const world = this.#world;
    if (await this.#context.attempt(() => this.#context.server.request("cancel_change", {world, id: change.id}))) {
      await this.#read();
    }
  }

  // ---- when ----

  #choose_when(): void {
    const kind = this.#when.value, world = this.#context.world();
    this.#when_number.hidden = kind === "now";
    this.#when_number.value = String(
      kind === "generation" ? Number(world.snapshot?.generation ?? world.info?.generation ?? 1) + 1 :
                              world.feed.tick + ticks_ahead);
    this.touch();
  }

  /** Returns when the edits are applied; a sentence if the number is not one. */
  #chosen_when(): When|string {
    const kind = this.#when.value;
    if (kind === "now") {
      return null;
    }
    const text = this.#when_number.value.replace(/,/g, "").trim();
    const number = /^\d{1,15}$/.test(text) ? Number(text) : NaN;
    if (!(number >= 1)) {
      return `${kind}: got "${this.#when_number.value}", allowed whole numbers from 1`;
    }
    return kind === "generation" ? {generation: number} : {tick: number};
  }

  // ---- elements ----

  #build_list(): void {
    const registry = this.edits.registry;
    this.#groups =
      [most_used(registry), ...grouped(registry)].filter((group) => group.members.length > 0).map((group) => {
        const rows = group.members.map((i) => new Row(this, i, `${plain_id(group.title)}-${registry[i]!.name}`));
        const element =
          h("details", {class: "parameters-group", open: true}, h("summary", {}, group.title),
            ...rows.map((row) => row.element));
        const made: Group = {group, element, rows, is_open: true};
        element.querySelector("summary")!.addEventListener("click", () => {
          made.is_open = this.#search.value === "" ? !element.open : made.is_open;
        });
        return made;
      });
    this.#list.replaceChildren(...this.#groups.map((group) => group.element));
    this.#filter();
  }

  #filter(): void {
    const text = this.#search.value.trim();
    let any = false;
    this.#groups.forEach(({group, element, rows, is_open}, number) => {
      const is_extra = number === 0; // its parameters also belong to other groups
      let hits = 0;
      for (const row of rows) {
        const hit = text === "" || (!is_extra && matches(this.edits.registry[row.parameter]!, group.title, text));
        row.element.hidden = !hit;
        hits += hit ? 1 : 0;
      }
      element.hidden = hits === 0;
      element.open = text !== "" || is_open;
      any = any || hits > 0;
    });
    this.#nothing.hidden = any || this.#groups.length === 0;
  }

  /** Opens the groups with rejected values, and scrolls to the first one. */
  #open_violations(): void {
    const rejected = this.#groups.slice(1)
                       .flatMap((group) => group.rows.map((row) => ({group, row})))
                       .filter(({row}) => this.edits.violation(row.parameter) !== null);
    for (const {group, row} of rejected) {
      group.element.hidden = row.element.hidden = false;
      group.element.open = true;
    }
    rejected[0]?.row.element.scrollIntoView({block: "nearest"});
  }

  #update(): void {
    const edits = this.edits;
    const may = this.why_not === "" && edits.known, count = edits.edit_count;
    const plans = this.#when.value !== "now";
    const is_typing = this.#groups.some((group) => group.rows.some((row) => row.typing_problem !== ""));
    set_text(this.#reason, this.why_not);
    set_text(this.#apply_button, plans ? "Plan" : "Apply");
    set_enabled(
      this.#apply_button, may && count > 0 && !edits.busy,
      this.why_not ||
        (count === 0 ? "There are no edits." :
           plans     ? "Sends all edits as one change, which the server applies later." :
                       "Sends all edits as one change: the server accepts all of them or none."));
    set_enabled(this.#discard_button, (count > 0 || is_typing) && !edits.busy);
    set_enabled(this.#undo_button, may && edits.can_undo);
    set_enabled(this.#redo_button, may && edits.can_redo);
    set_enabled(this.#at_once, may && !plans);
    set_enabled(this.#when, may);
    set_enabled(this.#when_number, may);
    this.#when_row.hidden = !this.#context.server.features.has("planned_changes");
    if (plans) {
      this.#at_once.checked = false;
    }
    set_text(this.#problem, edits.problem === "" ? "" : `${edits.problem}.`);
    set_text(
      this.#status,
      !edits.known  ? "Loading the parameters …" :
        edits.busy  ? "Sending …" :
        count === 0 ? `Revision ${with_separators(edits.revision)}; no edits` :
                      `${with_separators(count)} ${count === 1 ? "edit" : "edits"} not applied yet`);
    this.#update_planned(may);
    if (edits.known) {
      this.#groups.forEach((group) => group.rows.forEach((row) => row.update(may)));
    }
    this.#list.hidden = !edits.known;
  }

  #update_planned(may: boolean): void {
    const {planned, schedule} = this.edits;
    this.#planned.hidden = planned.length + schedule.length === 0;
    set_text(this.#planned_title, `Planned changes (${with_separators(planned.length + schedule.length)})`);
    const one_text = (one: Message): string => `${one.name} ${value_text(one.value ?? {})}`;
    const described =
      JSON.stringify([may, planned, schedule], (_, value) => (typeof value === "bigint" ? String(value) : value));
    if (this.#planned_list.dataset.of !== described) {
      this.#planned_list.dataset.of = described;
      this.#planned_list.replaceChildren(
        ...planned.map(
          (change) =>
            h("li", {},
              h("span", {class: "grow"},
                `${when_text(change)}: ${(change.parameters as Message[] ?? []).map(one_text).join(", ")} by ${
                  actor_text(change.by)}`),
              h("button", {
                class: "button",
                type: "button",
                disabled: !may,
                title: may ? null : this.why_not,
                onclick: () => void this.#cancel(change)
              },
                "Cancel"))),
        ...schedule.map(
          (one) => h(
            "li", {},
            h("span", {}, `in generation ${with_separators(one.generation ?? 0)}: ${one_text(one)} by the schedule`))));
    }
  }
}

function plain_id(text: string): string {
  return text.toLowerCase().replace(/[^a-z]+/g, "-");
}

function set_enabled(
  control: HTMLButtonElement|HTMLInputElement|HTMLSelectElement, enabled: boolean, title?: string): void {
  control.disabled = !enabled;
  if (title !== undefined && control.title !== title) {
    control.title = title;
  }
}

/** One parameter of the list: name with unit and remarks, value, effect; below them the slider. */
class Row {
  readonly element: HTMLElement;
  /** Why the typed text is no value; empty if it is one. */
  typing_problem = "";
  readonly #about: Message;
  readonly #label = h("span", {class: "parameter-label"});
  readonly #mark = h("span", {class: "parameter-mark", title: "This is not the default value."});
  readonly #toggle =
    h("button", {class: "parameter-name", type: "button", "aria-expanded": "false", onclick: () => this.#toggle_help()},
      this.#label, this.#mark);
  readonly #remarks = h("span", {class: "parameter-remarks"});
  readonly #refused = h("p", {class: "error parameter-wide"});
  readonly #help = h("div", {class: "parameter-help parameter-wide", hidden: true});
  readonly #default_button: HTMLButtonElement;
  readonly #slider: HTMLInputElement|null = null;
  readonly #field: HTMLInputElement|null = null; // of a number
  readonly #flag: HTMLInputElement|null = null;
  readonly #choice: HTMLSelectElement|null = null;
  #dragging = false; // the user holds the slider
  #typing = false; // the text of the field is not finished
  #described = ""; // what the help shows

  readonly #panel: ParametersPanel;

  constructor(panel: ParametersPanel, readonly parameter: number, id: string) {
    this.#panel = panel;
    const about = this.#about = panel.edits.registry[parameter]!;
    this.#label.textContent = label_of(about);
    this.#label.id = `label-${id}`;
    this.#remarks.id = `remarks-${id}`;
    this.#refused.id = `refused-${id}`;
    const named = {
      "aria-labelledby": this.#label.id,
      "aria-describedby": `${this.#remarks.id} ${this.#refused.id}`,
      "data-parameter": about.name
    };
    const value = h("div", {class: "parameter-value"});
    if (is_number(about)) {
      this.#slider = h("input", {
        class: "parameter-slider",
        type: "range",
        min: 0,
        max: slider_places,
        ...named,
        oninput: () => this.#slide(),
        onchange: () => this.#release(),
        onkeydown: (event: KeyboardEvent) => this.#step(event, true),
      });
      this.#field = h("input", {
        class: "field",
        type: "text",
        inputmode: "decimal",
        autocomplete: "off",
        ...named,
        oninput: () => this.#type(),
        onchange: () => this.#typed(),
        onblur: () => this.#typed(),
        onkeydown: (event: KeyboardEvent) => this.#step(event, false),
      });
      value.append(this.#field);
    } else if (about.kind === "PARAMETER_KIND_FLAG") {
      this.#flag = h("input", {type: "checkbox", ...named, onchange: () => this.#set({flag: this.#flag!.checked})});
      value.append(this.#flag);
    } else {
      this.#choice =
        h("select", {class: "field", ...named, onchange: () => this.#set({choice: this.#choice!.value})},
          ...(about.choices as string[] ?? [])
            .map(
              (choice, n) =>
                h("option", {value: choice, title: about.choice_help?.[n] ?? null}, label_of_choice(choice))));
      value.append(this.#choice);
    }
    this.#default_button =
      h("button", {
        class: "parameter-default",
        type: "button",
        title: `Default: ${value_text(about.default_value ?? {})}`,
        "aria-label": `Set ${label_of(about)} to its default ${value_text(about.default_value ?? {})}`,
        onclick: () => this.#set(about.default_value ?? {}),
      },
        "default");
    const effect = effects[about.effect] ?? {word: "", sentence: ""};
    this.#toggle.title = `${about.name}\n${about.help ?? ""}`;
    this.element =
      h("div", {class: "parameter", "data-name": about.name}, h("div", {}, this.#toggle, this.#remarks), value,
        h("div", {class: "parameter-effect"},
          h("span", {class: effect.word === "now" ? "parameter-now" : null, title: effect.sentence}, effect.word),
          this.#default_button),
        this.#slider, this.#refused, this.#help);
  }

  /** Shows the present state. */
  update(may: boolean): void {
    const {edits} = this.#panel, i = this.parameter;
    const shown = edits.shown(i), violation = edits.violation(i);
    const title = may ? "" : this.#panel.why_not;
    for (const control of [this.#slider, this.#field, this.#flag, this.#choice]) {
      if (control !== null) {
        set_enabled(control, may, title);
        control.setAttribute("aria-invalid", String(violation !== null || this.typing_problem !== ""));
      }
    }
    if (this.#slider !== null && this.#field !== null) {
      const number = number_of(shown), unit = unit_text(this.#about, number);
      if (!this.#dragging) {
        this.#slider.value = String(Math.round(share_of(this.#about, number) * slider_places));
      }
      this.#slider.setAttribute("aria-valuetext", `${value_text(shown)} ${unit}`.trim());
      if (!this.#typing && this.typing_problem === "") {
        set_value(this.#field, value_text(shown));
      }
    } else if (this.#flag !== null) {
      this.#flag.checked = shown.flag === true;
    } else if (this.#choice !== null) {
      set_value(this.#choice, shown.choice ?? "");
    }
    this.element.classList.toggle("parameter-edited", edits.is_edited(i));
    this.element.classList.toggle("parameter-refused", violation !== null || this.typing_problem !== "");
    const is_default = edits.is_default(i);
    set_text(this.#mark, is_default ? "" : " •");
    this.#default_button.hidden = is_default || !may;
    const client = edits.client_of_last_change(i), planned = edits.planned_values(i);
    set_text(
      this.#remarks,
      [
        this.#unit(shown),
        edits.is_edited(i) ? `was ${value_text(edits.requested_value(i))}` :
          edits.is_pending(i) ? `still ${value_text(edits.current_value(i))}` :
                                "",
        client === "" ? "" : `set by ${client}`,
        planned.length === 0 ? "" :
                               `planned: ${planned[0]}${planned.length > 1 ? ` and ${planned.length - 1} more` : ""}`,
      ].filter((part) => part !== "")
        .join(" · "));
    set_text(
      this.#refused,
      this.typing_problem !== "" ? this.typing_problem :
        violation === null       ? "" :
                                   `${violation.got === "" ? "" : `got ${violation.got}, `      }allowed ${violation.allowed}`);
    this.#update_help();
  }

  /** Forgets a text that was typed but is no value. */
  forget(): void {
    this.#typing = this.#dragging = false;
    this.typing_problem = "";
  }

  focus(): void {
    this.element.closest("details")!.open = true;
    this.element.hidden = false;
    (this.#field ?? this.#flag ?? this.#choice)?.focus();
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
    const {edits} = this.#panel, about = this.#about, i = this.parameter;
    const unit = about.unit ? ` ${about.unit}` : "";
    const now = value_text(edits.current_value(i)) +
      (edits.is_pending(i) ? `, then ${value_text(edits.requested_value(i))}` : "");
    const facts =
      `Allowed: ${allowed_text(about)}${unit}. Default: ${value_text(about.default_value ?? {})}. Now: ${now}.`;
    if (this.#described !== facts) {
      this.#described = facts;
      const choices =
        (about.choices as string[] ?? []).flatMap((choice, n) => (about.choice_help?.[n] === undefined ? [] : [
                                                    h("li", {}, h("b", {}, label_of_choice(choice)),
                                                      `: ${about.choice_help[n]}`)
                                                  ]));
      this.#help.replaceChildren(
        h("p", {}, h("code", {}, about.name)), h("p", {}, about.help ?? ""),
        choices.length > 0 && h("ul", {}, ...choices) || "", h("p", {}, facts),
        h("p", {}, effects[about.effect]?.sentence ?? ""));
    }
  }

  // ---- input ----

  #edit(value: ParameterValue): void {
    this.typing_problem = "";
    this.#panel.edits.edit(this.parameter, value);
    this.#panel.touch();
  }

  #set(value: ParameterValue): void {
    this.#typing = false;
    this.#edit(value);
    this.#panel.released();
  }

  #slide(): void {
    this.#dragging = true;
    this.#edit(value_of(this.#about, number_at(this.#about, Number(this.#slider!.value) / slider_places)));
  }

  #release(): void {
    this.#dragging = false;
    this.#panel.touch();
    this.#panel.released();
  }

  #type(): void {
    this.#typing = true;
    const number = typed_number(this.#about, this.#field!.value);
    if (number !== null) {
      this.#edit(value_of(this.#about, number));
      return;
    }
    this.typing_problem = `got "${this.#field!.value}", allowed ${
      this.#about.kind === "PARAMETER_KIND_COUNT" ? "whole numbers from " : ""}${allowed_text(this.#about)}`;
    this.#panel.touch();
  }

  /** The user has left the field or pressed Enter. */
  #typed(): void {
    if (!this.#typing) {
      return;
    }
    this.#typing = false;
    if (this.#field!.value.trim() === "") { // an emptied field returns to the value
      this.typing_problem = "";
      this.#panel.edits.revert(this.parameter);
    }
    this.#panel.touch();
    if (this.typing_problem === "") {
      this.#panel.released();
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
      this.#panel.edits.revert(this.parameter);
      this.#panel.touch();
      return;
    }
    const up = event.key === "ArrowUp" || event.key === "PageUp" || (is_slider && event.key === "ArrowRight");
    const down = event.key === "ArrowDown" || event.key === "PageDown" || (is_slider && event.key === "ArrowLeft");
    if (up || down) {
      event.preventDefault();
      event.stopPropagation();
      const number = number_of(this.#panel.edits.shown(this.parameter));
      this.#set(value_of(this.#about, stepped(this.#about, number, up, event.key.startsWith("Page"))));
    }
  }
}

function set_value(control: HTMLInputElement|HTMLSelectElement, value: string): void {
  if (control.value !== value) {
    control.value = value;
  }
}
