// ParameterExchange: the edits of the shown world, and the requests about them: dry runs while the user edits, changes,
// undo and redo. Draws nothing; ParametersPanel shows it.
import type {Event, ParameterSet, PlannedChange, SetParameters} from "../core/protocol";
import {common_texts} from "../texts/common";
import {parameters_texts as texts} from "../texts/parameters";
import {undo_texts} from "../texts/undo";
import {type Change, ParameterEdits, type When, when_text} from "../world/parameter_edits";
import {label_of} from "../world/parameters";
import type {PanelContext} from "../world/panel_context";
import {Refusal} from "../world/server";
import type {UndoStep} from "../world/undo";

const check_delay_ms = 400; // after the last edit, before a dry run

/** What shows the exchange. */
export interface ExchangeView {
  /** The registry of another server is known: the list of parameters must be built again. */
  described(): void;
  /** Another world or run is shown: nothing that the user typed has a meaning any longer. */
  forgotten(): void;
  /** The state has changed, after an answer of the server. */
  answered(): void;
  /** The server has refused a change: its violation states why. */
  refused(): void;
  /** Edits were made while a change was being sent. */
  edited_since(): void;
}

export class ParameterExchange {
  readonly edits = new ParameterEdits();
  /** Why the values cannot be changed now, as a sentence; empty if they can. */
  why_not = "";
  world = ""; // the followed world and run

  readonly #context: PanelContext;
  readonly #view: ExchangeView;
  #run_id = "";
  #set: ParameterSet|null = null; // the one that was taken last
  #transaction = 0; // answers to earlier transactions are ignored
  #apply_again = false; // an edit was made while a transaction was pending
  #check_timer = 0;

  constructor(context: PanelContext, view: ExchangeView) {
    this.#context = context;
    this.#view = view;
  }

  /** Follows the shown world. Returns whether something has changed. */
  follow(): boolean {
    const {server} = this.#context, world = this.#context.world();
    let changed = false;
    if (server.parameters !== this.edits.registry && server.parameters.length > 0) {
      this.edits.describe(server.parameters);
      this.#view.described();
      this.#forget();
      changed = true;
    }
    const run_id = world.info?.run_id ?? "";
    if (world.shown !== this.world || run_id !== this.#run_id) {
      this.world = world.shown;
      this.#run_id = run_id;
      this.#forget();
      changed = true;
    }
    if (world.parameters.set !== null && world.parameters.set !== this.#set && this.edits.registry.length > 0) {
      this.#set = world.parameters.set;
      this.edits.update_all(this.#set);
      changed = true;
    }
    const why_not = world.is_replay ? common_texts.replay_cannot_change :
                                      server.access.why_not("set_parameters", world.shown);
    changed ||= why_not !== this.why_not;
    this.why_not = why_not;
    return changed;
  }

  /** Returns whether the event changes what is shown. */
  take_event(event: Event): boolean {
    const {parameters_changed} = event;
    if (event.world !== this.world || event.run_id !== this.#run_id || !parameters_changed || !this.edits.known) {
      return false;
    }
    this.edits.update_changed(parameters_changed); // the world reads the complete set, which does not name the client
    return true;
  }

  /** Asks the server a moment after the last call whether it would accept the edits.
   *
   *  chosen_when  a sentence if the user has not chosen a moment */
  check_soon(chosen_when: () => When | string): void {
    this.stop_checking();
    if (this.edits.edit_count > 0) {
      this.#check_timer = window.setTimeout(() => void this.#check(chosen_when()), check_delay_ms);
    }
  }

  stop_checking(): void {
    clearTimeout(this.#check_timer);
  }

  /** Sends the edits, or later if a change is being sent. */
  apply(when: When): void {
    const fields = this.edits.apply(this.world, when), changes = this.edits.sent;
    const world = this.#context.world(), transaction = this.#transaction;
    void this.#send(fields).then((answer) => {
      if (answer === "accepted" && when === null && transaction === this.#transaction) {
        world.undo.add(this.#step(changes));
      }
    });
  }

  /** Remembers that the edits are to be applied after the change that is being sent. */
  apply_afterwards(): void {
    this.#apply_again = true;
  }

  /** An applied change, for the undo history of the world. */
  #step(changes: readonly Change[]): UndoStep {
    const {edits} = this, labels = changes.map(({parameter}) => label_of(parameter.about));
    const transaction = this.#transaction;
    const is_followed = (): boolean => transaction === this.#transaction; // `edits` forgets the changes of other worlds
    let last = changes;
    /** Resolves with whether a value was changed: others may have changed them all since. */
    const reverse = async (): Promise<boolean> => {
      if (edits.busy) {
        throw new Error(undo_texts.busy);
      }
      const fields = edits.reverse(this.world, last), {sent} = edits, answer = await this.#send(fields);
      if (answer === "refused") {
        throw new Error(edits.problem);
      }
      last = answer === "accepted" ? sent : last;
      return answer === "accepted";
    };
    return {
      name: undo_texts.parameters(labels),
      can_undo: is_followed,
      can_redo: is_followed,
      undo: reverse,
      redo: reverse
    };
  }

  /** Cancels a planned change. */
  async cancel({id}: PlannedChange): Promise<void> {
    const {world} = this;
    await this.#context.attempt(() => this.#context.server.request("cancel_change", {world, id}));
  }

  #forget(): void {
    this.edits.forget();
    this.#set = null;
    this.#transaction += 1;
    this.#apply_again = false;
    this.#view.forgotten();
  }

  async #check(when: When|string): Promise<void> {
    const check = this.why_not === "" && typeof when !== "string" ? this.edits.check(this.world, when) : null;
    if (check === null) {
      return;
    }
    try {
      const {warnings = []} = await this.#context.server.respond("set_parameters", check.fields);
      this.edits.checked(check.number, {warnings});
    } catch (error) {
      this.edits.checked(check.number, {refusal: error as Refusal});
    }
    this.#view.answered();
  }

  /** fields: null: there is nothing to send. */
  async #send(fields: SetParameters|null): Promise<"accepted"|"refused"|"nothing"> {
    this.stop_checking();
    const transaction = this.#transaction;
    this.#view.answered();
    if (fields === null) {
      return "nothing";
    }
    let stale = false, refused = false;
    try {
      const response = await this.#context.server.respond("set_parameters", fields);
      if (transaction !== this.#transaction) {
        return "nothing"; // another world is shown by now
      }
      stale = this.edits.answered({set: response.parameters ?? null});
      const count = fields.parameters?.length ?? 0;
      this.#context.notify(
        response.planned_change ? texts.planned(count, when_text(response.planned_change)) :
                                  texts.applied(count, response.applied_tick ?? 0));
    } catch (error) {
      if (transaction !== this.#transaction) {
        return "nothing"; // another world is shown by now
      }
      stale = this.edits.answered(error instanceof Refusal && error.code !== "" ? {refusal: error} : {lost: true});
      refused = true;
    }
    if (refused) {
      this.#view.refused();
    }
    if (stale) {
      this.#context.world().parameters.read();
    }
    this.#view.answered();
    if (this.#apply_again) {
      this.#apply_again = false;
      this.#view.edited_since();
    }
    return refused ? "refused" : "accepted";
  }
}
