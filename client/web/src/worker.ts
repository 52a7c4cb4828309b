// worker: owns the socket, the protocol core, the decoder and the canvases, so that the page stays responsive.
//
// Flow control   A snapshot is acknowledged after the frame that contains it is drawn, and the server sends at most
//                unacknowledged_max snapshots ahead. A hidden page draws nothing, so the server soon stops sending; after
//                hidden_max_ms the worker ends its subscriptions to snapshots until the page is visible again.
// Reconnecting   While the connection is lost, the worker tries again after 0.25 s, then after twice as long, up to 5 s. The
//                core then subscribes again and repeats the unanswered requests.
import {ClientCore, type CoreEvent, is_name_of_replay, type Subscription} from "./core/client_core";
import {InvalidMessage} from "./core/errors";
import {EventQueue} from "./core/event_queue";
import type {Snapshot} from "./core/snapshot";
import type {Camera, Figures, FromWorker, Look, Message, ToWorker} from "./core/messages";
import {Renderer} from "./render/renderer";

const client_name = "browser";
const unacknowledged_max = 2;
const backoff_min_ms = 250, backoff_max_ms = 5000;
const silence_ms = 10_000; // the worker then sends a query, which a living server answers
const silence_max_ms = 25_000; // the worker then gives the connection up
const hidden_max_ms = 60_000;
const events_max = 1000; // events that wait for the page
const events_interval_ms = 30; // between two messages with events
const report_ms = 50, drawing_report_ms = 200, view_ms = 200; // least time between two messages
const is_local = /^(localhost|127\.|\[::1\])/.test(location.hostname); // the server is on this machine
// Larger islands are streamed in tiles of the visible region, smaller ones whole. Between the two numbers nothing changes.
// Whole snapshots are faster to decode, so a server on the same machine sends larger islands whole.
const view_from = is_local ? 20_000 : 5_000, whole_below = 0.8 * view_from; // organisms
const bytes_per_s_max = is_local ? 4_000_000 : 500_000;
const frame_ms = 16, frame_max_ms = 200; // between two frames, without and with animation frames
const timings_kept = 200;

const scope = self as unknown as {
  postMessage(message: FromWorker): void;
  onmessage: ((event: MessageEvent<ToWorker>) => void)|null;
  requestAnimationFrame?: (callback: () => void) => number;
  cancelAnimationFrame?: (request: number) => void;
};

interface Pane {
  renderer: Renderer|null; // null until the canvas has arrived
  watched: {world: string; island: number; rate_hz: number}|null;
  subscription: Subscription|null;
  has_view: boolean; // the subscription is limited to a view
  overview: Subscription|
    null; // densities of the whole island once a second, for the minimap, while the pane has a view
  drawn_next: Snapshot[]; // added to the renderer, not acknowledged yet
  newest: Snapshot|null;
  follow: boolean;
  camera: string; // the camera that the page knows, as text
  drawing: string; // the last reported Drawing, as text
  fresh: boolean; // a snapshot is not reported yet
  reported_ms: number;
  drawing_reported_ms: number;
  view_ms: number; // when the last view was requested
}

/** What the page has set for a pane before its canvas has arrived. */
interface Settings {
  size?: [number, number, number];
  camera?: Camera|null;
  look?: Look;
}

let core: ClientCore|null = null;
let socket: WebSocket|null = null;
let connect: {url: string; token: string; descriptor: Uint8Array}|null = null;
let connecting = 0; // timer of the next attempt
let backoff_ms = backoff_min_ms;
let received_ms = 0; // when the last bytes arrived
let queried = false; // the silence has been answered with a query
let visible = true;
let hidden_timer = 0;
const event_queue = new EventQueue(events_max);
let events_sent = false; // the page has not taken them yet, or took them less than events_interval_ms ago
let looping = false;
const panes = new Map<number, Pane>();
const settings = new Map<number, Settings>();
const ids = new Map<number, number>(); // ids of the page by ids of the core
const decode_times: number[] = [], draw_times: number[] = [], frame_times: number[] = [];
let snapshot_count = 0, reconnect_count = 0;

