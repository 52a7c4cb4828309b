// Parameters panel: searches, edits, applies, plans and undoes the parameters of the shown world. The server's registry
// describes them.
//
// ParameterExchange has the edits and sends the requests, ParameterList shows the parameters. While the user edits, the
// server checks the edits with dry runs, so that a wrong value is marked before it is applied.
import type {ParameterAssignment, PlannedChange, ScheduledValue} from "../core/protocol";
import {common_texts} from "../texts/common";
import {parameters_texts, planned_texts, when_texts as texts} from "../texts/parameters";
import {undo_texts} from "../texts/undo";
import {actor_text} from "../texts/users";
import {set_enabled} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {button, check, row} from "../widgets/form";
import type {Panel, PanelContext} from "../world/panel_context";
import {type When, when_text} from "../world/parameter_edits";
import {value_text} from "../world/parameters";
import {undo} from "../world/undo";
import {ParameterExchange} from "./parameter_exchange";
import {ParameterList} from "./parameter_list";

const ticks_ahead = 1000; // of the tick that the field suggests

/** When the edits are applied: now, in a generation, or after a tick. */
export class ParameterWhen {
  readonly element: HTMLElement;

  readonly #context: PanelContext;
  readonly #on_change: () => void;
  readonly #kind =
    h("select", {class: "field", "aria-label": texts.choice, onchange: () => this.#choose()},
      h("option", {value: "now"}, texts.now), h("option", {value: "generation"}, texts.in_generation),
      h("option", {value: "tick"}, texts.after_tick));
  readonly #number = h("input", {
    class: "field parameters-when",
    inputmode: "numeric",
    "aria-label": texts.number,
    hidden: true,
    oninput: () => this.#on_change()
  });

  constructor(context: PanelContext, on_change: () => void) {
    this.#context = context;
    this.#on_change = on_change;
    this.element = h("label", {class: "row"}, h("span", {}, texts.label), this.#kind, this.#number);
  }

  /** Whether the edits are planned rather than applied now. */
  get plans(): boolean {
    return this.#kind.value !== "now";
  }

  /** Returns when the edits are applied; a sentence if the number is not one. */
  chosen(): When|string {
    const kind = this.#kind.value;
    if (kind === "now") {
      return null;
    }
    const text = this.#number.value.replace(/,/g, "").trim();
    const number = /^\d{1,15}$/.test(text) ? Number(text) : NaN;
    if (!(number >= 1)) {
      return texts.wrong(kind, this.#number.value);
    }
    return kind === "generation" ? {generation: number} : {tick: number};
  }

  update(may: boolean): void {
    set_enabled(this.#kind, may);
    set_enabled(this.#number, may);
    this.element.hidden = !this.#context.server.features.has("planned_changes");
  }

  #choose(): void {
    const kind = this.#kind.value, world = this.#context.world();
    this.#number.hidden = kind === "now";
    const generation = world.snapshot?.generation ?? world.info?.generation ?? 1;
    this.#number.value = String(kind === "generation" ? generation + 1 : world.feed.tick + ticks_ahead);
    this.#on_change();
  }
}

/** The changes of parameters that are planned, by users or by the schedule of the world. */
export class PlannedChanges {
  readonly element: HTMLElement;
  readonly #title = h("summary", {});
  readonly #list = h("ul", {class: "parameters-planned-list"});
  readonly #cancel: (change: PlannedChange) => void;
  #described = ""; // what the list shows

  constructor(cancel: (change: PlannedChange) => void) {
    this.#cancel = cancel;
    this.element = h("details", {class: "parameters-planned", hidden: true}, this.#title, this.#list);
  }

  /** why_not  why the changes cannot be cancelled; empty if they can */
  update(planned: readonly PlannedChange[], schedule: readonly ScheduledValue[], why_not: string): void {
    const count = planned.length + schedule.length;
    this.element.hidden = count === 0;
    set_text(this.#title, planned_texts.title(count));
    const described = JSON.stringify([why_not, planned, schedule]);
    if (this.#described !== described) {
      this.#described = described;
      this.#list.replaceChildren(
        ...planned.map((change) => this.#planned(change, why_not)),
        ...schedule.map(
          (one) => h("li", {}, h("span", {}, planned_texts.scheduled(one.generation ?? 0, assigned(one))))));
    }
  }

  #planned(change: PlannedChange, why_not: string): HTMLElement {
    const text =
      planned_texts.change(when_text(change), (change.parameters ?? []).map(assigned), actor_text(change.by));
    return h(
      "li", {}, h("span", {class: "grow"}, text),
      button(common_texts.cancel, () => this.#cancel(change), {disabled: why_not !== "", title: why_not || null}));
  }
}

function assigned({name, value}: ParameterAssignment|ScheduledValue): string {
  return `${name} ${value_text(value ?? {})}`;
}

export class ParametersPanel implements Panel {
  readonly name = "parameters";
  readonly title = parameters_texts.title;
  readonly element: HTMLElement;

  readonly #context: PanelContext;
  readonly #exchange: ParameterExchange;
  readonly #list: ParameterList;
  readonly #when: ParameterWhen;
  readonly #planned: PlannedChanges;
  readonly #apply_button = button(parameters_texts.apply, () => this.#apply(), {class: "button button-primary"});
  readonly #discard_button =
    button(parameters_texts.discard, () => this.#discard(), {title: parameters_texts.discard_help});
  readonly #undo_button = button(undo_texts.undo, () => void undo(this.#context, "undo"));
  readonly #redo_button = button(undo_texts.redo, () => void undo(this.#context, "redo"));
  readonly #at_once = h("input", {type: "checkbox", onchange: () => this.touch()});
  readonly #reason = h("p", {class: "warning"});
  readonly #problem = h("p", {class: "error", role: "alert"});
  readonly #status = h("p", {class: "hint", role: "status"});
  #changed = true; // the elements do not show the present state yet

  constructor(context: PanelContext) {
    this.#context = context;
    this.#exchange = new ParameterExchange(context, {
      described: () => this.#list.build(),
      forgotten: () => this.#list.forget(),
      answered: () => this.#show_changes(),
      refused: () => this.#list.open_violations(),
      edited_since: () => this.released(),
    });
    this.#list = new ParameterList(this);
    this.#when = new ParameterWhen(context, () => this.touch());
    this.#planned = new PlannedChanges((change) => void this.#exchange.cancel(change));
    this.element =
      h("div", {class: "panel parameters"}, this.#reason,
        h("div", {class: "parameters-head"},
          row(this.#apply_button, this.#discard_button, this.#undo_button, this.#redo_button), this.#problem,
          this.#status),
        row(this.#when.element, check(this.#at_once, parameters_texts.at_once, parameters_texts.at_once_help)),
        this.#planned.element, this.#list.search, this.#list.element, this.#list.nothing_found);
    context.server.on_event((event) => {
      this.#changed = this.#exchange.take_event(event) || this.#changed;
    });
  }

  refresh(): void {
    this.#changed = this.#exchange.follow() || this.#changed;
    if (this.#changed) {
      this.#changed = false;
      this.#update();
    }
    this.#update_undo();
  }

  /** subject: {search: "mutation"} */
  show(subject: {[key: string]: unknown}): void {
    if (typeof subject.search === "string") {
      this.#list.search_for(subject.search);
    }
  }

  get edits(): ParameterExchange["edits"] {
    return this.#exchange.edits;
  }

  get why_not(): string {
    return this.#exchange.why_not;
  }

  touch(): void {
    this.#show_changes();
    if (this.#at_once.checked) {
      this.#exchange.stop_checking();
    } else {
      this.#exchange.check_soon(() => this.#when.chosen());
    }
  }

  released(): void {
    if (this.#at_once.checked && this.edits.edit_count > 0) {
      this.#apply();
    }
  }

  #apply(): void {
    if (this.edits.busy) {
      this.#exchange.apply_afterwards();
      return;
    }
    const wrong = this.#list.wrong_row(), when = this.#when.chosen();
    if (wrong !== undefined) {
      this.#context.notify(parameters_texts.typing_is_wrong);
      wrong.focus();
    } else if (typeof when === "string") {
      this.edits.problem = when;
      this.touch();
    } else {
      this.#exchange.apply(when);
    }
  }

  #discard(): void {
    this.edits.revert();
    this.#list.forget();
    this.touch();
  }

  #show_changes(): void {
    this.#changed = true;
    this.refresh();
  }

  #update_undo(): void {
    const may = this.why_not === "" && this.edits.known && !this.edits.busy;
    const {next_undo, next_redo} = this.#context.world().undo;
    set_enabled(this.#undo_button, may && next_undo !== "", undo_texts.undo_help(next_undo));
    set_enabled(this.#redo_button, may && next_redo !== "", undo_texts.redo_help(next_redo));
  }

  #update(): void {
    const {edits, why_not} = this, {plans} = this.#when;
    const may = why_not === "" && edits.known, count = edits.edit_count;
    const apply_help = why_not ||
      (count === 0 ? parameters_texts.no_edits :
         plans     ? parameters_texts.plan_help :
                     parameters_texts.apply_help);
    set_text(this.#reason, why_not);
    set_text(this.#apply_button, plans ? parameters_texts.plan : parameters_texts.apply);
    set_enabled(this.#apply_button, may && count > 0 && !edits.busy, apply_help);
    set_enabled(this.#discard_button, (count > 0 || this.#list.wrong_row() !== undefined) && !edits.busy);
    set_enabled(this.#at_once, may && !plans);
    if (plans) {
      this.#at_once.checked = false;
    }
    this.#when.update(may);
    set_text(this.#problem, edits.problem === "" ? "" : `${edits.problem}.`);
    set_text(
      this.#status,
      !edits.known  ? parameters_texts.loading :
        edits.busy  ? parameters_texts.sending :
        count === 0 ? parameters_texts.revision(edits.revision) :
                      parameters_texts.edits(count));
    this.#planned.update(edits.planned, edits.schedule, may ? "" : why_not || parameters_texts.loading);
    if (edits.known) {
      this.#list.update(may);
    }
    this.#list.element.hidden = !edits.known;
  }
}
