// RequestQueue: the requests of a ClientCore that have no answer yet.
//
// After a reconnect, it repeats every unanswered request with the same client_key and request_id. The repetition is
// idempotent, because the server has a reply cache: it applies each command once. Requests that contain an id of their
// session fail with it: those about subscriptions, exports and replays.
//
// Bounds  Requests beyond the server's limit are queued here.
import type {CoreSession, Loss} from "./core_session";
import {InvalidMessage, SessionEnded} from "./errors";
import {encode_frame} from "./frames";
import type {RequestKind} from "./messages";
import type {Request, Response, Status} from "./protocol";

const control_frame_bytes_max = 1 << 20; // until the server has stated its limit

/** Requests that contain an id which is valid only in its session. They fail when the session ends. */
const session_requests: ReadonlySet<RequestKind> =
  new Set(["unsubscribe", "request_keyframe", "set_view", "continue_export"]);

interface Pending {
  kind: RequestKind|"";
  ends_with_session: boolean;
  frame: Uint8Array;
  sent: boolean; // in this session
}

/** A request that was answered. */
export interface AnsweredRequest {
  kind: RequestKind|"";
  is_own: boolean; // of the core itself
}

export class RequestQueue {
  readonly client_key = random_key();
  #last_id = 0;
  readonly #pending = new Map<number, Pending>(); // by request_id, in the order of the calls
  readonly #first = new Set<number>(); // ids of the requests to send before all others
  readonly #in_flight = new Set<number>(); // unanswered requests of this session, even if no caller waits
  readonly #own = new Set<number>(); // ids of the requests of the core itself
  readonly #abandoned_replays = new Set<number>(); // unanswered OpenReplay requests whose callers no longer wait
  readonly #own_replays = new Set<string>(); // names of the replays that this session has opened
  readonly #ended_replays = new Set<string>(); // names of the replays that earlier sessions have opened
  readonly #core: CoreSession;

  constructor(core: CoreSession) {
    this.#core = core;
  }

  /** Queues a request without request_id and client_key, such as { pause: { world: "a" } }. It is sent when there is a
   *  session. Returns its request_id, which names it in the "response" or "failed" event.
   *
   *  first: send it before the requests that wait. Throws InvalidMessage if the request does not fit its type or is too
   *  long, or if `failed` is set. Throws SessionEnded if it contains an id of a session and there is none, or if it
   *  names a replay of an earlier session. */
  add(request: Request, first = false): number {
    const core = this.#core;
    if (core.failed !== null) {
      throw new InvalidMessage(core.failed.message);
    }
    const id = this.#last_id + 1, kind = request_kind(request), replay = replay_in(request);
    const ends_with_session = (kind !== "" && session_requests.has(kind)) || replay !== "";
    if (this.#ended_replays.has(replay)) {
      const status = replay_has_ended(replay);
      throw new SessionEnded(status.message ?? "", status);
    }
    if (core.loss !== null && core.welcome !== null && ends_with_session) {
      throw new SessionEnded(core.loss.message, null);
    }
    const body =
      core.schema.encode("evod.v1.ClientMessage", {request: {...request, request_id: id, client_key: this.client_key}});
    const limit = core.welcome?.limits?.control_frame_bytes_max ?? control_frame_bytes_max;
    if (body.length > limit) {
      throw new InvalidMessage(`the request is ${body.length} bytes long, allowed: at most ${limit}`);
    }
    this.#last_id = id;
    this.#pending.set(id, {kind, ends_with_session, frame: encode_frame(body), sent: false});
    if (first) {
      this.#first.add(id);
    }
    this.send_waiting();
    return id;
  }

  /** Queues a request of the core itself, which causes no event. It ends with the session. */
  add_own(request: Request): number {
    const id = this.add(request, true);
    this.#own.add(id);
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

  /** Sends queued requests, up to half of the server's limit on unanswered requests. */
  send_waiting(): void {
    const {connected, welcome} = this.#core;
    if (!connected || welcome === null) {
      return;
    }
    // The server counts a request until it has sent the complete answer. The answer may arrive here before the server
    // stops counting the request.
    const limit = Math.max(1, Math.floor((welcome.limits?.requests_in_flight_max ?? 32) / 2));
    for (const urgent of this.#first.size > 0 ? [true, false] : [false]) {
      for (const [id, pending] of this.#pending) {
        if (this.#in_flight.size >= limit) {
          return;
        }
        if (!pending.sent && this.#first.has(id) === urgent) {
          pending.sent = true;
          this.#in_flight.add(id);
          this.#core.send_frame(pending.frame);
        }
      }
    }
  }

  /** Takes a response. Returns the request; null if no caller waits for it. */
  take(response: Response): AnsweredRequest|null {
    const id = response.request_id ?? 0, pending = this.#pending.get(id), replay = response.world?.name ?? "";
    this.#in_flight.delete(id);
    this.#first.delete(id);
    if (this.#abandoned_replays.delete(id) && response.world !== undefined) {
      this.add({close_replay: {world: replay}});
    }
    if (pending === undefined || !pending.sent) {
      return null;
    }
    this.#pending.delete(id);
    if (pending.kind === "open_replay" && response.world !== undefined) {
      this.#own_replays.add(replay);
      this.#ended_replays.delete(replay);
    }
    return {kind: pending.kind, is_own: this.#own.delete(id)};
  }

  /** Why a replay that a request names is not there: an earlier session has opened it; null if none has. */
  replay_ended(request: Request): Status|null {
    const replay = replay_in(request);
    return this.#ended_replays.has(replay) ? replay_has_ended(replay) : null;
  }

  session_lost(loss: Loss): void {
    const {failed, welcome} = this.#core;
    this.#in_flight.clear();
    this.#abandoned_replays.clear();
    for (const replay of this.#own_replays) {
      this.#ended_replays.add(replay);
    }
    this.#own_replays.clear();
    for (const [id, pending] of [...this.#pending]) {
      const subscribes = pending.kind.startsWith("subscribe_");
      if (failed !== null || subscribes || (welcome !== null && pending.ends_with_session)) {
        this.#pending.delete(id);
        this.#first.delete(id);
        if (!subscribes && !this.#own.has(id)) { // the Subscription continues
          this.#core.report({kind: "failed", id, ...loss});
        }
      }
      pending.sent = false;
    }
    this.#own.clear();
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
export function replay_in(request: Request): string {
  const kind = request_kind(request), fields: {world?: unknown} = kind === "" ? {} : request[kind] ?? {};
  const world = fields.world;
  return typeof world === "string" && is_name_of_replay(world) ? world : "";
}

/** Returns the Status for a replay of an earlier session, as the server states it if it does not know the replay. */
export function replay_has_ended(replay: string): Status {
  return {
    code: "CODE_NOT_FOUND",
    reason: "REASON_WORLD_NOT_FOUND",
    message: `the replay ${replay} has ended with its session`
  };
}

/** Returns 32 random hexadecimal digits. */
function random_key(): string {
  return Array.from(crypto.getRandomValues(new Uint8Array(16)), (byte) => byte.toString(16).padStart(2, "0")).join("");
}