// ---- the connection ----------------------------------------------------------------------------------------------------

function host(): string {
  return new URL(connect!.url).host;
}

function begin(url: string, token: string, descriptor: ArrayBuffer): void {
  end_session();
  connect = {url, token, descriptor: new Uint8Array(descriptor)};
  core = new ClientCore(connect.descriptor, {client_name, client_version: "", token, server: host()});
  scope.postMessage({kind: "rules", rules: core.schema.request_rules(), roles: core.schema.enum_names("evod.v1.Role")});
  core.subscribe({subscribe_events: {}});
  for (const [number, pane] of panes) {
    pane.subscription = pane.overview = null;
    if (pane.watched && is_name_of_replay(pane.watched.world)) {
      pane.watched = null; // it has ended with the last session; the page opens it again
    }
    watch(number, pane);
  }
  backoff_ms = backoff_min_ms;
  open();
}

/** Ends the present session for good, because another one begins. */
function end_session(): void {
  clearTimeout(connecting);
  if (core) {
    const ended = core;
    core = null;
    take(ended.close());
  }
  socket?.close();
  socket = null;
}

function open(): void {
  clearTimeout(connecting);
  const opened = new WebSocket(connect!.url);
  socket = opened;
  opened.binaryType = "arraybuffer";
  opened.onopen = () => {
    if (socket === opened) {
      received_ms = performance.now();
      core!.opened();
      flush();
    }
  };
  opened.onmessage = (event: MessageEvent<unknown>) => {
    if (socket === opened && event.data instanceof ArrayBuffer) {
      receive(new Uint8Array(event.data));
    }
  };
  opened.onclose = () => {
    if (socket === opened) {
      lose(core!.connected ? `the connection to ${host()} was lost` : `the server at ${host()} cannot be reached`, "");
    }
  };
}

function receive(bytes: Uint8Array): void {
  received_ms = performance.now();
  queried = false;
  const events = core!.received(bytes);
  const decoded = events.filter((event) => event.kind === "snapshot").length;
  if (decoded > 0) {
    remember(decode_times, (performance.now() - received_ms) / decoded);
  }
  take(events);
  flush();
}

function flush(): void {
  if (socket?.readyState === WebSocket.OPEN) {
    const bytes = core!.outgoing();
    if (bytes) {
      socket.send(bytes);
    }
  }
}

function lose(message: string, code: string): void {
  const ended = socket;
  socket = null;
  ended?.close();
  const failed = core!.failed;
  const events = core!.lost({message, code});
  post_state(failed ? "refused" : "lost", failed?.message ?? message, failed?.code ?? code);
  take(events); // the page knows why its requests fail
  if (!failed) {
    ++reconnect_count;
    // If the server is full, another attempt soon would take the place of another client.
    backoff_ms = core!.retry_late ? backoff_max_ms : backoff_ms;
    connecting = setTimeout(open, backoff_ms * (0.8 + 0.4 * Math.random())) as unknown as number;
    backoff_ms = Math.min(backoff_max_ms, 2 * backoff_ms);
  }
}

/** Notices a server that has disappeared without closing the connection. */
function watch_silence(): void {
  const silent_ms = performance.now() - received_ms;
  if (!core?.connected || !socket || silent_ms < silence_ms) {
    return;
  }
  if (silent_ms > silence_max_ms && queried) {
    lose(`the server at ${host()} has sent nothing for ${Math.round(silent_ms / 1000)} s`, "");
  } else if (!queried) {
    queried = true;
    core.request({list_worlds: {}}, true);
    flush();
  }
}

function post_state(phase: "open"|"lost"|"refused", message: string, code: string): void {
  const sentence = message.charAt(0).toUpperCase() + message.slice(1);
  scope.postMessage({kind: "state", state: {phase, message: sentence, code, welcome: core?.welcome ?? null}});
}

/** Sends the queued events unless the page has not taken the last ones. */
function send_events(): void {
  if (!events_sent && !event_queue.is_empty) {
    events_sent = true;
    scope.postMessage({kind: "events", events: event_queue.take()});
  }
}

// ---- what the core reports ---------------------------------------------------------------------------------------------

