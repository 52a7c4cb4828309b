// CoreSession: what the parts of a ClientCore share, what they report, and what they say about subscriptions.
import type {Tagged} from "./messages";
import type {Schema} from "./protobuf";
import type {
  ClientMessage, Event, Response, Status, SubscribeEvents, SubscribeSnapshots, Welcome} from "./protocol";
import type {Snapshot} from "./snapshot";

/** The connection, as the parts of a ClientCore see it. */
export interface CoreSession {
  readonly schema: Schema;
  readonly welcome: Welcome|null; // received in the current or the last session
  readonly connected: boolean; // the server has sent its Welcome on the current connection
  readonly failed: Loss|null; // why reconnecting is pointless; null: connect again
  readonly loss: Loss|null; // why there is no session at present
  /** Queues a message. */
  send(message: ClientMessage): void;
  /** Queues an encoded message. */
  send_frame(frame: Uint8Array): void;
  /** Adds to what the next call returns. */
  report(event: CoreEvent): void;
}

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
  reason?: string|undefined; // "REASON_TOKEN_UNKNOWN" …
}

export type SubscriptionRequest = {
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
