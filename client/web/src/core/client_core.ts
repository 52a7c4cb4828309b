// The client side of the protocol, as a state machine without sockets and clocks (the model is
// client/python/evod/core.py).
//
// The owner of the socket calls opened(), received() and lost(), and after every call of any method sends the bytes
// that outgoing() returns. received(), lost() and close() return what happened as CoreEvents, in order. A "close" event
// is the last of its list: the owner then closes the socket, calls lost(), and connects again unless `failed` is set.
//
// After a reconnect the core sends its Hello, subscribes again, and repeats every unanswered request with the same
// client_key and request_id. The repetition is idempotent, because the server has a reply cache: it applies each
// command once. Requests that contain an id of their session fail with it: those about subscriptions, exports and
// replays.
//
// Members      More than 30: requests, subscriptions and streams of snapshots begin and end together with a session, so
//              each of its methods changes several of them.
//
// Bounds       Requests beyond the server's limit are queued here. Every snapshot of a subscription with
//              unacknowledged_max has to be passed to acknowledge(), after it was drawn or dropped.
import {DamagedData, InvalidMessage, SessionEnded} from "./errors";
import {control_channel, encode_frame, FrameReader} from "./frames";
import type {RequestKind, Tagged} from "./messages";
import type {
  ClientMessage, Event, Hello, Request, Response, ServerMessage, SnapshotFrame, Status, SubscribeEvents,
  SubscribeSnapshots, View, Welcome} from "./protocol";
import {Schema} from "./protobuf";
import type {Snapshot} from "./snapshot";
import {is_keyframe, SnapshotDecoder} from "./snapshot_decoder";

export const protocol_version = 1;
const keyframe_requests_max = 3; // consecutive keyframe requests without a decoded snapshot in between
const control_frame_bytes_max = 1 << 20; // until the server has stated its limit

/** Requests that contain an id which is valid only in its session. They fail when the session ends. */
const session_requests: ReadonlySet<RequestKind> =
  new Set(["unsubscribe", "request_keyframe", "set_view", "continue_export"]);

/** A Goodbye with one of these codes ends the client: another session would end for the same reason. */
const final_codes = new Set(["CODE_UNAUTHENTICATED", "CODE_PERMISSION_DENIED", "CODE_INVALID_ARGUMENT"]);

interface CoreEvents {
  opened: {welcome: Welcome}; // there is a session
  response: {id: number; response: Response}; // refusals included: response.status
  failed: {id: number; message: string; code: string}; // no answer can arrive any more
  event: {subscription: Subscription; event: Event};
  snapshot: {subscription: Subscription; snapshot: Snapshot};
  damaged: {subscription: Subscription; message: string}; // a snapshot was dropped, and a keyframe requested
  subscribed: {subscription: Subscription}; // in this session
  subscription_refused: {subscription: Subscription; status: Status};
  view_refused: {subscription: Subscription; status: Status}; // the previous view stays
  close: {message: string; code: string}; // close the socket; see `failed` for whether to connect again
}

/** What happened. */
export type CoreEvent = Tagged<CoreEvents>;

/** Why there is no session, or why none is possible. */
export interface Loss {
  message: string; // a sentence
  code: string; // "CODE_UNAUTHENTICATED" …; empty if there is none
}

type SubscriptionRequest = {
  subscribe_snapshots: SubscribeSnapshots;
  subscribe_events?: undefined
}|{
  subscribe_events: SubscribeEvents;
  subscribe_snapshots?: undefined
};

/** A subscription that continues after a reconnect, until unsubscribe(). The fields are set by the core. */
export interface Subscription {
  readonly request: SubscriptionRequest;
  server_id: number|null; // in this session; null: not accepted yet
  request_id: number|null; // of the unanswered request
  refused: Status|null; // if the server has refused it
  sessions: number; // in which the server accepted it
  rate_hz: number; // snapshots per second that the server granted
  ended: boolean;
}

export interface CoreOptions {
  client_name: string; // at most 64 bytes
  client_version: string;
  token: string; // empty: none
  server: string; // names the server in messages: "127.0.0.1:7745"
  frame_bytes_max?: number; // Hello.frame_bytes_max
}