function take(events: CoreEvent[]): void {
  for (const event of events) {
    switch (event.kind) {
      case "opened":
        backoff_ms = backoff_min_ms;
        post_state("open", "", "");
        break;
      case "response": {
        const id = ids.get(event.id);
        ids.delete(event.id);
        if (id !== undefined) {
          scope.postMessage({kind: "response", id, response: event.response});
        }
        break;
      }
      case "failed": {
        const id = ids.get(event.id);
        ids.delete(event.id);
        if (id !== undefined) {
          scope.postMessage({kind: "failed", id, message: event.message});
        }
        break;
      }
      case "event":
        event_queue.push(event.event);
        send_events();
        break;
      case "snapshot":
        take_snapshot(event.subscription, event.snapshot);
        break;
      case "subscribed":
        of_subscription(event.subscription, (_number, pane) => pane.renderer?.forget_view());
        break;
      case "subscription_refused":
        of_subscription(event.subscription, (number, pane) => {
          core!.unsubscribe(event.subscription);
          pane.subscription = null;
          scope.postMessage({
            kind: "watch_refused",
            pane: number,
            message: event.status.message ?? "The server refuses to send snapshots"
          });
        });
        break;
      case "close":
        lose(event.message, event.code);
        break;
    }
  }
}

function of_subscription(subscription: Subscription, act: (number: number, pane: Pane) => void): void {
  for (const [number, pane] of panes) {
    if (pane.subscription === subscription) {
      act(number, pane);
    }
  }
}

function take_snapshot(subscription: Subscription, snapshot: Snapshot): void {
  for (const pane of panes.values()) {
    if (pane.overview === subscription) {
      pane.renderer?.add_overview(snapshot);
      loop();
      return;
    }
  }
  ++snapshot_count;
  let shown = false;
  of_subscription(subscription, (number, pane) => {
    shown = true;
    pane.newest = snapshot;
    pane.fresh = true;
    pane.drawn_next.push(snapshot);
    pane.renderer?.add(snapshot, performance.now());
    const organisms = snapshot.info.counts.organisms,
          view = organisms >= view_from || (pane.has_view && organisms >= whole_below);
    if (view !== pane.has_view) {
      pane.has_view = view;
      watch(number, pane);
    }
  });
  if (!shown) {
    core!.acknowledge(subscription, snapshot);
  }
  loop();
}

// ---- panes -------------------------------------------------------------------------------------------------------------

function pane_of(number: number): Pane {
  let pane = panes.get(number);
  if (!pane) {
    pane = {
      renderer: null,
      watched: null,
      subscription: null,
      has_view: false,
      overview: null,
      drawn_next: [],
      newest: null,
      follow: false,
      camera: "",
      drawing: "",
      fresh: false,
      reported_ms: 0,
      drawing_reported_ms: 0,
      view_ms: 0
    };
    panes.set(number, pane);
  }
  return pane;
}

function settings_of(number: number): Settings {
  const known = settings.get(number) ?? {};
  settings.set(number, known);
  return known;
}

/** Subscribes to the snapshots that the pane shows. Replaces its last subscription. */
function watch(_number: number, pane: Pane): void {
  unwatch(pane);
  if (!pane.watched || !core || core.failed || (!visible && hidden_timer === 0)) {
    return;
  }
  const view: Message|undefined = pane.has_view ?
    {detail: "DETAIL_FULL", bytes_per_s_max, ...(pane.renderer?.view_to_request(performance.now()) ?? {})} :
    undefined;
  pane.view_ms = performance.now();
  pane.subscription = core.subscribe({
    subscribe_snapshots:
      {...pane.watched, codec: "CODEC_DELTA", unacknowledged_max, headings: true, ...(view ? {view} : {})}
  });
  if (pane.has_view) {
    const {world, island} = pane.watched;
    pane.overview = core.subscribe(
      {subscribe_snapshots: {world, island, rate_hz: 1, codec: "CODEC_DELTA", view: {detail: "DETAIL_DENSITY"}}});
  }
  flush();
}

