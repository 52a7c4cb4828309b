// Server: the connection to the server, as the page sees it. The worker owns the socket.
//
// Every request goes through respond(), whose answers and events keep `worlds` up to date. The page opens watching:
// until the user takes part, may() allows only requests that change nothing for others.
//
// Members  More than 30: what may be sent depends on the session, the role and the replays of the session, and answers
//          and events change the list of worlds, so the page asks one object about all of them.
import {access_texts} from "../texts/access";
import {refusal_text} from "../texts/refusals";

import {Changes} from "./changes";
import {of_tab} from "./storage";

import {
  type ConnectionState,
  type Figures,
  type FromWorker,
  kind_of,
  none_left,
  type RequestKind,
  type ToWorker
} from "../core/messages";
import type {
  Answers, DamagedWorld, Event, Limits, ParameterDescription, RequestKinds, RequestRules, Response, Role, Storage,
  WorldInfo} from "../core/protocol";
import type {Snapshot} from "../core/snapshot";

/** A refusal of the server. `violations` name the wrong fields. */
export class Refusal extends Error {
  constructor(message: string, readonly code: string, readonly reason: string, readonly violations: {
    field: string; allowed: string; got: string
  }[]) {
    super(message);
  }
}

/** Requests that change something for other clients. */
const changing_kinds: ReadonlySet<string> =
  new Set(["REQUEST_KIND_COMMAND", "REQUEST_KIND_LEASE", "REQUEST_KIND_SERVER"]);

const own_event_ms = 3000;

type Waiting = {
  kind: RequestKind; world: string; resolve: (response: Response) => void; reject: (error: Refusal) => void
};

/** A WorldInfo that always has these fields. */
export type KnownWorld = WorldInfo&Required<Pick<WorldInfo, "name"|"run_id"|"tick"|"generation"|"island_count">>;

function known_world(info: WorldInfo): KnownWorld {
  return {name: "", run_id: "", tick: 0, generation: 1, island_count: 1, ...info};
}

export class Server {
  state: ConnectionState = {phase: "connecting", message: "", code: "", welcome: null};
  /** The registry, in order. Empty until the session is open. */
  parameters: ParameterDescription[] = [];
  limits: Limits = {};
  /** All worlds, sorted by name; kept up to date by events. Includes the replays of this page. */
  worlds: KnownWorld[] = [];
  /** The worlds that do not run because the server cannot restore them, sorted by name. */
  damaged: (DamagedWorld&{name: string})[] = [];
  /** Whether the list of worlds of the present session has arrived. */
  worlds_known = false;
  features: ReadonlySet<string> = new Set();
  /** Whether the server can write runs. null: it stores none. */
  storage: Storage|null = null;
  /** The server said that it is shutting down. */
  going_away = false;
  /** The server that answered after a reconnect has another version than the one that served this page. */
  updated = false;

  #worker: Worker;
  #rules = new Map<RequestKind, RequestRules>();
  #roles: string[] = []; // in rising order
  #last_id = 0;
  #waiting = new Map<number, Waiting>();
  #sent_ms = new Map<string, number>(); // when commands were sent last, by kind and world
  #replays = new Set<string>(); // names of the replays that this session has opened
  #changes = new Changes(false);
  #event_listeners = new Set<(event: Event) => void>();
  #message_listeners = new Set<(message: FromWorker) => void>();
  #first_version = "";
  #instance = "";
  #taking_part = of_tab.get("take_part") === "yes";

  /** descriptor: the serialised FileDescriptorSet of the protocol. */
  readonly #descriptor: ArrayBuffer;
  readonly #url: string;

