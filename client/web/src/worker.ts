// worker: owns the socket, the protocol core, the decoder and the canvases, so that the page stays responsive.
//
// Flow control   A snapshot is acknowledged after the frame that contains it is drawn, and the server sends at most
//                unacknowledged_max snapshots ahead. A hidden page draws nothing, so the server soon stops sending;
//                after hidden_max_ms the worker ends its subscriptions to snapshots until the page is visible again.
import type {CoreEvent, Subscription} from "./core/core_session";
import {InvalidMessage} from "./core/errors";
import {EventQueue} from "./core/event_queue";
import {type Figures, type FromWorker, none_left, type ToWorker} from "./core/messages";
import type {Join, Request} from "./core/protocol";
import {is_name_of_replay} from "./core/request_queue";
import type {Snapshot} from "./core/snapshot";
import {worker_texts} from "./texts/worker";
import {Connection} from "./worker/connection";
import {WorkerPane} from "./worker/pane";
import {Timings} from "./worker/timings";
import {WorkerWall} from "./worker/wall";

const hidden_max_ms = 60_000;
const events_max = 1000; // events that wait for the page
const events_interval_ms = 30; // between two messages with events
const frame_ms = 16, frame_max_ms = 200; // between two frames, without and with animation frames

const scope = self as unknown as {
  postMessage(message: FromWorker): void;
  onmessage: ((event: MessageEvent<ToWorker>) => void)|null;
  requestAnimationFrame?: (callback: () => void) => number;
  cancelAnimationFrame?: (request: number) => void;
};

const timings = new Timings();
const connection = new Connection({take, changed: (state) => scope.postMessage({kind: "state", state})}, timings);
let is_visible = true;
let hidden_timer = 0;
const event_queue = new EventQueue(events_max);
let events_sent = false; // the page has not taken them yet, or took them less than events_interval_ms ago
let is_looping = false;
const panes = new Map<number, WorkerPane>();
const wall = new WorkerWall(connection);
const ids = new Map<number, number>(); // ids of the page by ids of the core

function begin(url: string, token: string, join: Join|null, descriptor: ArrayBuffer): void {
  const core = connection.begin(url, token, join, new Uint8Array(descriptor));
  scope.postMessage({kind: "rules", rules: core.schema.request_rules(), roles: core.schema.enum_names("evod.v1.Role")});
  core.subscriptions.subscribe({subscribe_events: {}});
  for (const {feed} of panes.values()) {
    feed.forget();
    if (feed.watched && is_name_of_replay(feed.watched.world)) {
      feed.watch(null, feed.islands); // it has ended with the last session; the page opens it again
    }
  }
  panes.forEach((pane) => pane.start());
  wall.start();
  connection.open();
}

/** Sends the queued events unless the page has not taken the last ones. */
function send_events(): void {
  if (!events_sent && !event_queue.is_empty) {
    events_sent = true;
    scope.postMessage({kind: "events", events: event_queue.take()});
  }
}

// ---- what the core reports
// ---------------------------------------------------------------------------------------------

function take(events: CoreEvent[]): void {
  for (const event of events) {
    switch (event.kind) {
      case "opened":
        connection.opened();
        break;
      case "response":
        answer(event.id, (id) => ({kind: "response", id, response: event.response}));
        break;
      case "failed":
        answer(event.id, (id) => ({kind: "failed", id, message: event.message}));
        break;
      case "event":
        event_queue.push(event.event);
        send_events();
        break;
      case "snapshot":
        take_snapshot(event.subscription, event.snapshot);
        break;
      case "subscribed":
        panes_of(event.subscription).forEach(([, pane]) => pane.subscribed());
        break;
      case "subscription_refused":
        for (const [number, pane] of panes_of(event.subscription)) {
          pane.stop();
          const message = event.status.message ?? worker_texts.snapshots_refused;
          scope.postMessage({kind: "watch_refused", pane: number, message});
        }
        break;
      case "damaged": // the core has requested a keyframe
      case "view_refused": // the view before stays
        break;
      case "close":
        connection.lose(event.message, event.code);
        break;
      default:
        none_left(event);
    }
  }
}

/** Posts the answer to one of the requests of the page. */
function answer(id_of_core: number, message: (id: number) => FromWorker): void {
  const id = ids.get(id_of_core);
  ids.delete(id_of_core);
  if (id !== undefined) {
    scope.postMessage(message(id));
  }
}

