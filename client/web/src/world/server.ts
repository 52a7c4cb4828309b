// Server: the connection to the server, as the page sees it. The worker owns the socket.
//
// Every request goes through respond(), whose answers and events keep `worlds` up to date.
import {refusal_text} from "../texts/refusals";

import {Access} from "./access";
import {Changes, Listeners} from "./changes";
import {in_language} from "./parameters";
import {Worlds} from "./worlds";

import type {ConnectionState, FromWorker, RequestKind, ToWorker} from "../core/messages";
import type * as protocol from "../core/protocol";
import type {Answers, Event, ParameterDescription, RequestKinds, Response, Status, Storage} from "../core/protocol";

/** A wrong field of a request. */
export type Violation = Required<protocol.Violation>;

/** A refusal of the server. */
export class Refusal extends Error {
  constructor(message: string, readonly code: string, readonly reason: string, readonly violations: Violation[]) {
    super(message);
  }
}

const own_event_ms = 3000;

type Waiting = {
  kind: RequestKind; world: string; resolve: (response: Response) => void; reject: (error: Refusal) => void
};

export class Server {
  state: ConnectionState = {phase: "connecting", message: "", code: "", reason: "", silent_s: 0, welcome: null};
  /** The registry, in order. Empty until the session is open. */
  parameters: ParameterDescription[] = [];
  features: ReadonlySet<string> = new Set();
  /** Whether the server can write runs. null: it stores none. */
  storage: Storage|null = null;
  /** The server said that it is shutting down. */
  going_away = false;
  /** The server that answered after a reconnect has another version than the one that served this page. */
  updated = false;
  /** Calls its listeners after any change of state, registry or worlds. */
  readonly changes = new Changes(false);
  readonly events = new Listeners<Event>();
  readonly messages = new Listeners<FromWorker>(); // of the worker
  readonly worlds = new Worlds(() => this.changes.notify());
  readonly access = new Access(() => this.state, this.worlds, () => this.changes.notify());

  #worker: Worker;
  #last_id = 0;
  #waiting = new Map<number, Waiting>();
  #sent_ms = new Map<string, number>(); // when commands were sent last, by kind and world
  #first_version = "";
  #instance = "";
  #joins = false;

  /** descriptor: the serialised FileDescriptorSet of the protocol. */
  readonly #descriptor: ArrayBuffer;
  readonly #url: string;