interface Pending {
  kind: RequestKind|"";
  ends_with_session: boolean;
  frame: Uint8Array;
  sent: boolean; // in this session
}

/** The snapshots of one island for one subscription, in this session. */
interface StreamState {
  decoder: SnapshotDecoder;
  keyframe_needed: boolean;
  keyframe_requests: number; // since the last decoded snapshot
}

/** What a subscription to snapshots needs besides its public fields. */
interface ViewState {
  wanted: View|null; // the newest one of set_view(), if it was not sent
  sent: View|null; // the one in the unanswered SetView
  request_id: number|null; // of that SetView
}

export class ClientCore {
  readonly schema: Schema;
  readonly client_key = random_key();
  welcome: Welcome|null = null; // received in the current or the last session
  connected = false; // the server has sent its Welcome on the current connection
  failed: Loss|null = null; // why reconnecting is pointless; null: connect again
  loss: Loss|null = null; // why there is no session at present
  retry_late = false; // the server is full: connect again only after the longest wait
  damaged_snapshot_count = 0;

  readonly #hello: Hello;
  readonly #server: string;
  #reader = new FrameReader();
  #queued: Uint8Array[] = []; // frames to send
  #events: CoreEvent[] = [];
  #last_request_id = 0;
  readonly #pending = new Map<number, Pending>(); // by request_id, in the order of the calls
  readonly #first = new Set<number>(); // ids of the requests to send before all others
  readonly #in_flight = new Set<number>(); // unanswered requests of this session, even if no caller waits
  readonly #own = new Set<number>(); // ids of the requests of this core itself
  readonly #abandoned_replays = new Set<number>(); // unanswered OpenReplay requests whose callers no longer wait
  readonly #own_replays = new Set<string>(); // names of the replays that this session has opened
  readonly #ended_replays = new Set<string>(); // names of the replays that earlier sessions have opened
  readonly #subscriptions = new Set<Subscription>();
  readonly #of_server_id = new Map<number, Subscription>();
  readonly #streams = new Map<string, StreamState>(); // key: server_id and island
  readonly #views = new Map<Subscription, ViewState>();
  #unacknowledged = new WeakSet<Snapshot>(); // of this session

