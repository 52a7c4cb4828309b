// Worlds: the worlds of the server. Answers and events keep the list up to date.
import {kind_of, none_left} from "../core/messages";
import type {DamagedWorld, Event, WorldInfo, WorldList} from "../core/protocol";

/** A WorldInfo that always has these fields. */
export type KnownWorld = WorldInfo&Required<Pick<WorldInfo, "name"|"run_id"|"tick"|"generation"|"island_count">>;

function known_world(info: WorldInfo): KnownWorld {
  return {name: "", run_id: "", tick: 0, generation: 1, island_count: 1, ...info};
}

export class Worlds {
  /** Sorted by name. Includes the replays of this page. */
  all: KnownWorld[] = [];
  /** The worlds that do not run because the server cannot restore them, sorted by name. */
  damaged: (DamagedWorld&{name: string})[] = [];
  /** Whether the list of worlds of the present session has arrived. */
  are_known = false;
  #only_of: string|null = null; // only the worlds of this user are listed; null: all
  #hidden = new Set<string>(); // names of the worlds of other users
  #replays = new Set<string>(); // names of the replays that this session has opened
  readonly #on_change: () => void;

  constructor(on_change: () => void) {
    this.#on_change = on_change;
  }

  /** Lists only the worlds of this user; null: all. */
  show_only_of(user: string|null): void {
    this.#only_of = user;
  }

  /** Whether a world belongs to another user and is not listed. */
  hides(name: string): boolean {
    return this.#hidden.has(name);
  }

  #is_listed(world: WorldInfo): boolean {
    const listed =
      this.#only_of === null || (world.owner ?? "") === this.#only_of || this.#replays.has(world.name ?? "");
    this.#hidden[listed ? "delete" : "add"](world.name ?? "");
    return listed;
  }

  find(name: string): KnownWorld|null {
    return this.all.find((world) => world.name === name) ?? null;
  }

  /** Why a damaged world does not run, as a sentence; empty if the world is not damaged. */
  damage_of(name: string): string {
    return this.damaged.find((world) => world.name === name)?.reason ?? "";
  }

  /** The names of all worlds except replays, damaged ones too, in alphabetical order. */
  get names(): string[] {
    return [...this.all.filter((world) => !world.replay), ...this.damaged].map((world) => world.name).sort();
  }

  /** The names that a new world cannot have. */
  get taken_names(): string[] {
    return [...this.names, ...this.#hidden];
  }

  is_own_replay(name: string): boolean {
    return this.#replays.has(name);
  }

  /** Replays end with their session. */
  session_ended(): void {
    this.#replays.clear();
    this.all = this.all.filter((world) => !world.replay || world.replay.replay_of === undefined);
  }

  take_list({worlds = [], damaged = []}: WorldList): void {
    const replays = this.all.filter((world) => this.#replays.has(world.name));
    this.#hidden.clear();
    const listed = worlds.filter((world) => this.#is_listed(world));
    this.all =
      [...listed.map(known_world), ...replays.filter((replay) => !worlds.some((world) => world.name === replay.name))];
    this.#sort();
    this.damaged = this.#only_of === null ? damaged.map((world) => ({name: "", ...world})) : [];
    this.are_known = true;
    this.#on_change();
  }

  /** Takes a WorldInfo unless a newer one of the same run is known. An event about a command may arrive late. */
  put(world: WorldInfo): void {
    if (!this.#is_listed(world)) {
      return;
    }
    const info = known_world(world);
    const known = this.find(info.name);
    if (known && known.run_id === info.run_id && !info.replay && known.tick > info.tick) {
      return;
    }
    this.all = [...this.all.filter((world) => world.name !== info.name), info];
    this.#sort();
    this.#on_change();
  }

  /** This session has opened a replay. */
  replay_opened(replay: WorldInfo): void {
    this.#replays.add(replay.name ?? "");
    this.put(replay);
  }

  replay_closed(name: string): void {
    this.#replays.delete(name);
    this.#remove(name);
  }

  take_event(event: Event): void {
    const world = event.world ?? "", about = kind_of(event);
    switch (about?.kind) {
      case "run_control_changed":
      case "world_created":
      case "world_reset":
        if (about.value.world) {
          this.put(about.value.world);
        }
        return;
      case "world_deleted":
        this.#remove(world);
        return;
      case "world_damaged":
        this.#remove(world);
        this.damaged = [...this.damaged, {name: world, run_id: event.run_id, reason: about.value.reason}].sort(
          (one, other) => (one.name < other.name ? -1 : 1));
        return;
      case "run_terminated":
        this.#change(world, {state: "RUN_STATE_TERMINATED", outcome: about.value.outcome});
        return;
      case "generation_finished": {
        const finished = about.value.statistics?.[0]?.generation ?? 0;
        this.#change(world, {generation: finished + 1, tick: event.tick ?? 0, awaited_fitness: undefined});
        return;
      }
      case "fitness_awaited":
        this.#change(world, {awaited_fitness: about.value});
        return;
      case "storage_changed":
        this.#change(world, {storage: about.value.storage});
        return;
      case "server_going_away":
      case "events_dropped":
      case "parameters_changed":
      case "migration":
      case "extinction":
      case "change_dropped":
      case "change_planned":
      case "change_cancelled":
      case "placed":
      case "removed":
      case "fitness_set":
      case "class_changed":
      case "note_added":
      case undefined:
        return;
      default:
        none_left(about);
    }
  }

  #change(name: string, fields: Partial<KnownWorld>): void {
    const known = this.find(name);
    if (known) {
      this.all = this.all.map((world) => (world === known ? {...world, ...fields} : world));
      this.#on_change();
    }
  }

  #remove(name: string): void {
    this.all = this.all.filter((world) => world.name !== name);
    this.damaged = this.damaged.filter((world) => world.name !== name);
    this.#on_change();
  }

  #sort(): void {
    this.all.sort((one, other) => (one.name < other.name ? -1 : one.name > other.name ? 1 : 0));
  }
}
