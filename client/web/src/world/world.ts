// ViewedWorld: the world that one pane shows: live, or a replay of its past. Each of its parts has one subject.
//
// Owner        main; one per pane. The pane and the panels read it, and change what is shown by its methods.
// Polling      organism and population are read at most 4 times a second, and only while the page is visible and
//              something shows them. Everything else follows from answers, events and snapshots.
import {type FromWorker, kind_of, type Look, none_left} from "../core/messages";
import type {Event} from "../core/protocol";
import type {SnapshotInfo} from "../core/snapshot";

import {Changes} from "./changes";
import {RunControl} from "./run_control";
import {SnapshotFeed} from "./feed";
import {WorldHistory} from "./history";
import {ParameterReader} from "./parameter_reader";
import {value_in_effect} from "./parameter_values";
import {Past} from "./past";
import {PopulationReader} from "./population";
import {Selection} from "./selection";
import type {Server} from "./server";
import type {KnownWorld} from "./worlds";
import {UndoHistory} from "./undo";

const poll_ms = 250;

export class ViewedWorld {
  /** Name of the live world; requests of panels about the shown moment use `shown`. */
  name = "";
  /** Calls its listeners after any change, at most once per animation frame. */
  readonly changes = new Changes(true);
  readonly feed: SnapshotFeed;
  readonly selection: Selection;
  readonly population: PopulationReader;
  readonly parameters: ParameterReader;
  readonly history: WorldHistory; // of `name`
  readonly control: RunControl;
  readonly past: Past;
  readonly undo: UndoHistory;
  readonly #end: (() => void)[] = [];

  constructor(readonly server: Server, pane: number) {
    const {changes} = this, poll = (): void => this.#poll();
    this.feed = new SnapshotFeed(server, pane, changes);
    this.selection = new Selection(this.feed, changes, poll);
    this.population = new PopulationReader(this.feed, this.selection, changes, poll);
    this.parameters = new ParameterReader(this.feed, changes);
    this.history = new WorldHistory(server, changes);
    this.control = new RunControl(this.feed, changes);
    const live = {name: () => this.name, watch: (world: string) => this.#watch(world, this.island)};
    this.past = new Past(live, this.feed, this.history, changes);
    this.undo = new UndoHistory(() => changes.notify());
    const timer = setInterval(poll, poll_ms);
    this.#end.push(
      server.messages.listen((message) => this.#take(message)),
      server.events.listen((event) => this.#take_event(event)),
      server.changes.listen(() => this.#server_changed()),
      () => clearInterval(timer),
    );
  }

  // ---- what is shown ----

  /** Name of the world that is drawn: `name`, or the replay's world. */
  get shown(): string {
    return this.feed.world;
  }

  get island(): number {
    return this.feed.island;
  }

  get snapshot(): SnapshotInfo|null {
    return this.feed.snapshot; // the newest drawn
  }

  get info(): KnownWorld|null {
    return this.feed.info; // of `shown`
  }

  get is_replay(): boolean {
    return this.past.is_shown;
  }

  /** Whether the organisms live on an island. Otherwise only their genes matter, and islands are empty. */
  get has_bodies(): boolean {
    const {set} = this.parameters, fitness = value_in_effect(set, "fitness")?.choice ?? "life";
    return fitness === "life" || (fitness === "external" && value_in_effect(set, "external_bodies")?.flag === true);
  }

  /** Whether organisms give birth while the world runs: a generation is an interval, and fitness is the number of
   *  children. */
  get has_births(): boolean {
    return value_in_effect(this.parameters.set, "reproduction")?.choice === "births";
  }

  get gene_names(): string[] {
    return this.feed.gene_names;
  }

  get look(): Look {
    return this.feed.look;
  }

  set_look(change: Partial<Look>): void {
    this.feed.set_look(change);
    this.#poll();
  }

  show(world: string, island = 0): void {
    if (world === this.name && !this.past.is_own_replay) {
      this.choose_island(island);
      return;
    }
    this.past.forked = world === this.name ? this.past.forked : "";
    this.past.close();
    this.name = world;
    this.#watch(world, island);
    void this.history.read(world, false);
  }

  choose_island(island: number): void {
    if (island !== this.island) {
      this.#watch(this.shown, island);
    }
  }

  close(): void {
    this.past.close();
    this.feed.unsubscribe();
    for (const end of this.#end) {
      end();
    }
  }

  #watch(world: string, island: number): void {
    this.#forget(world, island);
    this.selection.post();
    this.server.post({kind: "population", pane: this.feed.pane, columns: null});
    this.feed.subscribe();
    this.parameters.read();
    this.changes.notify();
  }

  /** Forgets everything about the island that was shown, because this one is shown next. */
  #forget(world: string, island: number): void {
    this.feed.forget(world, island);
    this.selection.forget();
    this.population.forget();
    this.parameters.set = null;
    this.control.forget();
  }

  // ---- what the worker and the server report ----

  #take(message: FromWorker): void {
    if (message.kind === "state") {
      if (message.state.phase === "open" && this.name) {
        this.past.session_opened(this.control);
        this.parameters.read();
        void this.history.read(this.name, true);
      }
      return;
    }
    if (!("pane" in message) || message.pane !== this.feed.pane) {
      return;
    }
    switch (message.kind) {
      case "snapshot":
        if (message.info.world !== this.shown || message.info.island !== this.island) {
          return; // of the world that was shown before
        }
        if (this.snapshot && this.snapshot.generation !== message.info.generation) {
          this.parameters.expire();
        }
        this.selection.follow_generation(message.info);
        this.feed.take(message);
        this.selection.take(message.selected);
        this.control.take(message.info);
        this.feed.taken.call(message.info);
        break;
      case "drawing":
        this.feed.drawing = message.drawing;
        break;
      case "watch_refused":
        this.feed.problem =
          this.past.opening ? "" : message.message; // a replay that ended with its session is being opened again
        break;
      default:
        return;
    }
    this.changes.notify();
  }