  /** descriptor: the serialised FileDescriptorSet of the server. Throws DamagedData. */
  constructor(descriptor: Uint8Array, options: CoreOptions) {
    this.schema = new Schema(descriptor);
    this.#server = options.server;
    this.#hello = {
      protocol_version,
      client_name: options.client_name,
      client_version: options.client_version,
      token: options.token,
      frame_bytes_max: options.frame_bytes_max ?? 0,
    };
  }

  // ---- the connection ----------------------------------------------------------------------------------------------

  /** Queues the Hello. Call it after connecting. */
  opened(): void {
    this.#queued = [];
    this.#reader = new FrameReader();
    this.retry_late = false;
    this.#send({hello: this.#hello});
  }

  /** Processes bytes from the server. The caller must not change them afterwards. */
  received(bytes: Uint8Array): CoreEvent[] {
    try {
      this.#reader.feed(bytes);
      for (let frame = this.#reader.next(); frame !== null; frame = this.#reader.next()) {
        if (frame.channel === control_channel) {
          this.#take_control(this.schema.decode("evod.v1.ServerMessage", frame.body));
        } else if (this.connected) {
          this.#take_snapshot(this.schema.decode("evod.v1.SnapshotFrame", frame.body));
        } else {
          throw new DamagedData("the first frame is a snapshot, not a Welcome");
        }
        if (this.#events.length > 0 && this.#events[this.#events.length - 1].kind === "close") {
          break;
        }
      }
    } catch (error) {
      if (!(error instanceof DamagedData)) {
        throw error;
      }
      if (this.connected) {
        this.#close_connection({message: `${this.#server} sent damaged data: ${error.message}`, code: ""});
      } else {
        this.failed = {message: `${this.#server} is not an evod server: ${error.message}`, code: ""};
        this.#close_connection(this.failed);
      }
    }
    return this.#take_events();
  }

  /** Call it when the connection was lost or could not be opened. Connect again afterwards, unless `failed` is set. */
  lost(loss: Loss): CoreEvent[] {
    this.connected = false;
    this.loss = loss;
    this.#queued = [];
    this.#in_flight.clear();
    this.#abandoned_replays.clear();
    this.#of_server_id.clear();
    this.#streams.clear();
    this.#unacknowledged = new WeakSet();
    for (const subscription of this.#subscriptions) {
      subscription.server_id = subscription.request_id = null;
    }
    for (const view of this.#views.values()) {
      view.wanted ??= view.sent; // whether the server accepts it is not known
      view.sent = view.request_id = null;
    }
    for (const replay of this.#own_replays) {
      this.#ended_replays.add(replay);
    }
    this.#own_replays.clear();
    const had_session = this.welcome !== null;
    for (const [id, pending] of [...this.#pending]) {
      const subscribes = pending.kind.startsWith("subscribe_");
      if (this.failed !== null || subscribes || (had_session && pending.ends_with_session)) {
        this.#pending.delete(id);
        this.#first.delete(id);
        if (!subscribes && !this.#own.has(id)) { // the Subscription continues
          this.#events.push({kind: "failed", id, ...loss});
        }
      }
      pending.sent = false;
    }
    this.#own.clear();
    return this.#take_events();
  }

  /** All pending requests fail. The core cannot be used again. */
  close(): CoreEvent[] {
    this.failed = {message: "the connection was closed here", code: ""};
    return this.lost(this.failed);
  }

  /** Removes and returns the bytes to send now; null if there are none. */
  outgoing(): Uint8Array|null {
    if (this.#queued.length <= 1) {
      return this.#queued.pop() ?? null;
    }
    const bytes = new Uint8Array(this.#queued.reduce((sum, frame) => sum + frame.length, 0));
    let at = 0;
    for (const frame of this.#queued) {
      bytes.set(frame, at);
      at += frame.length;
    }
    this.#queued = [];
    return bytes;
  }

  // ---- requests ----------------------------------------------------------------------------------------------------

  /** Queues a request without request_id and client_key, such as { pause: { world: "a" } }. It is sent when there is a
   *  session. Returns its request_id, which names it in the "response" or "failed" event.
   *
   *  first: send it before the requests that wait. Throws InvalidMessage if the request does not fit its type or is too
   *  long, or if `failed` is set. Throws SessionEnded if it contains an id of a session and there is none, or if it
   *  names a replay of an earlier session. */
  request(request: Request, first = false): number {
    if (this.failed !== null) {
      throw new InvalidMessage(this.failed.message);
    }
    const id = this.#last_request_id + 1, kind = request_kind(request), replay = replay_in(request);
    const ends_with_session = (kind !== "" && session_requests.has(kind)) || replay !== "";
    if (this.#ended_replays.has(replay)) {
      const status = replay_has_ended(replay);
      throw new SessionEnded(status.message ?? "", status);
    }
    if (this.loss !== null && this.welcome !== null && ends_with_session) {
      throw new SessionEnded(this.loss.message, null);
    }
    const body =
      this.schema.encode("evod.v1.ClientMessage", {request: {...request, request_id: id, client_key: this.client_key}});
    const limit = this.welcome?.limits?.control_frame_bytes_max ?? control_frame_bytes_max;
    if (body.length > limit) {
      throw new InvalidMessage(`the request is ${body.length} bytes long, allowed: at most ${limit}`);
    }
    this.#last_request_id = id;
    this.#pending.set(id, {kind, ends_with_session, frame: encode_frame(body), sent: false});
    if (first) {
      this.#first.add(id);
    }
    this.#send_waiting();
    return id;
  }

  /** Call it when the caller no longer waits: there will be no event for this request. The core closes a replay that
   *  the request opens. */
  forget(id: number): void {
    const pending = this.#pending.get(id);
    this.#pending.delete(id);
    this.#first.delete(id);
    if (pending?.kind === "open_replay" && pending.sent) {
      this.#abandoned_replays.add(id);
    }
  }

  // ---- subscriptions -----------------------------------------------------------------------------------------------

  /** Subscribes when there is a session, and again in each new session, until unsubscribe().
   *
   *  request: { subscribe_snapshots: {…} } or { subscribe_events: {…} }. The core keeps and changes this object. Throws
   *  InvalidMessage like request(). */
  subscribe(request: SubscriptionRequest): Subscription {
    if (this.failed !== null) {
      throw new InvalidMessage(this.failed.message);
    }
    this.schema.encode("evod.v1.Request", request); // throws now rather than in a later session
    const subscription:
      Subscription = {request, server_id: null, request_id: null, refused: null, sessions: 0, rate_hz: 0, ended: false};
    if (this.connected) {
      this.#resubscribe(subscription);
    }
    this.#subscriptions.add(subscription);
    return subscription;
  }

  /** Ends the subscription. */
  unsubscribe(subscription: Subscription): void {
    subscription.ended = true;
    this.#subscriptions.delete(subscription);
    this.#views.delete(subscription);
    if (subscription.server_id !== null) {
      this.#unsubscribe_from(subscription.server_id);
      subscription.server_id = null;
    }
  }

  /** Changes the view of a subscription to snapshots that began with one. At most one change is in flight; further ones
   *  replace each other until it is answered. */
  set_view(subscription: Subscription, view: View): void {
    if (!subscription.ended) {
      const state = this.#views.get(subscription) ?? {wanted: null, sent: null, request_id: null};
      state.wanted = view;
      this.#views.set(subscription, state);
      this.#send_view(subscription);
    }
  }

  /** Acknowledges a snapshot, so that the server can send another one. Does nothing if its session or subscription has
   *  ended, or if it is already acknowledged. */
  acknowledge(subscription: Subscription, snapshot: Snapshot): void {
    if (subscription.server_id !== null && this.#unacknowledged.delete(snapshot)) {
      this.#send_acknowledgement(subscription.server_id, snapshot.info.island, snapshot.info.sequence);
    }
  }

  // ---- private -----------------------------------------------------------------------------------------------------

  #take_events(): CoreEvent[] {
    const events = this.#events;
    this.#events = [];
    return events;
  }

  #close_connection(loss: Loss): void {
    this.#events.push({kind: "close", ...loss});
  }

  #send(message: ClientMessage): void {
    this.#queued.push(encode_frame(this.schema.encode("evod.v1.ClientMessage", message)));
  }

  #send_acknowledgement(subscription_id: number, island: number, sequence: number): void {
    this.#send({acknowledge_snapshot: {subscription_id, island, sequence}});
  }

  /** Queues a request of this core itself, which causes no event. It ends with the session. */
  #request_silently(request: Request): number {
    const id = this.request(request, true);
    this.#own.add(id);
    return id;
  }

  /** Sends queued requests, up to half of the server's limit on unanswered requests. */
  #send_waiting(): void {
    if (!this.connected || this.welcome === null) {
      return;
    }
    // The server counts a request until it has sent the complete answer. The answer may arrive here before the server
    // stops counting the request.
    const limit = Math.max(1, Math.floor((this.welcome.limits?.requests_in_flight_max ?? 32) / 2));
    for (const urgent of this.#first.size > 0 ? [true, false] : [false]) {
      for (const [id, pending] of this.#pending) {
        if (this.#in_flight.size >= limit) {
          return;
        }
        if (!pending.sent && this.#first.has(id) === urgent) {
          pending.sent = true;
          this.#in_flight.add(id);
          this.#queued.push(pending.frame);
        }
      }
    }
  }

  #take_control(message: ServerMessage): void {
    if (!this.connected) {
      this.#take_welcome(message);
    } else if (message.response !== undefined) {
      this.#take_response(message.response);
    } else if (message.event !== undefined) {
      this.#take_event(message.event);
    } else if (message.goodbye !== undefined) {
      const loss = loss_of(message.goodbye.status);
      this.retry_late = loss.code === "CODE_RESOURCE_EXHAUSTED";
      if (final_codes.has(loss.code)) {
        this.failed = loss;
      }
      this.#close_connection(loss);
    }
  }

  #take_welcome(message: ServerMessage): void {
    if (message.goodbye !== undefined) {
      const loss = loss_of(message.goodbye.status);
      const refused = {message: `the server at ${this.#server} refused this client: ${loss.message}`, code: loss.code};
      this.retry_late = loss.code === "CODE_RESOURCE_EXHAUSTED";
      if (loss.code !== "CODE_RESOURCE_EXHAUSTED" && loss.code !== "CODE_UNAVAILABLE") {
        this.failed = refused;
      }
      this.#close_connection(refused);
      return;
    }
    if (message.welcome === undefined) {
      throw new DamagedData("the first message is not a Welcome");
    }
    const version = message.welcome.protocol_version ?? 0;
    if (version !== protocol_version) {
      this.failed = {
        code: "",
        message: `the server at ${this.#server} uses protocol version ${version}, but this ` +
          `page uses ${protocol_version}: reload the page`
      };
      this.#close_connection(this.failed);
      return;
    }
    this.welcome = message.welcome;
    this.loss = null;
    this.#events.push({kind: "opened", welcome: message.welcome});
    // All subscriptions are sent first, so that subscribers receive the events that the other requests cause.
    for (const subscription of this.#subscriptions) {
      this.#resubscribe(subscription);
    }
    this.connected = true;
    this.#send_waiting();
  }

  #take_response(response: Response): void {
    const id = response.request_id ?? 0;
    this.#in_flight.delete(id);
    this.#first.delete(id);
    if (this.#abandoned_replays.delete(id) && response.world !== undefined) {
      this.request({close_replay: {world: response.world.name ?? ""}});
    }
    const pending = this.#pending.get(id);
    if (pending !== undefined && pending.sent) {
      this.#pending.delete(id);
      if (pending.kind === "open_replay" && response.world !== undefined) {
        this.#own_replays.add(response.world.name ?? "");
        this.#ended_replays.delete(response.world.name ?? "");
      }
      if (pending.kind.startsWith("subscribe_")) {
        this.#take_subscription(id, pending, response);
      } else if (this.#own.delete(id)) {
        this.#take_own(id, response);
      } else {
        this.#events.push({kind: "response", id, response});
      }
    }
    this.#send_waiting();
  }

  #resubscribe(subscription: Subscription): void {
    const replay = replay_in(subscription.request);
    if (this.#ended_replays.has(replay) || (replay !== "" && subscription.sessions > 0)) {
      subscription.refused = replay_has_ended(replay);
      this.#events.push({kind: "subscription_refused", subscription, status: subscription.refused});
    } else {
      subscription.request_id = this.request(subscription.request, true);
    }
  }

  #take_subscription(id: number, pending: Pending, response: Response): void {
    const server_id = response.subscription?.subscription_id ?? 0;
    const subscription = [...this.#subscriptions].find((known) => known.request_id === id);
    if (response.status?.code !== undefined) {
      if (subscription !== undefined) {
        subscription.request_id = null;
        subscription.refused = response.status;
        this.#events.push({kind: "subscription_refused", subscription, status: response.status});
      }
    } else if (subscription === undefined) {
      this.#unsubscribe_from(server_id);
    } else {
      subscription.request_id = subscription.refused = null;
      subscription.server_id = server_id;
      subscription.rate_hz = response.subscription?.rate_hz ?? 0;
      ++subscription.sessions;
      this.#of_server_id.set(server_id, subscription);
      this.#events.push({kind: "subscribed", subscription});
      if (subscription.sessions > 1 && pending.kind === "subscribe_events") {
        // The number of events missed between the sessions is not known, so the count is missing.
        this.#events.push({kind: "event", subscription, event: {events_dropped: {}}});
      }
      this.#send_view(subscription);
    }
  }

  #unsubscribe_from(server_id: number): void {
    this.#of_server_id.delete(server_id);
    for (const key of [...this.#streams.keys()]) {
      if (key.startsWith(`${server_id} `)) {
        this.#streams.delete(key);
      }
    }
    if (this.connected) {
      this.#request_silently({unsubscribe: {subscription_id: server_id}});
    }
  }

  /** Sends the wanted view of a subscription if there is one and no other change is in flight. */
  #send_view(subscription: Subscription): void {
    const state = this.#views.get(subscription);
    if (!state?.wanted || subscription.server_id === null || state.request_id !== null) {
      return;
    }
    state.sent = state.wanted;
    state.wanted = null;
    state.request_id = this.#request_silently({set_view: {subscription_id: subscription.server_id, view: state.sent}});
  }

  /** Takes the response to a request of this core itself. */
  #take_own(id: number, response: Response): void {
    for (const [subscription, state] of this.#views) {
      if (state.request_id === id) {
        if (response.status?.code !== undefined) {
          this.#events.push({kind: "view_refused", subscription, status: response.status});
        } else if (subscription.request.subscribe_snapshots && state.sent) {
          subscription.request.subscribe_snapshots.view = state.sent; // later sessions request it, too
        }
        state.sent = state.request_id = null;
        this.#send_view(subscription);
      }
    }
  }

  #take_event(event: Event): void {
    for (const subscription of this.#of_server_id.values()) {
      const events = subscription.request.subscribe_events, world = event.world ?? "";
      if (events !== undefined && (events.world === undefined || world === "" || events.world === world)) {
        this.#events.push({kind: "event", subscription, event});
      }
    }
  }

  #take_snapshot(frame: SnapshotFrame): void {
    const server_id = frame.subscription_id ?? 0, island = frame.island ?? 0;
    const subscription = this.#of_server_id.get(server_id);
    if (subscription === undefined) {
      return; // the subscription ended while the snapshot was in flight
    }
    const key = `${server_id} ${island}`;
    let stream = this.#streams.get(key);
    if (stream === undefined) {
      stream = {decoder: new SnapshotDecoder(), keyframe_needed: false, keyframe_requests: 0};
      this.#streams.set(key, stream);
    }
    if (!stream.keyframe_needed || is_keyframe(frame)) {
      try {
        const snapshot = stream.decoder.decode(frame);
        stream.keyframe_needed = false;
        stream.keyframe_requests = 0;
        this.#unacknowledged.add(snapshot);
        this.#events.push({kind: "snapshot", subscription, snapshot});
        return;
      } catch (error) {
        if (!(error instanceof DamagedData)) {
          throw error;
        }
        ++this.damaged_snapshot_count;
        stream.keyframe_needed = true;
        if (++stream.keyframe_requests > keyframe_requests_max) { // keyframes are damaged too
          throw error;
        }
        this.#events.push({kind: "damaged", subscription, message: error.message});
        this.#request_silently({request_keyframe: {subscription_id: server_id}});
      }
    }
    this.#send_acknowledgement(server_id, island, frame.sequence ?? 0);
  }
}

