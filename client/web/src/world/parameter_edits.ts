// ParameterEdits: the parameters of a world, the edits that have not been sent, and transactions with undo and redo.
// Pure: no DOM.
//
// All parameters come from the server's registry, so a parameter that is added to the server appears here. Edits are
// collected and sent as one SetParameters request; the server applies all of them or none. The request contains the
// revision on which the edits are based. If another client has changed a parameter since, the server rejects the
// request. Undo sends another SetParameters request.
import type {
  ParameterDescription, ParametersChanged, ParameterSet, ParameterState, ParameterValue, PlannedChange, ScheduledValue,
  SetParameters} from "../core/protocol";
import {parameter_words} from "../texts/parameter_words";
import {actor_text} from "../texts/users";
import {same, value_text} from "./parameters";

const transactions_kept = 100;
const field_prefix = "set_parameters.";

export interface Violation {
  field: string;
  allowed: string;
  got: string;
}

/** Why the server refused a request. The class Refusal of the page has these members. */
export interface RefusalFacts {
  message: string;
  violations: Violation[];
}

/** When a change is made: at once, before the first tick of a generation, or right after a tick of the run. */
export type When = {
  generation: number
}|{tick: number}|null;

interface State {
  value: ParameterValue;
  pending: ParameterValue|null;
  edit: ParameterValue|null;
  client_of_last_change: string;
  violation: Violation|null;
}
interface Change {
  parameter: number;
  before: ParameterValue;
  after: ParameterValue;
}
interface Transaction {
  kind: "apply"|"plan"|"undo"|"redo";
  changes: Change[];
}

export class ParameterEdits {
  /** Why the last transaction was refused; empty if it was accepted. A reason that concerns one parameter is in
   *  violation(). */
  problem = "";
  revision = 0; // 0: no set has been received
  registry: readonly ParameterDescription[] = [];
  planned: PlannedChange[] = [];
  schedule: ScheduledValue[] = [];
  #index = new Map<string, number>();
  #states: State[] = [];
  #sent: Transaction|null = null;
  #done: Change[][] = []; // newest last
  #undone: Change[][] = [];
  #edit_number = 0; // counts the changes of edits

  /** Sets the registry and clears everything else. */
  describe(registry: readonly ParameterDescription[]): void {
    this.registry = registry;
    this.#index = new Map(registry.map((about, i) => [about.name ?? "", i]));
    this.forget();
  }