  #take_event(event: Event): void {
    const about = kind_of(event), is_live = event.world === this.name, is_shown = event.world === this.shown;
    switch (about?.kind) {
      case "events_dropped":
        this.parameters.read();
        this.history.read_missed();
        return;
      case "parameters_changed":
      case "change_planned":
      case "change_cancelled":
      case "change_dropped":
        if (is_shown) {
          this.parameters.read();
        }
        if (is_live && about.kind === "parameters_changed") {
          void this.history.read_changes();
        }
        break;
      case "placed":
      case "fitness_set":
        if (is_shown) {
          this.population.expire();
        }
        break;
      case "generation_finished":
        if (is_live) {
          this.history.append(about.value.statistics ?? []);
        }
        break;
      case "world_damaged":
        if (is_live && is_shown) {
          this.#watch(this.name, this.island); // the server refuses it with the reason
        }
        break;
      case "world_reset":
      case "world_created":
        if (is_live) {
          this.selection.forget();
          this.population.forget();
          this.selection.post();
          this.parameters.read();
        }
        break;
      case "run_control_changed":
      case "migration":
      case "extinction":
      case "run_terminated":
      case "world_deleted":
      case "server_going_away":
      case "storage_changed":
      case "removed":
      case "fitness_awaited":
      case "class_changed":
      case "note_added":
      case undefined:
        break;
      default:
        none_left(about);
    }
    if (is_live) {
      this.changes.notify();
    }
  }

  #server_changed(): void {
    if (this.history.is_of_earlier_run) {
      void this.history.read(this.name, false); // the world was reset
    }
    const is_there = this.server.worlds.find(this.name) !== null || this.server.worlds.damage_of(this.name) !== "";
    if (this.name && this.server.worlds.are_known && this.server.state.phase === "open" && !is_there) {
      this.past.close(); // the live world was deleted
      this.name = "";
      this.#forget("", 0);
      this.history.forget();
      this.feed.unsubscribe();
    }
    this.changes.notify();
  }

  #poll(): void {
    const {snapshot} = this;
    if (document.visibilityState === "hidden" || this.server.state.phase !== "open" || !this.shown || !snapshot) {
      return;
    }
    this.parameters.poll();
    this.past.poll();
    this.selection.poll(snapshot.tick);
    void this.population.poll();
  }
}
