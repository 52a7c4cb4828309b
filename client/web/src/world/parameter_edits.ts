// ParameterEdits: the parameters of a world, the edits that have not been sent, and transactions with undo and redo.
// Pure: no DOM.
//
// All parameters come from the server's registry, so a parameter that is added to the server appears here. Edits are
// collected and sent as one SetParameters request; the server applies all of them or none. The request contains the
// revision on which the edits are based. If another client has changed a parameter since, the server rejects the
// request. Undo sends another SetParameters request.
import type {Message} from "../core/messages";
import {nice_step, rounded, with_separators} from "../texts/numbers";
import {actor_text} from "../texts/texts";

const decades_min = 100; // if max / min is above this ratio, the slider is logarithmic
const transactions_kept = 100;
const unit_length_max = 10; // longer units do not fit beside a field
const field_prefix = "set_parameters.";

// ---- the registry --------------------------------------------------------------------------------------------------

export interface ParameterGroup {
  title: string;
  members: number[]; // indices in the registry
}

/** Returns the parameters that users change most often, in the order of the registry. */
export function most_used(registry: readonly Message[]): ParameterGroup {
  return {title: "Most used", members: registry.flatMap((about, i) => (about.is_most_used ? [i] : []))};
}

/** Groups the registry by topic, in its order. */
export function grouped(registry: readonly Message[]): ParameterGroup[] {
  const groups: ParameterGroup[] = [];
  registry.forEach((about, i) => {
    const title: string = about.topic ?? "";
    if (groups.at(-1)?.title !== title) {
      groups.push({title, members: []});
    }
    groups.at(-1)!.members.push(i);
  });
  return groups;
}

function plain(text: string): string {
  return text.toLowerCase().replace(/_/g, " ");
}

/** Returns whether the parameter or the title of its group contains every word of `search`: in the name, the unit, the help, the choices or
 *  their help. Case is ignored; _ counts as a space. */
export function matches(about: Message, group: string, search: string): boolean {
  const all = plain([
    about.name, about.unit ?? "", about.help ?? "", group, ...(about.choices ?? []), ...(about.choice_help ?? [])
  ].join(" "));
  return plain(search).split(" ").every((word) => all.includes(word));
}

/** Returns the name for people, without the unit at its end: "Mutation chance", "Tick" for tick_s. */
export function label_of(about: Message): string {
  let name: string = about.name;
  for (const [unit, end] of [["s", "_s"], ["px", "_px"], ["px/s", "_px_s"], ["kg", "_kg"]] as const) {
    if (about.unit === unit && name.endsWith(end)) {
      name = name.slice(0, -end.length);
    }
  }
  const label = plain(name);
  return label.charAt(0).toUpperCase() + label.slice(1);
}

/** Returns the name of a choice for people: "stochastic universal". */
export function label_of_choice(choice: string): string {
  return plain(choice);
}

/** Returns the unit beside a number: "px", "island" after 1, "islands" after 2. Empty if there is none, or if it is too long. */
export function unit_text(about: Message, number: number): string {
  const unit: string = about.unit ?? "";
  const text = about.kind === "PARAMETER_KIND_COUNT" && number === 1 && unit.endsWith("s") ? unit.slice(0, -1) : unit;
  return text.length > unit_length_max ? "" : text;
}

export function is_number(about: Message): boolean {
  return about.kind === "PARAMETER_KIND_REAL" || about.kind === "PARAMETER_KIND_COUNT";
}

/** Returns the allowed values as text: "0.01 to 1", "roulette, tournament", "on or off". */
export function allowed_text(about: Message): string {
  if (about.kind === "PARAMETER_KIND_FLAG") {
    return "on or off";
  }
  if (about.kind === "PARAMETER_KIND_CHOICE") {
    return (about.choices ?? []).join(", ");
  }
  return `${rounded(about.min ?? 0)} to ${rounded(about.max ?? 0)}`;
}

// ---- values --------------------------------------------------------------------------------------------------------

/** A ParameterValue: exactly one field is set. */
export interface ParameterValue {
  real?: number;
  count?: number;
  flag?: boolean;
  choice?: string;
}

export function same(a: ParameterValue, b: ParameterValue): boolean {
  return a.real === b.real && a.count === b.count && a.flag === b.flag && a.choice === b.choice;
}

/** Returns the value as text: "0.15", "25", "on", "roulette". */
export function value_text(value: ParameterValue): string {
  if (value.real !== undefined) {
    return rounded(value.real);
  }
  if (value.count !== undefined) {
    return with_separators(value.count);
  }
  return value.flag !== undefined ? (value.flag ? "on" : "off") : value.choice ?? "";
}

export function number_of(value: ParameterValue): number {
  return value.real ?? value.count ?? 0;
}

/** Converts a number to a real or a count. A count is rounded and limited to 32 bits. The server rejects a value out of range. */
export function value_of(about: Message, number: number): ParameterValue {
  return about.kind === "PARAMETER_KIND_COUNT" ? {count: Math.min(Math.max(Math.round(number), 0), 0xffffffff)} :
                                                 {real: number};
}