function panes_of(subscription: Subscription): [number, WorkerPane][] {
  return [...panes].filter(([, {feed}]) => feed.subscription === subscription);
}

function take_snapshot(subscription: Subscription, snapshot: Snapshot): void {
  timings.snapshot_count += 1;
  const now_ms = performance.now();
  const is_taken = wall.take_snapshot(subscription, snapshot, now_ms) ||
    [...panes.values()].some((pane) => pane.take_snapshot(subscription, snapshot, now_ms));
  if (!is_taken) {
    connection.core!.subscriptions.acknowledge(subscription, snapshot);
  }
  loop();
}

// ---- frames
// ------------------------------------------------------------------------------------------------------------

function loop(): void {
  if (is_looping || !is_visible) {
    return;
  }
  is_looping = true;
  const frame = (): void => {
    clearTimeout(timer);
    scope.cancelAnimationFrame?.(request);
    is_looping = false;
    if (draw()) {
      loop();
    }
  };
  // A browser that is short of time gives no animation frames for seconds; the page then shows few images, but recent
  // ones.
  const timer = setTimeout(frame, scope.requestAnimationFrame ? frame_max_ms : frame_ms);
  const request = scope.requestAnimationFrame?.(frame) ?? 0;
}

/** Draws all panes that need it. Returns whether another frame is needed. */
function draw(): boolean {
  const now_ms = performance.now(), {core} = connection;
  const acknowledge = (of: Subscription, snapshot: Snapshot): void => core?.subscriptions.acknowledge(of, snapshot);
  let drawn = wall.draw(now_ms, acknowledge), again = wall.needs_frame;
  for (const pane of panes.values()) {
    drawn = pane.draw(now_ms, acknowledge) || drawn;
    again = pane.report(now_ms) || pane.needs_frame(now_ms) || again;
  }
  if (drawn) {
    connection.flush();
    timings.drawn(now_ms, performance.now());
  }
  return again;
}

function show(visible: boolean): void {
  is_visible = visible;
  clearTimeout(hidden_timer);
  if (!is_visible) {
    hidden_timer = setTimeout(() => {
                     connection.may_stream = false;
                     panes.forEach((pane) => pane.stop());
                     wall.stop();
                   }, hidden_max_ms) as unknown as number;
    return;
  }
  connection.may_stream = true;
  wall.start_missing();
  for (const pane of panes.values()) {
    if (!pane.feed.subscription) {
      pane.start();
    }
  }
  connection.open_now();
  loop();
}

// ---- messages of the page
// ----------------------------------------------------------------------------------------------

scope.onmessage = ({data: message}) => {
  switch (message.kind) {
    case "connect":
      begin(message.url, message.token, message.join, message.descriptor);
      break;
    case "request":
      request(message.id, message.request, message.first === true);
      break;
    case "events_taken":
      setTimeout(() => {
        events_sent = false;
        send_events();
      }, events_interval_ms);
      break;
    case "visible":
      show(message.visible);
      break;
    case "ask_figures":
      scope.postMessage({kind: "figures", id: message.id, figures: figures()});
      break;
    case "wall":
    case "wall_size":
    case "wall_tiles":
    case "close_wall":
      wall.take(message);
      loop();
      break;
    case "close_pane":
      panes.get(message.pane)?.close();
      panes.delete(message.pane);
      break;
    default:
      pane_of(message.pane).take(message);
      loop();
  }
};

function pane_of(number: number): WorkerPane {
  let pane = panes.get(number);
  if (!pane) {
    pane = new WorkerPane(number, connection, (message) => scope.postMessage(message));
    panes.set(number, pane);
  }
  return pane;
}

function request(id: number, request: Request, first: boolean): void {
  try {
    if (!connection.core) {
      throw new InvalidMessage(worker_texts.no_connection);
    }
    ids.set(connection.core.requests.add(request, first), id);
    connection.flush();
  } catch (error) {
    if (!(error instanceof InvalidMessage)) {
      throw error;
    }
    scope.postMessage({kind: "failed", id, message: error.message});
  }
}

/** Figures for tests and benchmarks. */
function figures(): Figures {
  return {
    ...timings.figures(performance.now()),
    damaged_snapshots: connection.core?.subscriptions.damaged_snapshot_count ?? 0,
    dropped: [...panes.values()].reduce((sum, pane) => sum + (pane.newest()?.info.dropped_count ?? 0), 0),
  };
}