  constructor(worker: Worker, descriptor: ArrayBuffer, url: string) {
    this.#descriptor = descriptor;
    this.#url = url;
    this.#worker = worker;
    worker.addEventListener("message", (event: MessageEvent<FromWorker>) => this.#take(event.data));
  }

  connect(token: string): void {
    this.state = {phase: "connecting", message: "", code: "", welcome: this.state.welcome};
    this.post({kind: "connect", url: this.#url, token, descriptor: this.#descriptor.slice(0)});
    this.#changes.notify();
  }

  post(message: ToWorker, transfer: Transferable[] = []): void {
    this.#worker.postMessage(message, transfer);
  }

  /** Calls `listener` with every message of the worker. */
  on_message(listener: (message: FromWorker) => void): () => void {
    this.#message_listeners.add(listener);
    return () => this.#message_listeners.delete(listener);
  }

  /** Calls `listener` after any change of state, registry or worlds. Returns a function that ends it. */
  on_change(listener: () => void): () => void {
    return this.#changes.listen(listener);
  }

  on_event(listener: (event: Event) => void): () => void {
    this.#event_listeners.add(listener);
    return () => this.#event_listeners.delete(listener);
  }

  get role(): Role {
    return this.state.welcome?.role ?? "ROLE_UNSPECIFIED";
  }

  get taking_part(): boolean {
    return this.#taking_part && this.may_take_part;
  }

  /** Whether the role of the session allows any change. */
  get may_take_part(): boolean {
    return this.role === "ROLE_CONTROLLER" || this.role === "ROLE_ADMIN";
  }

  set_taking_part(taking_part: boolean): void {
    this.#taking_part = taking_part;
    of_tab.set("take_part", taking_part ? "yes" : "");
    this.#changes.notify();
  }

  /** Whether the user may send this request now. `world` may be a replay that this page opened. */
  may(kind: RequestKind, world?: string): boolean {
    return this.why_not(kind, world) === "";
  }

  /** Why the user may not send this request now, as a sentence; empty if he may. */
  why_not(kind: RequestKind, world?: string): string {
    if (this.state.phase !== "open") {
      return access_texts.no_connection;
    }
    const rule = this.#rules.get(kind);
    if (!rule) {
      return access_texts.unknown_request;
    }
    const own_replay = world !== undefined && this.#replays.has(world);
    if (own_replay && rule.viewer_in_own_replay) {
      return "";
    }
    if (this.#roles.indexOf(this.role) < this.#roles.indexOf(rule.role ?? "ROLE_UNSPECIFIED")) {
      return rule.role === "ROLE_ADMIN" && this.role !== "ROLE_VIEWER" ? access_texts.admin_only :
                                                                         access_texts.read_only;
    }
    return changing_kinds.has(rule.kind ?? "") && !this.taking_part ? access_texts.watching : "";
  }

  /** Whether this page has sent such a command to the world within the last own_event_ms, so that the user knows of the
   *  event about it. */
  has_sent(kind: RequestKind, world: string): boolean {
    return performance.now() - (this.#sent_ms.get(`${kind} ${world}`) ?? -Infinity) < own_event_ms;
  }

  world(name: string): KnownWorld|null {
    return this.worlds.find((world) => world.name === name) ?? null;
  }

  /** Why a damaged world does not run, as a sentence; empty if the world is not damaged. */
  damage_of(name: string): string {
    return this.damaged.find((world) => world.name === name)?.reason ?? "";
  }

  /** The names of all worlds except replays, damaged ones too, in alphabetical order. */
  get world_names(): string[] {
    return [...this.worlds.filter((world) => !world.replay), ...this.damaged].map((world) => world.name).sort();
  }

  /** Sends {[kind]: fields}. Resolves with the answer inside the Response. Rejects with Refusal. */
  async request<Kind extends RequestKind>(kind: Kind, fields: RequestKinds[Kind]): Promise<Answers[Kind]> {
    const response = await this.respond(kind, fields), answer = this.#rules.get(kind)?.answer;
    return (answer ? response[answer as keyof Response] ?? {} : {}) as
      Answers[Kind]; // the rules of `kind` name its answer
  }

  /** Sends {[kind]: fields}. Resolves with the whole Response; applied_tick is there. Rejects with Refusal. */
  respond<Kind extends RequestKind>(kind: Kind, fields: RequestKinds[Kind]): Promise<Response> {
    return new Promise((resolve, reject) => {
      const id = ++this.#last_id, {world, name} = fields as {
        world?: string;
        name?: string
      };
      this.#waiting.set(id, {kind, world: world ?? "", resolve, reject});
      if (changing_kinds.has(this.#rules.get(kind)?.kind ?? "")) {
        this.#sent_ms.set(`${kind} ${world ?? name}`, performance.now());
      }
      this.post({kind: "request", id, request: {[kind]: fields}});
    });
  }

  /** For tests and benchmarks: figures of the worker. */
  figures(): Promise<Figures> {
    return this.#ask((id) => ({kind: "ask_figures", id}));
  }

  /** For tests: the entities of the newest snapshot in a pane; null if there is none. */
  columns(pane: number): Promise<Snapshot|null> {
    return this.#ask((id) => ({kind: "ask_columns", pane, id}));
  }

  #ask<Answer>(message_of: (id: number) => ToWorker): Promise<Answer> {
    return new Promise((resolve) => {
      const id = ++this.#last_id;
      const end = this.on_message((message) => {
        if ((message.kind === "figures" || message.kind === "columns") && message.id === id) {
          end();
          resolve((message.kind === "figures" ? message.figures : message.columns) as Answer);
        }
      });
      this.post(message_of(id));
    });
  }

  // ---- messages of the worker ----

  #take(message: FromWorker): void {
    switch (message.kind) {
      case "rules":
        this.#rules = message.rules;
        this.#roles = message.roles;
        break;
      case "state":
        this.#take_state(message.state);
        break;
      case "response": {
        const waiting = this.#waiting.get(message.id);
        this.#waiting.delete(message.id);
        if (waiting) {
          this.#take_response(waiting, message.response);
        }
        break;
      }
      case "failed": {
        const waiting = this.#waiting.get(message.id);
        this.#waiting.delete(message.id);
        waiting?.reject(new Refusal(message.message, "", "", []));
        break;
      }
      case "events":
        for (const event of message.events) {
          this.#take_event(event);
        }
        this.post({kind: "events_taken"});
        break;
    }
    for (const listener of [...this.#message_listeners]) {
      listener(message);
    }
  }

  #take_state(state: ConnectionState): void {
    const opened = state.phase === "open" && this.state.phase !== "open";
    if (state.phase !== "open" && this.state.phase === "open") {
      this.#replays.clear(); // replays end with their session
      this.worlds = this.worlds.filter((world) => !world.replay || world.replay.replay_of === undefined);
    }
    this.state = state;
    if (opened && state.welcome) {
      this.going_away = false;
      this.features = new Set(state.welcome.features);
      this.limits = state.welcome.limits ?? {};
      this.storage = state.welcome.storage ?? null;
      const version = state.welcome.server_version ?? "";
      this.#first_version ||= version;
      this.updated = version !== this.#first_version;
      void this.#open(state.welcome.instance_id ?? "");
    }
    this.#changes.notify();
  }

  async #open(instance: string): Promise<void> {
    try {
      const list = this.#list_worlds();
      if (instance !== this.#instance) {
        const description = await this.request("describe", {});
        this.parameters = description.parameters ?? [];
        this.#instance = instance;
      }
      await list;
    } catch {
      // The session ended meanwhile; the next one asks again.
    }
    this.#changes.notify();
  }

  /** Reads the progress of all worlds: events report only ends of generations and commands. */
  async refresh_worlds(): Promise<void> {
    await this.#list_worlds().catch(() => undefined);
  }

  async #list_worlds(): Promise<void> {
    const list = await this.request("list_worlds", {});
    const replays = this.worlds.filter((world) => this.#replays.has(world.name));
    this.worlds = [
      ...(list.worlds ?? []).map(known_world),
      ...replays.filter((replay) => !(list.worlds ?? []).some((world) => world.name === replay.name))
    ];
    this.#sort();
    this.damaged = (list.damaged ?? []).map((world) => ({name: "", ...world}));
    this.worlds_known = true;
    this.#changes.notify();
  }

  #take_response(waiting: Waiting, response: Response): void {
    const status = response.status;
    if (status) {
      waiting.reject(new Refusal(
        refusal_text(status), status.code ?? "", status.reason ?? "",
        (status.violations ?? [])
          .map((one) => ({field: one.field ?? "", allowed: one.allowed ?? "", got: one.got ?? ""}))));
      return;
    }
    if (waiting.kind === "open_replay" && response.world) {
      this.#replays.add(response.world.name ?? "");
    } else if (waiting.kind === "close_replay") {
      this.#replays.delete(waiting.world);
      this.#remove(waiting.world);
    }
    if (response.world) {
      this.#put(response.world);
    } else if (response.statistics?.world) {
      this.#put(response.statistics.world);
    }
    waiting.resolve(response);
  }