/** Reads a number that a user has typed; null if it is none. In a real, a comma may stand for the point; in a count, commas may separate
 *  thousands, as value_text() prints them. */
export function typed_number(about: Message, text: string): number|null {
  const clean = text.trim().replace("−", "-");
  if (about.kind === "PARAMETER_KIND_COUNT") {
    const number = /^(\d+|\d{1,3}(,\d{3})+)$/.test(clean) ? Number(clean.replace(/,/g, "")) : NaN;
    return number <= 0xffffffff ? number : null;
  }
  const number = /^[+-]?(\d+[.,]?\d*|[.,]\d+)(e[+-]?\d+)?$/i.test(clean) ? Number(clean.replace(",", ".")) : NaN;
  return Number.isFinite(number) ? number : null;
}

// ---- sliders -------------------------------------------------------------------------------------------------------

/** Returns whether the range is so large that its slider needs a logarithmic scale. */
export function spans_decades(about: Message): boolean {
  const min: number = about.min ?? 0, max: number = about.max ?? 0;
  const least = about.kind === "PARAMETER_KIND_COUNT" || min <= 0 ? Math.max(min, 1) : min;
  return max / least > decades_min;
}

/** A logarithmic scale that also contains 0 and negative numbers: linear near 0, logarithmic beyond the size `linear`. */
function log_scale(number: number, linear: number): number {
  return Math.sign(number) * Math.log1p(Math.abs(number) / linear);
}

/** Returns the size up to which the scale of the slider is linear; 0 for a range above 0, which is purely logarithmic. */
function linear_size(about: Message): number {
  const min: number = about.min ?? 0, max: number = about.max ?? 0;
  if (min > 0) {
    return 0;
  }
  return about.kind === "PARAMETER_KIND_COUNT" ? 1 : Math.min(1, Math.max(Math.abs(min), max) / 10000);
}

/** Returns where the slider stands, 0 to 1. Numbers outside the range stand at its ends. */
export function share_of(about: Message, number: number): number {
  const min: number = about.min ?? 0, max: number = about.max ?? 0;
  const inside = Math.min(Math.max(number, min), max);
  if (!(max > min)) {
    return 0;
  }
  if (!spans_decades(about)) {
    return (inside - min) / (max - min);
  }
  const linear = linear_size(about);
  if (linear === 0) {
    return Math.log(inside / min) / Math.log(max / min);
  }
  const least = log_scale(min, linear);
  return (log_scale(inside, linear) - least) / (log_scale(max, linear) - least);
}

/** Returns the number at a place of the slider: the ends exactly, between them a number with few digits. */
export function number_at(about: Message, share: number): number {
  const min: number = about.min ?? 0, max: number = about.max ?? 0;
  if (share <= 0 || share >= 1) {
    return share <= 0 ? min : max;
  }
  const clamp = (number: number): number => Math.min(Math.max(number, min), max);
  const is_count = about.kind === "PARAMETER_KIND_COUNT";
  if (!spans_decades(about)) {
    const step = Math.max(nice_step((max - min) / 200), is_count ? 1 : 0);
    return clamp(Number((Math.round((min + share * (max - min)) / step) * step).toPrecision(12)));
  }
  const linear = linear_size(about);
  let number: number;
  if (linear === 0) {
    number = min * Math.pow(max / min, share);
  } else {
    const least = log_scale(min, linear), at = least + share * (log_scale(max, linear) - least);
    number = Math.sign(at) * Math.expm1(Math.abs(at)) * linear;
  }
  return clamp(is_count ? Math.round(Number(number.toPrecision(2))) : Number(number.toPrecision(2)));
}

/** Returns the number one step up or down, as the arrow keys of a number field set it. The steps of a real are 1, 2 or 5 times a power of ten. */
export function stepped(about: Message, number: number, up: boolean, large: boolean): number {
  const min: number = about.min ?? 0, max: number = about.max ?? 0;
  const is_count = about.kind === "PARAMETER_KIND_COUNT";
  const size = spans_decades(about) && number !== 0 ? Math.abs(number) / 20 : (max - min) / 100;
  const fine = is_count && !large ? 1 : nice_step(size);
  const step = (is_count ? Math.max(1, Math.round(fine)) : fine) * (large ? 10 : 1);
  return Math.min(Math.max(Number((number + (up ? step : -step)).toPrecision(10)), min), max);
}