  /** Clears everything except the registry. Call when another world or run is shown. */
  forget(): void {
    this.#states = this.registry.map(
      (about) =>
        ({value: about.default_value ?? {}, pending: null, edit: null, client_of_last_change: "", violation: null}));
    this.revision = 0;
    this.planned = [];
    this.schedule = [];
    this.#sent = null;
    this.#done = [];
    this.#undone = [];
    this.problem = "";
    this.#edit_number += 1;
  }

  /** Stores a complete ParameterSet unless a newer one is known. */
  update_all(set: ParameterSet): void {
    const revision = set.revision ?? 0;
    if (revision < this.revision) {
      return;
    }
    for (const state of set.parameters ?? []) {
      this.#take(state);
    }
    this.planned = set.planned ?? [];
    this.schedule = set.schedule ?? [];
    this.revision = revision;
  }

  /** Stores a ParametersChanged event. Returns false if an earlier change was missed; the caller then requests the
   *  complete set. */
  update_changed(changed: ParametersChanged): boolean {
    const revision = changed.revision ?? 0;
    if (revision <= this.revision) {
      return true; // the known set already contains this change
    }
    for (const state of changed.changed ?? []) {
      this.#take(state);
      const i = this.#index.get(state.name ?? "");
      if (i !== undefined) {
        this.#states[i]!.client_of_last_change = actor_text(changed.by);
      }
    }
    const is_next = revision === this.revision + 1;
    this.revision = revision;
    return is_next;
  }

  #take(reported: ParameterState): void {
    const i = this.#index.get(reported.name ?? "");
    if (i === undefined) {
      return;
    }
    const state = this.#states[i]!;
    state.value = reported.value ?? {};
    state.pending = reported.pending ?? null;
    if (state.edit && same(state.edit, this.requested_value(i))) {
      state.edit = state.violation = null;
    }
  }

  get known(): boolean {
    return this.registry.length > 0 && this.revision > 0;
  }

  current_value(i: number): ParameterValue {
    return this.#states[i]!.value;
  }

  /** Returns the pending value; if there is none, the current value. */
  requested_value(i: number): ParameterValue {
    return this.#states[i]!.pending ?? this.#states[i]!.value;
  }

  /** Returns the edited value; if there is none, requested_value(). */
  shown(i: number): ParameterValue {
    return this.#states[i]!.edit ?? this.requested_value(i);
  }

  is_pending(i: number): boolean {
    return this.#states[i]!.pending !== null;
  }

  is_edited(i: number): boolean {
    return this.#states[i]!.edit !== null;
  }

  is_default(i: number): boolean {
    return same(this.shown(i), this.registry[i]!.default_value ?? {});
  }

  /** Returns the client that last changed this parameter; empty if no other client has changed it since the value was
   *  received or set here. */
  client_of_last_change(i: number): string {
    return this.#states[i]!.client_of_last_change;
  }

  /** Returns why the server rejected the value that was sent last; null if it accepted it. */
  violation(i: number): Violation|null {
    return this.#states[i]!.violation;
  }

  /** Returns the planned and scheduled values of a parameter: "0.2 in generation 30". */
  planned_values(i: number): string[] {
    const {name} = this.registry[i]!;
    return [
      ...this.schedule.filter((one) => one.name === name)
        .map((one) => `${value_text(one.value ?? {})} ${parameter_words.in_generation(one.generation ?? 0)}`),
      ...this.planned.flatMap(
        (change) => (change.parameters ?? [])
                      .filter((one) => one.name === name)
                      .map((one) => `${value_text(one.value ?? {})} ${when_text(change)}`)),
    ];
  }

  /** Edits a value. A value equal to requested_value() removes the edit. */
  edit(i: number, value: ParameterValue): void {
    this.revert(i);
    if (!same(value, this.requested_value(i))) {
      this.#states[i]!.edit = value;
    }
  }

  revert(i: number): void {
    this.#states[i]!.edit = null;
    this.#forget_refusal();
  }

  revert_all(): void {
    for (const state of this.#states) {
      state.edit = null;
    }
    this.#forget_refusal();
  }

  get edit_count(): number {
    return this.#states.filter((state) => state.edit !== null).length;
  }

  #forget_refusal(): void {
    for (const state of this.#states) {
      state.violation = null;
    }
    this.problem = "";
    this.#edit_number += 1;
  }

  /** Returns a dry run of the edits, and its number for checked(); null if there is no edit or a transaction is
   *  pending. */
  check(world: string, when: When): {fields: SetParameters; number: number}|null {
    const changes = this.#edits();
    return this.busy || changes.length === 0 ?
      null :
      {fields: {...this.#fields(world, changes), ...when_fields(when), dry_run: true}, number: this.#edit_number};
  }

  /** Stores the violations of a dry run unless the edits have changed since. refusal: null if the server accepted it.
   *  */
  checked(number: number, refusal: RefusalFacts|null): void {
    if (number === this.#edit_number && !this.busy) {
      for (const state of this.#states) {
        state.violation = null;
      }
      this.#mark(refusal?.violations ?? []);
    }
  }

  // ---- transactions: only one may be pending. The caller sends each returned request and calls answered() once for it
  // ----

  get busy(): boolean {
    return this.#sent !== null;
  }

  get can_undo(): boolean {
    return !this.busy && this.#done.length > 0;
  }

  get can_redo(): boolean {
    return !this.busy && this.#undone.length > 0;
  }

  /** Returns the fields of the SetParameters that sends all edits; null if there is no edit or a transaction is
   *  pending. */
  apply(world: string, when: When = null): SetParameters|null {
    const changes = this.#edits();
    return this.busy || changes.length === 0 ?
      null :
      {...this.#send(world, when === null ? "apply" : "plan", changes), ...when_fields(when)};
  }

  /** Restores the values before the last transaction that was not undone, except values that other clients have changed
   *  since. */
  undo(world: string): SetParameters|null {
    return this.#send_reversed(world, "undo", this.#done);
  }

  redo(world: string): SetParameters|null {
    return this.#send_reversed(world, "redo", this.#undone);
  }

  /** Takes the answer to the pending transaction: the new ParameterSet or null, or the refusal, or the error that no
   *  answer arrived. Returns
   *  whether the caller must request the complete set. */
  answered(answer: {set: ParameterSet|null}|{refusal: RefusalFacts}|{lost: true}): boolean {
    const sent = this.#sent;
    if (sent === null) {
      return false;
    }
    this.#sent = null;
    this.#forget_refusal();
    if ("set" in answer) {
      this.#take_acceptance(sent);
      if (answer.set !== null) {
        this.update_all(answer.set);
      }
      return sent.kind === "plan"; // the list of planned changes is longer now
    }
    if ("refusal" in answer) {
      this.#take_refusal(answer.refusal);
    } else {
      this.problem = parameter_words.lost;
    }
    if (
      sent.kind === "undo" ||
      sent.kind === "redo") { // keep the transaction, so that the user can undo or redo it again
      (sent.kind === "undo" ? this.#done : this.#undone).push(reversed(sent.changes));
    }
    return true;
  }

  #edits(): Change[] {
    return this.#states.flatMap(
      (state, parameter) =>
        (state.edit === null ? [] : [{parameter, before: this.requested_value(parameter), after: state.edit}]));
  }

  #fields(world: string, changes: readonly Change[]): SetParameters {
    return {
      world,
      expected_revision: this.revision,
      parameters: changes.map(({parameter, after}) => ({name: this.registry[parameter]!.name, value: after})),
    };
  }

  #send(world: string, kind: Transaction["kind"], changes: Change[]): SetParameters {
    this.#sent = {kind, changes};
    return this.#fields(world, changes);
  }

  #send_reversed(world: string, kind: "undo"|"redo", from: Change[][]): SetParameters|null {
    while (!this.busy && from.length > 0) {
      const changes =
        reversed(from.pop()!.filter(({parameter, after}) => same(this.requested_value(parameter), after)));
      if (changes.length > 0) {
        return this.#send(world, kind, changes);
      } // other clients have changed all these values since
    }
    return null;
  }

  #take_acceptance({kind, changes}: Transaction): void {
    for (const {parameter, after} of changes) {
      const state = this.#states[parameter]!;
      state.client_of_last_change = "";
      if (state.edit && same(state.edit, after)) {
        state.edit = null; // otherwise the user has edited the value again meanwhile
      }
    }
    if (kind === "plan") {
      return; // a planned change is cancelled, not undone
    }
    if (kind === "apply") {
      this.#undone = [];
    }
    const kept = kind === "undo" ? this.#undone : this.#done;
    kept.push(changes);
    if (kept.length > transactions_kept) {
      kept.shift();
    }
  }

  /** Marks the parameters of violations. Returns whether any belongs to a parameter. */
  #mark(violations: readonly Violation[]): boolean {
    let marked = false;
    for (const violation of violations) {
      const i = this.#index.get(field_name(violation));
      if (i !== undefined) {
        this.#states[i]!.violation = violation;
        marked = true;
      }
    }
    return marked;
  }

  #take_refusal(refusal: RefusalFacts): void {
    const marked = this.#mark(refusal.violations);
    const is_stale = refusal.violations.some((violation) => field_name(violation) === "expected_revision");
    this.problem = marked ? parameter_words.see_marked : is_stale ? parameter_words.is_stale : refusal.message;
  }
}

function field_name(violation: Violation): string {
  return violation.field.startsWith(field_prefix) ? violation.field.slice(field_prefix.length) : violation.field;
}

function reversed(changes: readonly Change[]): Change[] {
  return changes.map(({parameter, before, after}) => ({parameter, before: after, after: before}));
}

function when_fields(when: When): Pick<SetParameters, "at_generation"|"at_tick"> {
  return when === null ? {} : "generation" in when ? {at_generation: when.generation} : {at_tick: when.tick};
}

/** Returns when a PlannedChange is due: "in generation 30", "after tick 1,200". */
export function when_text({tick, generation = 0}: PlannedChange): string {
  return tick !== undefined ? parameter_words.after_tick(tick) : parameter_words.in_generation(generation);
}
