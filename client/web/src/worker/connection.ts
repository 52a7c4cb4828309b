// Connection: the socket of the worker, and the protocol core behind it.
//
// Reconnecting   While the connection is lost, it tries again after 0.25 s, then after twice as long, up to 5 s. The
//                core then subscribes again and repeats the unanswered requests.
// Silence        A server that sends nothing for silence_ms gets a query, which a living server answers; while a world
//                runs, earlier. The page shows a silence of silence_shown_ms. A server that sends nothing for
//                silence_max_ms has disappeared without closing the connection.
import {ClientCore} from "../core/client_core";
import type {CoreEvent} from "../core/core_session";
import type {ConnectionState} from "../core/messages";
import type {Join} from "../core/protocol";
import {reason_text} from "../texts/refusals";
import {worker_texts} from "../texts/worker";
import type {Timings} from "./timings";

const client_name = "browser";
const backoff_min_ms = 250, backoff_max_ms = 5000;
const silence_ms = 10_000, silence_max_ms = 25_000, silence_interval_ms = 500;
const running_silence_ms = 1500, silence_shown_ms = 3000; // while a world runs, so that snapshots are expected

export interface ConnectionListener {
  /** Takes what the core reports, in order. */
  take(events: CoreEvent[]): void;
  changed(state: ConnectionState): void;
}

export class Connection {
  core: ClientCore|null = null;
  /** Whether panes may subscribe to snapshots. */
  may_stream = true;
  readonly #listener: ConnectionListener;
  readonly #timings: Timings;
  #url = "";
  #socket: WebSocket|null = null;
  #attempt = 0; // timer of the next attempt
  #backoff_ms = backoff_min_ms;
  #received_ms = 0; // when the last bytes arrived
  #has_queried = false; // the silence has been answered with a query
  #is_running = false; // the world of the last snapshot
  #silent_s = 0; // of ConnectionState

  constructor(listener: ConnectionListener, timings: Timings) {
    this.#listener = listener;
    this.#timings = timings;
    setInterval(() => this.#watch_silence(), silence_interval_ms);
  }

  /** Replaces the present session by one that open() begins. */
  begin(url: string, token: string, join: Join|null, descriptor: Uint8Array): ClientCore {
    clearTimeout(this.#attempt);
    if (this.core) {
      const ended = this.core;
      this.core = null;
      this.#listener.take(ended.close());
    }
    this.#socket?.close();
    this.#socket = null;
    this.#url = url;
    this.#backoff_ms = backoff_min_ms;
    return (this.core = new ClientCore(descriptor, {client_name, token, join, server: this.#host}));
  }

  open(): void {
    clearTimeout(this.#attempt);
    const socket = (this.#socket = new WebSocket(this.#url));
    socket.binaryType = "arraybuffer";
    socket.onopen = () => {
      if (this.#socket === socket) {
        this.#received_ms = performance.now();
        this.core!.opened();
        this.flush();
      }
    };
    socket.onmessage = (event: MessageEvent<unknown>) => {
      if (this.#socket === socket && event.data instanceof ArrayBuffer) {
        this.#receive(new Uint8Array(event.data));
      }
    };
    socket.onclose = () => {
      if (this.#socket === socket) {
        this.lose((this.core!.connected ? worker_texts.lost : worker_texts.unreachable)(this.#host), "");
      }
    };
  }

  /** If no attempt to connect is under way, tries now rather than after the backoff. */
  open_now(): void {
    if (this.core && !this.core.failed && !this.#socket) {
      this.open();
    }
  }

  /** Sends what the core has queued. */
  flush(): void {
    if (this.#socket?.readyState === WebSocket.OPEN) {
      const bytes = this.core?.outgoing();
      if (bytes) {
        this.#socket.send(bytes);
      }
    }
  }

  /** The core has reported a session. */
  opened(): void {
    this.#backoff_ms = backoff_min_ms;
    this.#report("open", "", "", "");
  }

  /** Ends the connection, and tries again unless the core has failed. */
  lose(message: string, code: string): void {
    const ended = this.#socket, core = this.core!;
    this.#socket = null;
    this.#silent_s = 0;
    this.#is_running = false;
    ended?.close();
    const {failed} = core;
    const events = core.lost({message, code});
    this.#report(
      failed ? "refused" : "lost", reason_text(failed?.reason) || (failed?.message ?? message), failed?.code ?? code,
      failed?.reason ?? "");
    this.#listener.take(events); // the page knows why its requests fail
    if (!failed) {
      ++this.#timings.reconnect_count;
      // If the server is full, another attempt soon would take the place of another client.
      this.#backoff_ms = core.retry_late ? backoff_max_ms : this.#backoff_ms;
      this.#attempt =
        setTimeout(() => this.open(), this.#backoff_ms * (0.8 + 0.4 * Math.random())) as unknown as number;
      this.#backoff_ms = Math.min(backoff_max_ms, 2 * this.#backoff_ms);
    }
  }

  get #host(): string {
    return new URL(this.#url).host;
  }

  #receive(bytes: Uint8Array): void {
    this.#received_ms = performance.now();
    this.#has_queried = false;
    const events = this.core!.received(bytes);
    for (const event of events) {
      if (event.kind === "snapshot") {
        this.#is_running = event.snapshot.info.state === "RUN_STATE_RUNNING";
      }
    }
    this.#show_silence(0);
    const decoded = events.filter((event) => event.kind === "snapshot").length;
    if (decoded > 0) {
      this.#timings.decoded((performance.now() - this.#received_ms) / decoded);
    }
    this.#listener.take(events);
    this.flush();
  }

  #watch_silence(): void {
    const silent_ms = performance.now() - this.#received_ms, expects = this.#is_running && this.may_stream;
    if (!this.core?.connected || !this.#socket) {
      return;
    }
    this.#show_silence(expects && silent_ms >= silence_shown_ms ? Math.floor(silent_ms / 1000) : 0);
    if (silent_ms > silence_max_ms && this.#has_queried) {
      this.lose(worker_texts.silent(this.#host, Math.round(silent_ms / 1000)), "");
    } else if (!this.#has_queried && silent_ms >= (expects ? running_silence_ms : silence_ms)) {
      this.#has_queried = true;
      this.core.requests.add({list_worlds: {}}, true);
      this.flush();
    }
  }

  #show_silence(seconds: number): void {
    if (seconds !== this.#silent_s) {
      this.#silent_s = seconds;
      this.#report("open", "", "", "");
    }
  }

  #report(phase: ConnectionState["phase"], message: string, code: string, reason: string): void {
    const sentence = message.charAt(0).toUpperCase() + message.slice(1);
    const welcome = this.core?.welcome ?? null;
    this.#listener.changed({phase, message: sentence, code, reason, silent_s: this.#silent_s, welcome});
  }
}
