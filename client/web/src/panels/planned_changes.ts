// PlannedChanges: the changes of parameters that are planned, by users or by the schedule of the world.
import type {ParameterAssignment, PlannedChange, ScheduledValue} from "../core/protocol";
import {common_texts} from "../texts/common";
import {planned_texts as texts} from "../texts/parameters";
import {parameter_labels} from "../texts/registry";
import {actor_text} from "../texts/users";
import {h, set_text} from "../widgets/dom";
import {button} from "../widgets/form";
import {when_text} from "../world/parameter_edits";
import {value_text} from "../world/parameter_values";

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
    set_text(this.#title, texts.title(count));
    const described = JSON.stringify([why_not, planned, schedule]);
    if (this.#described !== described) {
      this.#described = described;
      this.#list.replaceChildren(
        ...planned.map((change) => this.#planned(change, why_not)),
        ...schedule.map((one) => h("li", {}, h("span", {}, texts.scheduled(one.generation ?? 0, assigned(one))))));
    }
  }

  #planned(change: PlannedChange, why_not: string): HTMLElement {
    const text = texts.change(when_text(change), (change.parameters ?? []).map(assigned), actor_text(change.by));
    return h(
      "li", {}, h("span", {class: "grow"}, text),
      button(common_texts.cancel, () => this.#cancel(change), {disabled: why_not !== "", title: why_not || null}));
  }
}

function assigned({name, value}: ParameterAssignment|ScheduledValue): string {
  return `${parameter_labels[name ?? ""] ?? name} ${value_text(value ?? {})}`;
}