  #take_event(event: Event): void {
    this.#update_by(event);
    for (const listener of [...this.#event_listeners]) {
      listener(event);
    }
  }

  /** Keeps what is known about worlds and storage up to date. */
  #update_by(event: Event): void {
    const world = event.world ?? "", about = kind_of(event);
    switch (about?.kind) {
      case "run_control_changed":
      case "world_created":
      case "world_reset":
        if (about.value.world) {
          this.#put(about.value.world);
        }
        return;
      case "world_deleted":
        this.#remove(world);
        return;
      case "world_damaged":
        this.#remove(world);
        this.damaged = [...this.damaged, {name: world, run_id: event.run_id, reason: about.value.reason}].sort(
          (one, other) => (one.name < other.name ? -1 : 1));
        this.#changes.notify();
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
        if (world) {
          this.#change(world, {storage: about.value.storage});
        } else {
          this.storage = about.value.storage ?? null;
          this.#changes.notify();
        }
        return;
      case "server_going_away":
        this.going_away = true;
        this.#changes.notify();
        return;
      case "events_dropped":
        void this.#list_worlds().catch(() => undefined);
        return;
      case "parameters_changed":
      case "migration":
      case "extinction":
      case "change_dropped":
      case "change_planned":
      case "change_cancelled":
      case "placed":
      case "removed":
      case "fitness_set":
      case undefined:
        return;
      default:
        none_left(about);
    }
  }

  /** Takes a WorldInfo unless a newer one of the same run is known. An event about a command may arrive late. */
  #put(world: WorldInfo): void {
    const info = known_world(world);
    const known = this.world(info.name);
    if (known && known.run_id === info.run_id && !info.replay && known.tick > info.tick) {
      return;
    }
    this.worlds = [...this.worlds.filter((world) => world.name !== info.name), info];
    this.#sort();
    this.#changes.notify();
  }

  #change(name: string, fields: Partial<KnownWorld>): void {
    const known = this.world(name);
    if (known) {
      this.worlds = this.worlds.map((world) => (world === known ? {...world, ...fields} : world));
      this.#changes.notify();
    }
  }

  #remove(name: string): void {
    this.worlds = this.worlds.filter((world) => world.name !== name);
    this.damaged = this.damaged.filter((world) => world.name !== name);
    this.#changes.notify();
  }

  #sort(): void {
    this.worlds.sort((one, other) => (one.name < other.name ? -1 : one.name > other.name ? 1 : 0));
  }
}