/** Whether a name is that of a replay, which ends with its session: "default@3". */
export function is_name_of_replay(world: string): boolean {
  return world.includes("@");
}

/** Returns the kind of a Request; empty if it has none. */
function request_kind(request: Request): RequestKind|"" {
  const fields = Object.keys(request) as (keyof Request)[];
  const is_kind = (field: keyof Request): field is RequestKind => field !== "request_id" && field !== "client_key";
  return fields.filter(is_kind).find((field) => request[field] !== undefined && request[field] !== null) ?? "";
}

/** Returns the name of the replay that a request names as its world: "default@3"; "" if it names none.
 *
 *  A replay ends with its session. Another session may use the name for another replay. */
function replay_in(request: Request): string {
  const kind = request_kind(request), fields: {world?: unknown} = kind === "" ? {} : request[kind] ?? {};
  const world = fields.world;
  return typeof world === "string" && is_name_of_replay(world) ? world : "";
}

/** Returns the Status for a replay of an earlier session, as the server states it if it does not know the replay. */
function replay_has_ended(replay: string): Status {
  return {
    code: "CODE_NOT_FOUND",
    reason: "REASON_WORLD_NOT_FOUND",
    message: `the replay ${replay} has ended with its session`
  };
}

/** Returns the reason in a Status. */
function loss_of(status: Status|undefined): Loss {
  return {message: status?.message ?? "the server ended the session", code: status?.code ?? ""};
}

/** Returns 32 random hexadecimal digits. */
function random_key(): string {
  return Array.from(crypto.getRandomValues(new Uint8Array(16)), (byte) => byte.toString(16).padStart(2, "0")).join("");
}
