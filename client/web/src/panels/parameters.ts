// Parameters panel: searches, edits, applies, plans and undoes the parameters of the shown world. The server's registry
// describes them.
//
// ParameterExchange has the edits and sends the requests, ParameterList shows the parameters. While the user edits, the
// server checks the edits with dry runs, so that a wrong value is marked before it is applied.
import {panels_texts} from "../texts/panels";
import {parameters_texts as texts, warning_text} from "../texts/parameters";
import {undo_texts} from "../texts/undo";
import {set_enabled} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {button, check, row} from "../widgets/form";
import type {Panel, PanelContext} from "../world/panel_context";
import {undo} from "../world/undo_command";

import {ParameterExchange} from "./parameter_exchange";
import {ParameterList} from "./parameter_list";
import {ParameterWhen} from "./parameter_when";
import {PlannedChanges} from "./planned_changes";

export class ParametersPanel implements Panel {
  readonly name = "parameters";
  readonly title = panels_texts.parameters;
  readonly element: HTMLElement;

  readonly #context: PanelContext;
  readonly #exchange: ParameterExchange;
  readonly #list: ParameterList;
  readonly #when: ParameterWhen;
  readonly #planned: PlannedChanges;
  readonly #apply_button = button(texts.apply, () => this.#apply(), {class: "button button-primary"});
  readonly #discard_button =
    button(texts.discard, () => this.#discard(), {title: texts.discard_help});
  readonly #undo_button = button(undo_texts.undo, () => void undo(this.#context, "undo"));
  readonly #redo_button = button(undo_texts.redo, () => void undo(this.#context, "redo"));
  readonly #at_once = h("input", {type: "checkbox", onchange: () => this.touch()});
  readonly #reason = h("p", {class: "warning"});
  readonly #warnings = h("p", {class: "warning lines", role: "status"});
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
      h("div", {class: "panel parameters"},
        h("div", {class: "parameters-head"}, this.#list.search,
          row(this.#apply_button, this.#when.element, this.#discard_button, this.#undo_button, this.#redo_button,
            check(this.#at_once, texts.at_once, texts.at_once_help)),
          this.#problem, this.#reason, this.#warnings, this.#status),
        this.#planned.element, this.#list.element, this.#list.nothing_found);
    context.server.events.listen((event) => {
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

  // ---- RowContext ----

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

  // ---- actions ----

  #apply(): void {
    if (this.edits.busy) {
      this.#exchange.apply_afterwards();
      return;
    }
    const wrong = this.#list.wrong_row(), when = this.#when.chosen();
    if (wrong !== undefined) {
      this.#context.notify(texts.typing_is_wrong, () => this.#list.wrong_row() !== undefined);
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

  // ---- what is shown ----

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
    const apply_help = why_not || (count === 0 ? texts.no_edits : plans ? texts.plan_help : texts.apply_help);
    set_text(this.#reason, why_not);
    set_text(this.#apply_button, plans ? texts.plan : texts.apply);
    set_enabled(this.#apply_button, may && count > 0 && !edits.busy, apply_help);
    set_enabled(this.#discard_button, (count > 0 || this.#list.wrong_row() !== undefined) && !edits.busy);
    set_enabled(this.#at_once, may && !plans);
    if (plans) {
      this.#at_once.checked = false;
    }
    this.#when.update(may);
    set_text(this.#problem, edits.problem === "" ? "" : `${edits.problem}.`);
    set_text(this.#warnings, warning_text(edits.warnings));
    set_text(
      this.#status,
      why_not       ? "" :
        !edits.known ? texts.loading :
        edits.busy  ? texts.sending :
        count === 0 ? texts.revision(edits.revision) :
                      texts.edits(count));
    this.#planned.update(edits.planned, edits.schedule, may ? "" : why_not || texts.loading);
    if (edits.known) {
      this.#list.update(may);
    }
    this.#list.element.hidden = !edits.known;
  }
}
