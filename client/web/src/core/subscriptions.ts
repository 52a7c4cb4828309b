// Subscriptions: the subscriptions of a ClientCore to events and snapshots, and the streams of snapshots that it
// decodes for them. After a reconnect, it subscribes again.
//
// Bounds  Every snapshot of a subscription with unacknowledged_max has to be passed to acknowledge(), after it was
//         drawn or dropped.
import type {CoreSession, Subscription, SubscriptionRequest} from "./core_session";
import {DamagedData, InvalidMessage} from "./errors";
import type {RequestKind} from "./messages";
import type {Event, Response, SnapshotFrame, View} from "./protocol";
import {replay_has_ended, replay_in, type RequestQueue} from "./request_queue";
import type {Snapshot} from "./snapshot";
import {is_keyframe, SnapshotDecoder} from "./snapshot_decoder";

const keyframe_requests_max = 3; // consecutive keyframe requests without a decoded snapshot in between

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

export class Subscriptions {
  damaged_snapshot_count = 0;
  readonly #all = new Set<Subscription>();
  readonly #of_server_id = new Map<number, Subscription>();
  readonly #streams = new Map<string, StreamState>(); // key: server_id and island
  readonly #views = new Map<Subscription, ViewState>();
  #unacknowledged = new WeakSet<Snapshot>(); // of this session
  readonly #core: CoreSession;
  readonly #requests: RequestQueue;

  constructor(core: CoreSession, requests: RequestQueue) {
    this.#core = core;
    this.#requests = requests;
  }

  /** Subscribes when there is a session, and again in each new session, until unsubscribe().
   *
   *  request: { subscribe_snapshots: {…} } or { subscribe_events: {…} }. The core keeps and changes this object. Throws
   *  InvalidMessage like RequestQueue.add(). */
  subscribe(request: SubscriptionRequest): Subscription {
    const core = this.#core;
    if (core.failed !== null) {
      throw new InvalidMessage(core.failed.message);
    }
    core.schema.encode("evod.v1.Request", request); // throws now rather than in a later session
    const subscription:
      Subscription = {request, server_id: null, request_id: null, refused: null, sessions: 0, rate_hz: 0, ended: false};
    if (core.connected) {
      this.#resubscribe(subscription);
    }
    this.#all.add(subscription);
    return subscription;
  }

  /** Ends the subscription. */
  unsubscribe(subscription: Subscription): void {
    subscription.ended = true;
    this.#all.delete(subscription);
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

  // ---- what the server sends ----

  /** Subscribes in a new session. */
  session_opened(): void {
    for (const subscription of this.#all) {
      this.#resubscribe(subscription);
    }
  }

  session_lost(): void {
    this.#of_server_id.clear();
    this.#streams.clear();
    this.#unacknowledged = new WeakSet();
    for (const subscription of this.#all) {
      subscription.server_id = subscription.request_id = null;
    }
    for (const view of this.#views.values()) {
      view.wanted ??= view.sent; // whether the server accepts it is not known
      view.sent = view.request_id = null;
    }
  }

  /** Takes the response to a request that subscribes. */
  take_response(id: number, kind: RequestKind|"", response: Response): void {
    const server_id = response.subscription?.subscription_id ?? 0;
    const subscription = [...this.#all].find((known) => known.request_id === id);
    if (response.status?.code !== undefined) {
      if (subscription !== undefined) {
        subscription.request_id = null;
        subscription.refused = response.status;
        this.#core.report({kind: "subscription_refused", subscription, status: response.status});
      }
    } else if (subscription === undefined) {
      this.#unsubscribe_from(server_id);
    } else {
      subscription.request_id = subscription.refused = null;
      subscription.server_id = server_id;
      subscription.rate_hz = response.subscription?.rate_hz ?? 0;
      ++subscription.sessions;
      this.#of_server_id.set(server_id, subscription);
      this.#core.report({kind: "subscribed", subscription});
      if (subscription.sessions > 1 && kind === "subscribe_events") {
        // The number of events missed between the sessions is not known, so the count is missing.
        this.#core.report({kind: "event", subscription, event: {events_dropped: {}}});
      }
      this.#send_view(subscription);
    }
  }

  /** Takes the response to a request of the core itself. */
  take_own_response(id: number, response: Response): void {
    for (const [subscription, state] of this.#views) {
      if (state.request_id === id) {
        if (response.status?.code !== undefined) {
          this.#core.report({kind: "view_refused", subscription, status: response.status});
        } else if (subscription.request.subscribe_snapshots && state.sent) {
          subscription.request.subscribe_snapshots.view = state.sent; // later sessions request it, too
        }
        state.sent = state.request_id = null;
        this.#send_view(subscription);
      }
    }
  }

  /** Reports the event to the subscriptions that want it. */
  take_event(event: Event): void {
    for (const subscription of this.#of_server_id.values()) {
      const events = subscription.request.subscribe_events, world = event.world ?? "";
      if (events !== undefined && (events.world === undefined || world === "" || events.world === world)) {
        this.#core.report({kind: "event", subscription, event});
      }
    }
  }

  take_snapshot(frame: SnapshotFrame): void {
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
        this.#core.report({kind: "snapshot", subscription, snapshot});
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
        this.#core.report({kind: "damaged", subscription, message: error.message});
        this.#requests.add_own({request_keyframe: {subscription_id: server_id}});
      }
    }
    this.#send_acknowledgement(server_id, island, frame.sequence ?? 0);
  }

  // ---- private ----

  #resubscribe(subscription: Subscription): void {
    const replay = replay_in(subscription.request);
    const ended = replay !== "" && subscription.sessions > 0 ? replay_has_ended(replay) :
                                                               this.#requests.replay_ended(subscription.request);
    if (ended) {
      subscription.refused = ended;
      this.#core.report({kind: "subscription_refused", subscription, status: ended});
    } else {
      subscription.request_id = this.#requests.add(subscription.request, true);
    }
  }

  #unsubscribe_from(server_id: number): void {
    this.#of_server_id.delete(server_id);
    for (const key of [...this.#streams.keys()]) {
      if (key.startsWith(`${server_id} `)) {
        this.#streams.delete(key);
      }
    }
    if (this.#core.connected) {
      this.#requests.add_own({unsubscribe: {subscription_id: server_id}});
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
    state.request_id = this.#requests.add_own({set_view: {subscription_id: subscription.server_id, view: state.sent}});
  }

  #send_acknowledgement(subscription_id: number, island: number, sequence: number): void {
    this.#core.send({acknowledge_snapshot: {subscription_id, island, sequence}});
  }
}