// ---- edits and transactions
// ------------------------------------------------------------------------------------------

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
  /** Why the last transaction was refused; empty if it was accepted. A reason that concerns one parameter is in violation(). */
  problem = "";
  revision = 0; // 0: no set has been received
  registry: readonly Message[] = [];
  /** PlannedChange and ScheduledValue messages. */
  planned: Message[] = [];
  schedule: Message[] = [];
  #index = new Map<string, number>();
  #states: State[] = [];
  #sent: Transaction|null = null;
  #done: Change[][] = []; // newest last
  #undone: Change[][] = [];
  #edit_number = 0; // counts the changes of edits

  // ---- what the server reports ----

  /** Sets the registry and clears everything else. */
  describe(registry: readonly Message[]): void {
    this.registry = registry;
    this.#index = new Map(registry.map((about, i) => [about.name as string, i]));
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
  update_all(set: Message): void {
    const revision = Number(set.revision ?? 0);
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

  /** Stores a ParametersChanged event. Returns false if an earlier change was missed; the caller then requests the complete set. */
  update_changed(changed: Message): boolean {
    const revision = Number(changed.revision ?? 0);
    if (revision <= this.revision) {
      return true; // the known set already contains this change
    }
    for (const state of changed.changed ?? []) {
      this.#take(state);
      const i = this.#index.get(state.name);
      if (i !== undefined) {
        this.#states[i]!.client_of_last_change = actor_text(changed.by);
      }
    }
    const is_next = revision === this.revision + 1;
    this.revision = revision;
    return is_next;
  }

  #take(reported: Message): void {
    const i = this.#index.get(reported.name);
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

  // ---- one parameter; i is its index in the registry ----

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

  /** Returns the client that last changed this parameter; empty if no other client has changed it since the value was received or set here. */
  client_of_last_change(i: number): string {
    return this.#states[i]!.client_of_last_change;
  }

  /** Returns why the server rejected the value that was sent last; null if it accepted it. */
  violation(i: number): Violation|null {
    return this.#states[i]!.violation;
  }

  /** Returns the planned and scheduled values of a parameter: "0.2 in generation 30". */
  planned_values(i: number): string[] {
    const name: string = this.registry[i]!.name;
    return [
      ...this.schedule.filter((one) => one.name === name)
        .map((one) => `${value_text(one.value ?? {})} in generation ${with_separators(one.generation ?? 0)}`),
      ...this.planned.flatMap(
        (change) => (change.parameters as Message[] ?? [])
                      .filter((one) => one.name === name)
                      .map((one) => `${value_text(one.value ?? {})} ${when_text(change)}`)),
    ];
  }

  // ---- editing: clears the violations and the problem of the last refusal, because they are about earlier values ----

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

  // ---- checks: the server checks the edits while the user makes them, and changes nothing ----

  /** Returns a dry run of the edits, and its number for checked(); null if there is no edit or a transaction is pending. */
  check(world: string, when: When): {fields: Message; number: number}|null {
    const changes = this.#edits();
    return this.busy || changes.length === 0 ?
      null :
      {fields: {...this.#fields(world, changes), ...when_fields(when), dry_run: true}, number: this.#edit_number};
  }

  /** Stores the violations of a dry run unless the edits have changed since. refusal: null if the server accepted it. */
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

  /** Returns the fields of the SetParameters that sends all edits; null if there is no edit or a transaction is pending. */
  apply(world: string, when: When = null): Message|null {
    const changes = this.#edits();
    return this.busy || changes.length === 0 ?
      null :
      {...this.#send(world, when === null ? "apply" : "plan", changes), ...when_fields(when)};
  }

  /** Restores the values before the last transaction that was not undone, except values that other clients have changed since. */
  undo(world: string): Message|null {
    return this.#send_reversed(world, "undo", this.#done);
  }

  redo(world: string): Message|null {
    return this.#send_reversed(world, "redo", this.#undone);
  }

  /** Takes the answer to the pending transaction: the new ParameterSet or null, or the refusal, or the error that no answer arrived. Returns
   *  whether the caller must request the complete set. */
  answered(answer: {set: Message|null}|{refusal: RefusalFacts}|{lost: true}): boolean {
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
      this.problem = "No answer arrived: the change may or may not have been applied";
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

  #fields(world: string, changes: readonly Change[]): Message {
    return {
      world,
      expected_revision: this.revision,
      parameters: changes.map(({parameter, after}) => ({name: this.registry[parameter]!.name, value: after})),
    };
  }

  #send(world: string, kind: Transaction["kind"], changes: Change[]): Message {
    this.#sent = {kind, changes};
    return this.#fields(world, changes);
  }

  #send_reversed(world: string, kind: "undo"|"redo", from: Change[][]): Message|null {
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
    this.problem = marked ? "Nothing was changed: see the marked parameters" :
      is_stale            ? "Another client changed parameters at the same time: check the values and apply again" :
                            refusal.message;
  }
}

function field_name(violation: Violation): string {
  return violation.field.startsWith(field_prefix) ? violation.field.slice(field_prefix.length) : violation.field;
}

function reversed(changes: readonly Change[]): Change[] {
  return changes.map(({parameter, before, after}) => ({parameter, before: after, after: before}));
}

function when_fields(when: When): Message {
  return when === null ? {} : "generation" in when ? {at_generation: when.generation} : {at_tick: when.tick};
}

/** Returns when a PlannedChange is due: "in generation 30", "after tick 1,200". */
export function when_text(change: Message): string {
  return change.tick !== undefined ? `after tick ${with_separators(change.tick)}` :
                                     `in generation ${with_separators(change.generation ?? 0)}`;
}
