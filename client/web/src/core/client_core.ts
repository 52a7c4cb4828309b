// The client side of the protocol, as a state machine without sockets and clocks (the model is
// client/python/evod/core.py).
//
// The owner of the socket calls opened(), received() and lost(), and after every call of any method sends the bytes
// that outgoing() returns. received(), lost() and close() return what happened as CoreEvents, in order. A "close" event
// is the last of its list: the owner then closes the socket, calls lost(), and connects again unless `failed` is set.
//
// After a reconnect the core sends its Hello; `subscriptions` subscribes again, and `requests` repeats every unanswered
// request.
import type {CoreEvent, CoreSession, Loss} from "./core_session";
import {DamagedData} from "./errors";
import {control_channel, encode_frame, FrameReader} from "./frames";
import type {ClientMessage, Hello, Join, Response, ServerMessage, Status, Welcome} from "./protocol";
import {Schema} from "./protobuf";
import {RequestQueue} from "./request_queue";
import {Subscriptions} from "./subscriptions";

export const protocol_version = 1;

/** A Goodbye with one of these codes ends the client: another session would end for the same reason. */
const final_codes = new Set(["CODE_UNAUTHENTICATED", "CODE_PERMISSION_DENIED", "CODE_INVALID_ARGUMENT"]);

export interface CoreOptions {
  client_name: string; // at most 64 bytes
  token: string; // empty: none
  join?: Join|null; // instead of a token: connects as a member of a class
  server: string; // names the server in messages: "127.0.0.1:7745"
}

export class ClientCore implements CoreSession {
  readonly requests = new RequestQueue(this);
  readonly subscriptions = new Subscriptions(this, this.requests);
  readonly schema: Schema;
  welcome: Welcome|null = null; // received in the current or the last session
  connected = false; // the server has sent its Welcome on the current connection
  failed: Loss|null = null; // why reconnecting is pointless; null: connect again
  loss: Loss|null = null; // why there is no session at present
  retry_late = false; // the server is full: connect again only after the longest wait

  #hello: Hello;
  readonly #server: string;
  #reader = new FrameReader();
  #queued: Uint8Array[] = []; // frames to send
  #events: CoreEvent[] = [];

  /** descriptor: the serialised FileDescriptorSet of the server. Throws DamagedData. */
  constructor(descriptor: Uint8Array, options: CoreOptions) {
    this.schema = new Schema(descriptor);
    this.#server = options.server;
    this.#hello = hello(options.client_name, options.token, options.join ?? null);
  }

  // ---- the connection ----------------------------------------------------------------------------------------------

  /** Queues the Hello. Call it after connecting. */
  opened(): void {
    this.#queued = [];
    this.#reader = new FrameReader();
    this.retry_late = false;
    this.send({hello: this.#hello});
  }

  /** Processes bytes from the server. The caller must not change them afterwards. */
  received(bytes: Uint8Array): CoreEvent[] {
    try {
      this.#reader.feed(bytes);
      for (let frame = this.#reader.next(); frame !== null; frame = this.#reader.next()) {
        if (frame.channel === control_channel) {
          this.#take_control(this.schema.decode("evod.v1.ServerMessage", frame.body));
        } else if (this.connected) {
          this.subscriptions.take_snapshot(this.schema.decode("evod.v1.SnapshotFrame", frame.body));
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
    this.subscriptions.session_lost();
    this.requests.session_lost(loss);
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

  // ---- CoreSession -------------------------------------------------------------------------------------------------

  send(message: ClientMessage): void {
    this.send_frame(encode_frame(this.schema.encode("evod.v1.ClientMessage", message)));
  }

  send_frame(frame: Uint8Array): void {
    this.#queued.push(frame);
  }

  report(event: CoreEvent): void {
    this.#events.push(event);
  }

  // ---- private -----------------------------------------------------------------------------------------------------

  #take_events(): CoreEvent[] {
    const events = this.#events;
    this.#events = [];
    return events;
  }

  #close_connection(loss: Loss): void {
    this.report({kind: "close", ...loss});
  }

  #take_control(message: ServerMessage): void {
    if (!this.connected) {
      this.#take_welcome(message);
    } else if (message.response !== undefined) {
      this.#take_response(message.response);
    } else if (message.event !== undefined) {
      this.subscriptions.take_event(message.event);
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
      const refused = {...loss, message: `the server at ${this.#server} refused this client: ${loss.message}`};
      this.retry_late = loss.code === "CODE_RESOURCE_EXHAUSTED";
      const is_temporary = loss.code === "CODE_RESOURCE_EXHAUSTED" || loss.code === "CODE_UNAVAILABLE";
      if (!is_temporary || this.#hello.join !== undefined) { // the user decides whether to join again
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
    const token = message.welcome.membership?.token ?? "";
    if (token !== "") { // a second join would make a second member
      this.#hello = hello(this.#hello.client_name ?? "", token, null);
    }
    this.loss = null;
    this.report({kind: "opened", welcome: message.welcome});
    // All subscriptions are sent first, so that subscribers receive the events that the other requests cause.
    this.subscriptions.session_opened();
    this.connected = true;
    this.requests.send_waiting();
  }

  #take_response(response: Response): void {
    const id = response.request_id ?? 0, answered = this.requests.take(response);
    if (answered?.kind.startsWith("subscribe_")) {
      this.subscriptions.take_response(id, answered.kind, response);
    } else if (answered?.is_own) {
      this.subscriptions.take_own_response(id, response);
    } else if (answered) {
      this.report({kind: "response", id, response});
    }
    this.requests.send_waiting();
  }
}

function hello(client_name: string, token: string, join: Join|null): Hello {
  return {protocol_version, client_name, ...(join === null ? {token} : {join})};
}

/** Returns the reason in a Status. */
function loss_of(status: Status|undefined): Loss {
  const {message = "the server ended the session", code = "", reason} = status ?? {};
  return {message, code, ...(reason !== undefined && {reason})};
}