  constructor(worker: Worker, descriptor: ArrayBuffer, url: string) {
    this.#descriptor = descriptor;
    this.#url = url;
    this.#worker = worker;
    worker.addEventListener("message", (event: MessageEvent<FromWorker>) => this.#take(event.data));
  }

  /** join: instead of a token: as a member of a class. */
  connect(token: string, join: protocol.Join|null = null): void {
    this.state = {phase: "connecting", message: "", code: "", reason: "", silent_s: 0, welcome: this.state.welcome};
    this.#joins = join !== null;
    this.post({kind: "connect", url: this.#url, token, join, descriptor: this.#descriptor.slice(0)});
    this.changes.notify();
  }

  /** Whether the page tries to become a member of a class, or has become one in this session. */
  get is_joining(): boolean {
    return this.#joins;
  }

  post(message: ToWorker, transfer: Transferable[] = []): void {
    this.#worker.postMessage(message, transfer);
  }

  /** Whether this page has sent such a command to the world within the last own_event_ms, so that the user knows of the
   *  event about it. */
  has_sent(kind: RequestKind, world: string): boolean {
    return performance.now() - (this.#sent_ms.get(`${kind} ${world}`) ?? -Infinity) < own_event_ms;
  }

  /** Sends {[kind]: fields}. Resolves with the answer inside the Response. Rejects with Refusal. */
  async request<Kind extends RequestKind>(kind: Kind, fields: RequestKinds[Kind]): Promise<Answers[Kind]> {
    const response = await this.respond(kind, fields), answer = this.access.rules.get(kind)?.answer;
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
      if (this.access.changes_others(kind)) {
        this.#sent_ms.set(`${kind} ${world ?? name}`, performance.now());
      }
      this.post({kind: "request", id, request: {[kind]: fields}});
    });
  }

  /** Reads the progress of all worlds: events report only ends of generations and commands. */
  async refresh_worlds(): Promise<void> {
    try {
      this.worlds.take_list(await this.request("list_worlds", {}));
    } catch {
      // The session ended; the next one asks again.
    }
  }

  // ---- messages of the worker ----

  #take(message: FromWorker): void {
    switch (message.kind) {
      case "rules":
        this.access.rules = message.rules;
        this.access.roles = message.roles;
        break;
      case "state":
        this.#take_state(message.state);
        break;
      case "response":
      case "failed": {
        const waiting = this.#waiting.get(message.id);
        this.#waiting.delete(message.id);
        if (message.kind === "failed") {
          waiting?.reject(new Refusal(message.message, "", "", []));
        } else if (waiting) {
          this.#take_response(waiting, message.response);
        }
        break;
      }
      case "events":
        message.events.forEach((event) => this.#take_event(event));
        this.post({kind: "events_taken"});
        break;
    }
    this.messages.call(message);
  }

  #take_state(state: ConnectionState): void {
    const opened = state.phase === "open" && this.state.phase !== "open";
    if (state.phase !== "open" && this.state.phase === "open") {
      this.worlds.session_ended();
    }
    this.state = state;
    if (opened && state.welcome) {
      this.going_away = false;
      this.features = new Set(state.welcome.features);
      this.storage = state.welcome.storage ?? null;
      const version = state.welcome.server_version ?? "";
      this.#first_version ||= version;
      this.updated = version !== this.#first_version;
      this.worlds.show_only_of(state.welcome.membership ? state.welcome.user ?? "" : null);
      void this.#open(state.welcome.instance_id ?? "");
    }
    this.changes.notify();
  }

  async #open(instance: string): Promise<void> {
    const list = this.refresh_worlds();
    void this.#read_classes();
    try {
      if (instance !== this.#instance) {
        const description = await this.request("describe", {});
        this.parameters = in_language(description.parameters ?? []);
        this.#instance = instance;
      }
    } catch {
      // The session ended; the next one asks again.
    }
    await list;
    this.changes.notify();
  }

  /** Reads which classes the teacher has. */
  async #read_classes(): Promise<void> {
    if (this.access.role === "ROLE_TEACHER") {
      try {
        const {classes = []} = await this.request("list_classes", {});
        this.access.classes = new Set(classes.map(({name = ""}) => name));
        this.changes.notify();
      } catch {
        // The session ended; the next one asks again.
      }
    }
  }

  #take_response(waiting: Waiting, response: Response): void {
    if (response.status) {
      waiting.reject(refusal_of(response.status));
      return;
    }
    const world = response.world ?? response.statistics?.world;
    if (waiting.kind === "close_replay") {
      this.worlds.replay_closed(waiting.world);
    } else if (waiting.kind === "open_replay" && world) {
      this.worlds.replay_opened(world);
    } else if (world) {
      this.worlds.put(world);
    }
    waiting.resolve(response);
  }

  #take_event(event: Event): void {
    if (this.worlds.hides(event.world ?? "")) {
      return;
    }
    this.worlds.take_event(event);
    if (this.worlds.hides(event.world ?? "")) {
      return; // another user has created it
    }
    if (event.class_changed && !this.access.classes.has(event.class_changed.class ?? "")) {
      void this.#read_classes();
    }
    if (event.storage_changed && !event.world) {
      this.storage = event.storage_changed.storage ?? null;
      this.changes.notify();
    } else if (event.server_going_away) {
      this.going_away = true;
      this.changes.notify();
    } else if (event.events_dropped) {
      void this.refresh_worlds();
    }
    this.events.call(event);
  }
}

function refusal_of(status: Status): Refusal {
  const violations = (status.violations ?? []).map(({field = "", allowed = "", got = ""}) => ({field, allowed, got}));
  return new Refusal(refusal_text(status), status.code ?? "", status.reason ?? "", violations);
}
