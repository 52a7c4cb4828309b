// ParameterEdits: the parameters of a world, the edits that have not been sent, and transactions.
// Pure: no DOM.
//
// All parameters come from the server's registry, so a parameter that is added to the server appears here. Edits are
// collected and sent as one SetParameters request; the server applies all of them or none. The request contains the
// revision on which the edits are based. If another client has changed a parameter since, the server rejects the
// request. Undo sends another SetParameters request.
import type {
  ParameterAssignment, ParameterDescription, ParametersChanged, ParameterSet, ParameterState, ParameterValue,
  PlannedChange, ScheduledValue, SetParameters} from "../core/protocol";
import {parameter_words} from "../texts/parameter_words";
import {actor_text} from "../texts/users";

import {same, value_text} from "./parameter_values";

import type {Refusal, Violation} from "./server";

const field_prefix = "set_parameters.", revision_field = "expected_revision";

/** Why the server refused a request. */
type RefusalFacts = Pick<Refusal, "message"|"violations">;

/** When a change is made: at once, before the first tick of a generation, or right after a tick of the run. */
export type When = {
  generation: number
}|{tick: number}|null;

/** One parameter: what the server reports about it, and the edit that has not been sent. */
export class EditedParameter {
  value: ParameterValue; // the current one
  pending: ParameterValue|null = null;
  edit: ParameterValue|null = null;
  client_of_last_change = ""; // empty: no other client has changed it since the value was received or set here
  violation: Violation|null = null; // why the server rejected the value that was sent last; null if it accepted it

  /** about: of the registry; then with what differs in the world. */
  constructor(public about: ParameterDescription) {
    this.value = about.default_value ?? {};
  }

  /** The pending value; if there is none, the current value. */
  get requested(): ParameterValue {
    return this.pending ?? this.value;
  }

  /** The edited value; if there is none, the requested one. */
  get shown(): ParameterValue {
    return this.edit ?? this.requested;
  }

  get is_default(): boolean {
    return same(this.shown, this.about.default_value ?? {});
  }
}

export interface Change {
  parameter: EditedParameter;
  before: ParameterValue;
  after: ParameterValue;
}

export class ParameterEdits {
  /** Why the last transaction was refused; empty if it was accepted. A reason that concerns one parameter is its
   *  violation. */
  problem = "";
  /** What the server warned about when it checked the edits, as sentences. */
  warnings: readonly string[] = [];
  revision = 0; // 0: no set has been received
  registry: readonly ParameterDescription[] = [];
  parameters: EditedParameter[] = []; // in the order of the registry
  planned: PlannedChange[] = [];
  schedule: ScheduledValue[] = [];
  #index = new Map<string, number>();
  #sent: {changes: readonly Change[]; is_plan: boolean}|null = null;
  #edit_number = 0; // counts the changes of edits

  // ---- what the server reports ----

  /** Sets the registry and clears everything else. */
  describe(registry: readonly ParameterDescription[]): void {
    this.registry = registry;
    this.#index = new Map(registry.map((about, i) => [about.name ?? "", i]));
    this.forget();
  }

  /** Clears everything except the registry. Call when another world or run is shown. */
  forget(): void {
    this.parameters = this.registry.map((about) => new EditedParameter(about));
    this.revision = 0;
    this.planned = [];
    this.schedule = [];
    this.#sent = null;
    this.#forget_answer();
  }

  /** Stores a complete ParameterSet unless a newer one is known. */
  update_all(set: ParameterSet): void {
    const revision = set.revision ?? 0;
    if (revision < this.revision) {
      return;
    }
    for (const state of set.parameters ?? []) {
      this.#take(state);
      this.#adapt(state);
    }
    this.planned = set.planned ?? [];
    this.schedule = set.schedule ?? [];
    this.revision = revision;
  }

  /** Stores a ParametersChanged event unless the known set already contains this change. */
  update_changed(changed: ParametersChanged): void {
    const revision = changed.revision ?? 0;
    if (revision <= this.revision) {
      return;
    }
    for (const state of changed.changed ?? []) {
      this.#take(state, actor_text(changed.by));
    }
    this.revision = revision;
  }

  #take(reported: ParameterState, client?: string): void {
    const state = this.parameters[this.#index.get(reported.name ?? "") ?? -1];
    if (!state) {
      return;
    }
    state.value = reported.value ?? {};
    state.pending = reported.pending ?? null;
    state.client_of_last_change = client ?? state.client_of_last_change;
    if (state.edit && same(state.edit, state.requested)) {
      state.edit = state.violation = null;
    }
  }