function unwatch(pane: Pane): void {
  for (const subscription of [pane.subscription, pane.overview]) {
    if (subscription && core) {
      core.unsubscribe(subscription);
      flush();
    }
  }
  pane.subscription = pane.overview = null;
  pane.drawn_next = [];
}

function loop(): void {
  if (looping || !visible) {
    return;
  }
  looping = true;
  const frame = (): void => {
    clearTimeout(timer);
    scope.cancelAnimationFrame?.(request);
    looping = false;
    if (draw()) {
      loop();
    }
  };
  // A browser that is short of time gives no animation frames for seconds; the page then shows few images, but recent ones.
  const timer = setTimeout(frame, scope.requestAnimationFrame ? frame_max_ms : frame_ms);
  const request = scope.requestAnimationFrame?.(frame) ?? 0;
}

/** Draws all panes that need it. Returns whether another frame is needed. */
function draw(): boolean {
  const now = performance.now();
  let again = false, drawn = false;
  for (const [number, pane] of panes) {
    const renderer = pane.renderer;
    if (pane.drawn_next.length > 0 || renderer?.needs_frame(now)) {
      renderer?.draw(now);
      drawn = true;
      for (const snapshot of pane.drawn_next.splice(0)) {
        if (pane.subscription) {
          core?.acknowledge(pane.subscription, snapshot);
        }
      }
      request_view(pane, now);
    }
    again = report(number, pane, now) || renderer?.needs_frame(now) || again;
  }
  if (drawn) {
    flush();
    remember(draw_times, performance.now() - now);
    frame_times.push(now);
    while (frame_times[0]! < now - 1000) {
      frame_times.shift();
    }
  }
  return again;
}

function request_view(pane: Pane, now: number): void {
  if (pane.renderer && pane.has_view && pane.subscription && now - pane.view_ms >= view_ms) {
    const view = pane.renderer.view_to_request(now);
    if (view) {
      pane.view_ms = now;
      core?.set_view(pane.subscription, {...view, bytes_per_s_max});
    }
  }
}

/** Reports what was drawn to the page. Returns whether something has to wait for a later frame. */
function report(number: number, pane: Pane, now: number): boolean {
  const renderer = pane.renderer;
  if (renderer && pane.follow) {
    const camera = renderer.camera(), text = JSON.stringify(camera);
    if (camera && text !== pane.camera) {
      pane.camera = text;
      scope.postMessage({kind: "camera", pane: number, camera});
    }
  }
  if (renderer && now - pane.drawing_reported_ms >= drawing_report_ms) {
    const drawing = renderer.drawing(), text = JSON.stringify(drawing);
    if (drawing && text !== pane.drawing) {
      pane.drawing = text;
      pane.drawing_reported_ms = now;
      scope.postMessage({kind: "drawing", pane: number, drawing});
    }
  }
  if (!pane.fresh || !pane.newest || pane.drawn_next.length > 0) {
    return false;
  }
  if (now - pane.reported_ms < report_ms) {
    return true;
  }
  pane.fresh = false;
  pane.reported_ms = now;
  scope.postMessage({
    kind: "snapshot",
    pane: number,
    info: pane.newest.info,
    healthiest: renderer?.healthiest(5) ?? [],
    selected: renderer?.selected() ?? null
  });
  return false;
}

function show(is_visible: boolean): void {
  visible = is_visible;
  clearTimeout(hidden_timer);
  if (!visible) {
    hidden_timer = setTimeout(() => {
                     hidden_timer = 0;
                     panes.forEach(unwatch);
                   }, hidden_max_ms) as unknown as number;
    return;
  }
  hidden_timer = 0;
  for (const [number, pane] of panes) {
    if (!pane.subscription) {
      watch(number, pane);
    }
  }
  if (core && !core.failed && !socket) { // no attempt is under way: try now rather than after the backoff
    open();
  }
  loop();
}

// ---- messages of the page ----------------------------------------------------------------------------------------------

scope.onmessage = ({data: message}) => {
  switch (message.kind) {
    case "connect":
      begin(message.url, message.token, message.descriptor);
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
    case "close_pane": {
      const pane = panes.get(message.pane);
      if (pane) {
        unwatch(pane);
        pane.renderer?.close();
      }
      panes.delete(message.pane);
      settings.delete(message.pane);
      break;
    }
    default:
      take_for_pane(message.pane, pane_of(message.pane), message);
      loop();
  }
};

