// The scenarios of proto/vectors/sessions.json, performed with a ClientCore. The file explains its steps.
import assert from "node:assert/strict";
import { test } from "node:test";
import { core, descriptor, schema, vectors_file } from "./support.mjs";

const { scenarios } = JSON.parse(vectors_file("sessions.json"));

const text_of = (status) => ["refused", status.code, status.reason].filter(Boolean).join(" ");
const canonical = (type, message) => schema.decode(type, schema.encode(type, message));

/** A client and the server's end of its session. */
class Player {
  core = new core.ClientCore(descriptor, { client_name: "test", token: "", server: "here:1" });
  ids = new Map(); // request_id by name
  requests = new Map(); // id in the core by name
  outcomes = new Map(); // results by id in the core; by name if the call threw
  subscriptions = new Map();

  play(step) {
    const [[kind, value]] = Object.entries(step);
    this[kind](value);
  }

  // ---- the server

  receive(message) {
    this.take(this.core.received(core.encode_frame(schema.encode("evod.v1.ServerMessage", message))));
  }

  take(events) {
    for (const event of events) {
      if (event.kind === "response" || event.kind === "failed") {
        assert.ok(!this.outcomes.has(event.id), "each request has one outcome");
        this.outcomes.set(event.id, event.kind === "failed" ? "lost" : event.response.status ? text_of(event.response.status) : "answered");
      } else if (event.kind === "close") {
        this.take(this.core.lost({ message: event.message, code: event.code }));
      }
    }
  }

  connect() {
    this.core.opened();
    assert.deepEqual(this.messages().map((message) => Object.keys(message)), [["hello"]]);
  }

  open(fields) {
    this.connect();
    this.receive({ welcome: { protocol_version: 1, ...fields } });
    assert.ok(this.core.connected);
  }

  refuse(status) {
    this.connect();
    this.goodbye(status);
  }

  goodbye(status) {
    this.receive({ goodbye: { status } });
  }

  lose() {
    this.take(this.core.lost({ message: "the connection was lost", code: "" }));
  }

  answer({ name, fields }) {
    this.receive({ response: { ...fields, request_id: this.ids.get(name) } });
  }

  // ---- the program

  request({ name, fields }) {
    try {
      this.requests.set(name, this.core.requests.add(fields));
    } catch (error) {
      assert.ok(error instanceof core.InvalidMessage);
      this.requests.set(name, name);
      this.outcomes.set(name, error.status ? text_of(error.status) : "lost");
    }
  }

  forget(name) {
    this.core.requests.forget(this.requests.get(name));
  }

  subscribe({ name, fields }) {
    this.subscriptions.set(name, this.core.subscriptions.subscribe(structuredClone(fields)));
  }

  unsubscribe(name) {
    this.core.subscriptions.unsubscribe(this.subscriptions.get(name));
  }

  set_view({ name, view }) {
    this.core.subscriptions.set_view(this.subscriptions.get(name), view);
  }

  // ---- expectations

  messages() {
    const bytes = this.core.outgoing(), messages = [], reader = new core.FrameReader();
    reader.feed(bytes ?? new Uint8Array());
    for (let frame = reader.next(); frame !== null; frame = reader.next()) {
      messages.push(schema.decode("evod.v1.ClientMessage", frame.body));
    }
    return messages;
  }

  sent(expected) {
    const requests = this.messages().filter((message) => message.request).map((message) => message.request);
    assert.equal(requests.length, expected.length, JSON.stringify(requests));
    expected.forEach(({ name, fields }, i) => {
      const { request_id, client_key, ...sent } = requests[i];
      assert.equal(client_key, this.core.requests.client_key);
      assert.ok(this.ids.has(name) || ![...this.ids.values()].includes(request_id), `${name} has a new id`);
      assert.equal(request_id, this.ids.get(name) ?? request_id, name);
      this.ids.set(name, request_id);
      assert.deepEqual(sent, canonical("evod.v1.Request", fields));
    });
  }

  results(expected) {
    for (const [name, result] of Object.entries(expected)) {
      const subscription = this.subscriptions.get(name);
      const found = subscription === undefined ? this.outcomes.get(this.requests.get(name)) ?? "waiting"
        : subscription.refused ? text_of(subscription.refused) : subscription.server_id !== null ? "accepted" : "waiting";
      assert.equal(found, result, name);
    }
  }

  session(expected) {
    assert.equal(this.core.failed ? "gives up" : this.core.connected ? "open" : this.core.retry_late ? "retries late" : "retries soon", expected);
  }
}

for (const { name, steps, only } of scenarios) {
  if (only === undefined || only.clients.includes("typescript")) {
    test(name, () => {
      const player = new Player();
      steps.forEach((step) => player.play(step));
    });
  }
}