  /** Takes what differs in this world: the range, by the quota of a class, and when a change takes effect. */
  #adapt({name = "", min, max, effect}: ParameterState): void {
    const i = this.#index.get(name) ?? -1, about = this.registry[i];
    if (about) {
      const differs = min !== undefined || max !== undefined || effect !== undefined;
      this.parameters[i]!.about =
        !differs ? about : {...about, min: min ?? about.min, max: max ?? about.max, effect: effect ?? about.effect};
    }
  }

  get known(): boolean {
    return this.registry.length > 0 && this.revision > 0;
  }

  // ---- editing: clears what the server answered about earlier values ----

  /** Edits a value; i: its index in the registry. A value equal to the requested one removes the edit. */
  edit(i: number, value: ParameterValue): void {
    this.revert(i);
    const parameter = this.parameters[i]!;
    parameter.edit = same(value, parameter.requested) ? null : value;
  }

  /** i: absent: all. */
  revert(i?: number): void {
    for (const parameter of i === undefined ? this.parameters : [this.parameters[i]!]) {
      parameter.edit = null;
    }
    this.#forget_answer();
  }

  get edit_count(): number {
    return this.#edits().length;
  }

  #forget_answer(): void {
    this.#mark([]);
    this.problem = "";
    this.warnings = [];
    this.#edit_number += 1;
  }

  // ---- checks: the server checks the edits while the user makes them, and changes nothing ----

  /** Returns a dry run of the edits, and its number for checked(); null if there is no edit or a transaction is
   *  pending. */
  check(world: string, when: When): {fields: SetParameters; number: number}|null {
    const changes = this.#edits();
    return this.busy || changes.length === 0 ?
      null :
      {fields: {...fields_of(world, this.revision, changes, when), dry_run: true}, number: this.#edit_number};
  }

  /** Stores the answer to a dry run, the warnings or the refusal, unless the edits have changed since. */
  checked(number: number, answer: {warnings: readonly string[]}|{refusal: RefusalFacts}): void {
    if (number === this.#edit_number && !this.busy) {
      this.#mark("refusal" in answer ? answer.refusal.violations : []);
      this.warnings = "warnings" in answer ? answer.warnings : [];
    }
  }

  // ---- transactions: one at a time. The caller sends each returned request and calls answered() once for it ----

  get busy(): boolean {
    return this.#sent !== null;
  }

  /** Returns the fields of the SetParameters that sends all edits; null if there is no edit or a transaction is
   *  pending. */
  apply(world: string, when: When = null): SetParameters|null {
    const changes = this.#edits();
    return this.busy || changes.length === 0 ? null : this.#send(world, changes, when);
  }

  /** Restores the values before these changes, except values that other clients have changed since; null if none is
   *  left or a transaction is pending. */
  reverse(world: string, changes: readonly Change[]): SetParameters|null {
    const back = changes.filter(({parameter, after}) => same(parameter.requested, after))
                   .map(({parameter, before, after}) => ({parameter, before: after, after: before}));
    return this.busy || back.length === 0 ? null : this.#send(world, back, null);
  }

  /** The changes of the pending transaction. */
  get sent(): readonly Change[] {
    return this.#sent?.changes ?? [];
  }

  /** Takes the answer to the pending transaction: the new ParameterSet or null, or the refusal, or that no answer
   *  arrived. Returns whether the caller must request the complete set. */
  answered(answer: {set: ParameterSet|null}|{refusal: RefusalFacts}|{lost: true}): boolean {
    const sent = this.#sent;
    if (sent === null) {
      return false;
    }
    this.#sent = null;
    this.#forget_answer();
    if ("set" in answer) {
      for (const {parameter, after} of sent.changes) {
        parameter.client_of_last_change = "";
        if (parameter.edit && same(parameter.edit, after)) {
          parameter.edit = null; // otherwise the user has edited the value again since it was sent
        }
      }
      if (answer.set !== null) {
        this.update_all(answer.set);
      }
      return sent.is_plan; // the list of planned changes is longer now
    }
    if ("refusal" in answer) {
      const {message, violations} = answer.refusal,
                      is_stale = violations.some((one) => field_name(one) === revision_field);
      this.problem = this.#mark(violations) ? parameter_words.see_marked :
        is_stale                            ? parameter_words.is_stale :
                                              message;
    } else {
      this.problem = parameter_words.lost;
    }
    return true;
  }

  #edits(): Change[] {
    return this.parameters.flatMap(
      (parameter) => parameter.edit ? [{parameter, before: parameter.requested, after: parameter.edit}] : []);
  }

  #send(world: string, changes: readonly Change[], when: When): SetParameters {
    this.#sent = {changes, is_plan: when !== null};
    return fields_of(world, this.revision, changes, when);
  }

  /** Marks only the parameters of these violations. Returns whether any belongs to a parameter. */
  #mark(violations: readonly Violation[]): boolean {
    for (const parameter of this.parameters) {
      parameter.violation = violations.find((one) => field_name(one) === parameter.about.name) ?? null;
    }
    return this.parameters.some(({violation}) => violation !== null);
  }
}

/** The planned and scheduled values of a parameter: "0.2 in generation 30". */
export function planned_values({schedule, planned}: ParameterEdits, parameter: string|undefined): string[] {
  const text = ({value = {}}: ParameterAssignment|ScheduledValue, when: string): string =>
    `${value_text(value)} ${when}`;
  return [
    ...schedule.filter(({name}) => name === parameter)
      .map((one) => text(one, parameter_words.in_generation(one.generation ?? 0))),
    ...planned.flatMap(
      (change) =>
        (change.parameters ?? []).filter(({name}) => name === parameter).map((one) => text(one, when_text(change)))),
  ];
}

function field_name(violation: Violation): string {
  return violation.field.startsWith(field_prefix) ? violation.field.slice(field_prefix.length) : violation.field;
}

function fields_of(world: string, expected_revision: number, changes: readonly Change[], when: When): SetParameters {
  const parameters = changes.map(({parameter, after}) => ({name: parameter.about.name, value: after}));
  const at = when === null ? {} : "generation" in when ? {at_generation: when.generation} : {at_tick: when.tick};
  return {world, expected_revision, parameters, ...at};
}

/** Returns when a PlannedChange is due: "in generation 30", "after tick 1,200". */
export function when_text({tick, generation = 0}: PlannedChange): string {
  return tick !== undefined ? parameter_words.after_tick(tick) : parameter_words.in_generation(generation);
}