type ForPane = Exclude<ToWorker, {kind: "connect" | "request" | "visible" | "ask_figures" | "close_pane"}>;

function take_for_pane(number: number, pane: Pane, message: ForPane): void {
  const renderer = pane.renderer;
  switch (message.kind) {
    case "pane": {
      const made = new Renderer(message.canvas), known = settings_of(number);
      pane.renderer = made;
      if (known.size) {
        made.resize(...known.size);
      }
      if (known.look) {
        made.set_look(known.look);
      }
      if (known.camera !== undefined) {
        made.set_camera(known.camera);
      }
      if (pane.newest) {
        made.add(pane.newest, performance.now());
      }
      break;
    }
    case "resize":
      settings_of(number).size = [message.width, message.height, message.pixel_ratio];
      renderer?.resize(message.width, message.height, message.pixel_ratio);
      break;
    case "watch":
      pane.watched = {world: message.world, island: message.island, rate_hz: message.rate_hz};
      pane.has_view = false;
      pane.newest = null;
      pane.fresh = false;
      renderer?.clear();
      watch(number, pane);
      break;
    case "unwatch":
      pane.watched = null;
      pane.newest = null;
      unwatch(pane);
      renderer?.clear();
      break;
    case "camera":
      settings_of(number).camera = message.camera;
      pane.camera = JSON.stringify(message.camera);
      renderer?.set_camera(message.camera);
      break;
    case "pointer":
      renderer?.set_pointer(message.at, message.tool);
      break;
    case "look":
      settings_of(number).look = message.look;
      renderer?.set_look(message.look);
      break;
    case "select":
      pane.follow = message.follow;
      renderer?.set_selection(message.organism, message.hovered, message.follow);
      pane.fresh = pane.newest !== null; // the page waits for the place of the selected organism
      break;
    case "population":
      renderer?.set_population(message.columns);
      break;
    case "pick": {
      const picked = renderer?.pick(message.x, message.y, message.radius) ??
        {generation: 0, organism: null, food: null, poison: null, x_px: -1, y_px: -1};
      scope.postMessage({kind: "picked", id: message.id, ...picked});
      break;
    }
    case "ask_columns":
      scope.postMessage({kind: "columns", id: message.id, columns: pane.newest});
      break;
  }
}

function request(id: number, request: Message, first: boolean): void {
  try {
    if (!core) {
      throw new InvalidMessage("there is no connection");
    }
    ids.set(core.request(request, first), id);
    flush();
  } catch (error) {
    if (!(error instanceof InvalidMessage)) {
      throw error;
    }
    scope.postMessage({kind: "failed", id, message: error.message});
  }
}

// ---- figures -----------------------------------------------------------------------------------------------------------

function remember(times: number[], ms: number): void {
  times.push(ms);
  if (times.length > timings_kept) {
    times.shift();
  }
}

function percentile(times: number[], share: number): number {
  const sorted = [...times].sort((a, b) => a - b);
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))] ?? 0;
}

/** Figures for tests and benchmarks. Times are those of the last timings_kept snapshots and frames, in ms. */
function figures(): Figures {
  const memory = (performance as {memory?: {usedJSHeapSize: number}}).memory;
  return {
    decode_p50_ms: percentile(decode_times, 0.5),
    decode_p95_ms: percentile(decode_times, 0.95),
    draw_p50_ms: percentile(draw_times, 0.5),
    draw_p95_ms: percentile(draw_times, 0.95),
    frames_per_s: frame_times.filter((at) => at > performance.now() - 1000).length,
    snapshots: snapshot_count,
    damaged_snapshots: core?.damaged_snapshot_count ?? 0,
    reconnects: reconnect_count,
    dropped: [...panes.values()].reduce((sum, pane) => sum + (pane.newest?.info.dropped_count ?? 0), 0),
    heap_bytes: memory?.usedJSHeapSize ?? 0,
  };
}

setInterval(watch_silence, 5000);
