// The client as a state machine, against a server that is a list of messages.
import assert from "node:assert/strict";
import { test } from "node:test";
import { core, descriptor, read_vectors, schema } from "./support.mjs";

const vectors = read_vectors();
const deltas = vectors.filter((vector) => vector.case === "life_deltas").map((vector) => vector.frame);
const limits = { control_frame_bytes_max: 1 << 20, requests_in_flight_max: 32 };

/** A ClientCore and the other end of its connection. */
class Session {
  constructor(options = {}) {
    this.core = new core.ClientCore(descriptor, { client_name: "test", token: "", server: "here:1", ...options });
  }

  /** Opens a connection and lets the server say Welcome. Returns the events. */
  open(welcome = {}) {
    this.core.opened();
    assert.equal(this.sent()[0].hello.protocol_version, 1);
    return this.say({ welcome: { protocol_version: 1, limits, ...welcome } });
  }

  /** The messages that the core has sent since the last call. */
  sent() {
    const bytes = this.core.outgoing(), messages = [];
    if (bytes !== null) {
      const reader = new core.FrameReader();
      reader.feed(bytes);
      for (let frame = reader.next(); frame !== null; frame = reader.next()) {
        messages.push(schema.decode("evod.v1.ClientMessage", frame.body));
      }
    }
    return messages;
  }

  requests() {
    return this.sent().filter((message) => message.request !== undefined).map((message) => message.request);
  }

  /** Receives ServerMessages. Returns the events. */
  say(...messages) {
    return messages.flatMap((message) => this.core.received(core.encode_frame(schema.encode("evod.v1.ServerMessage", message))));
  }

  /** Receives a SnapshotFrame. Returns the events. */
  show(frame) {
    const bytes = core.encode_frame(schema.encode("evod.v1.SnapshotFrame", frame));
    bytes[3] = 2; // the channel of snapshots
    return this.core.received(bytes);
  }

  /** Subscribes and lets the server accept. Returns the subscription. */
  subscribe(request, server_id = 7) {
    const subscription = this.core.subscriptions.subscribe(request);
    const events = this.accept(server_id);
    assert.deepEqual(events.filter((event) => event.kind === "subscribed"), [{ kind: "subscribed", subscription }]);
    return subscription;
  }

  accept(server_id) {
    const request = this.requests().find((one) => one.subscribe_snapshots !== undefined || one.subscribe_events !== undefined);
    return this.say({ response: { request_id: request.request_id, subscription: { subscription_id: server_id, rate_hz: 30 } } });
  }
}

function opened(options) {
  const session = new Session(options);
  session.open();
  return session;
}

const snapshots = () => ({ subscribe_snapshots: { world: "a", rate_hz: 30, codec: "CODEC_DELTA", unacknowledged_max: 2 } });
const kinds_of = (events) => events.map((event) => event.kind);
const lost = { message: "the connection ended", code: "" };

// ---- the connection ----------------------------------------------------------------------------------------------------

test("a member joins once and then has a token", () => {
  const join = { code: "KTRMXB", name: "Fox" }, session = new Session({ join });
  session.core.opened();
  const [{ hello }] = session.sent();
  assert.deepEqual([hello.join, hello.token], [join, undefined]);
  session.say({ welcome: { protocol_version: 1, limits, membership: { token: "secret" } } });
  session.core.lost(lost);
  session.core.opened();
  const [{ hello: again }] = session.sent();
  assert.deepEqual([again.join, again.token], [undefined, "secret"]);
});

test("a refused join is not repeated", () => {
  const session = new Session({ join: { code: "KTRMXB" } });
  session.core.opened();
  session.say({ goodbye: { status: { code: "CODE_RESOURCE_EXHAUSTED", reason: "REASON_JOINS_TOO_FAST", message: "too fast" } } });
  assert.equal(session.core.failed.reason, "REASON_JOINS_TOO_FAST");
});

test("the Hello is the first message and contains the token", () => {
  const session = new Session({ token: "secret" });
  session.core.requests.add({ list_worlds: {} });
  assert.equal(session.core.outgoing(), null); // nothing is sent before there is a connection
  session.core.opened();
  assert.deepEqual(session.sent(), [{ hello: { protocol_version: 1, client_name: "test", token: "secret" } }]);
  const events = session.say({ welcome: { protocol_version: 1, limits } });
  assert.deepEqual(kinds_of(events), ["opened"]);
  assert.deepEqual(session.requests().map((request) => request.list_worlds), [{}]);
});

test("a client_key has 16 random bytes", () => {
  const keys = new Set(Array.from({ length: 50 }, () => new Session().core.requests.client_key));
  assert.equal(keys.size, 50);
  for (const key of keys) {
    assert.match(key, /^[0-9a-f]{32}$/);
  }
});

test("a refused session is final unless the server is busy", () => {
  for (const [code, is_final] of [["CODE_UNAUTHENTICATED", true], ["CODE_FAILED_PRECONDITION", true],
                                  ["CODE_RESOURCE_EXHAUSTED", false], ["CODE_UNAVAILABLE", false]]) {
    const session = new Session();
    session.core.opened();
    const message = "the server at here:1 refused this client: no";
    assert.deepEqual(session.say({ goodbye: { status: { code, message: "no" } } }), [{ kind: "close", message, code }]);
    assert.deepEqual(session.core.failed, is_final ? { message, code } : null);
  }
});

test("a Goodbye closes the session, and a revoked token is final", () => {
  for (const [code, is_final] of [["CODE_UNAVAILABLE", false], ["CODE_UNAUTHENTICATED", true]]) {
    const session = opened();
    assert.deepEqual(session.say({ goodbye: { status: { code, message: "bye" } } }), [{ kind: "close", message: "bye", code }]);
    assert.equal(session.core.failed !== null, is_final);
  }
});

test("another program is not an evod server", () => {
  for (const say of [(session) => session.core.received(new TextEncoder().encode("HTTP/1.1 400 Bad Request")),
                     (session) => session.say({ event: {} }), (session) => session.show({})]) {
    const session = new Session();
    session.core.opened();
    const events = say(session);
    assert.deepEqual(kinds_of(events), ["close"]);
    assert.match(events[0].message, /^here:1 is not an evod server: /);
    assert.notEqual(session.core.failed, null);
  }
});

test("damaged frames close a session, and a new one may follow", () => {
  const session = opened();
  const events = session.core.received(core.encode_frame(new Uint8Array([0])));
  assert.deepEqual(events, [{ kind: "close", message: "here:1 sent damaged data: a message has an invalid field number", code: "" }]);
  assert.equal(session.core.failed, null);
});

test("another protocol version is final", () => {
  const session = new Session();
  session.core.opened();
  assert.match(session.say({ welcome: { protocol_version: 2 } })[0].message, /uses protocol version 2, but this page uses 1: reload the page$/);
  assert.notEqual(session.core.failed, null);
});

// ---- requests ----------------------------------------------------------------------------------------------------------

test("responses are matched by request_id, whatever their order", () => {
  const session = opened(), a = session.core.requests.add({ pause: { world: "a" } }), b = session.core.requests.add({ list_worlds: {} });
  assert.deepEqual(session.requests(), [{ request_id: a, client_key: session.core.requests.client_key, pause: { world: "a" } },
                                        { request_id: b, client_key: session.core.requests.client_key, list_worlds: {} }]);
  const refusal = { request_id: b, status: { code: "CODE_NOT_FOUND", message: "no", violations: [{ field: "x" }] } };
  const answer = { request_id: a, applied_tick: 0, world: { name: "a" } };
  assert.deepEqual(session.say({ response: refusal }, { response: answer }, { response: answer }),
                   [{ kind: "response", id: b, response: refusal }, { kind: "response", id: a, response: answer }]);
});

test("unanswered requests are repeated with the same id and key", () => {
  const session = opened(), a = session.core.requests.add({ pause: { world: "a" } });
  const b = session.core.requests.add({ resume: { world: "a" } });
  const [first, second] = session.requests();
  session.say({ response: { request_id: a } });
  assert.deepEqual(session.core.lost(lost), []);
  const c = session.core.requests.add({ list_worlds: {} });
  assert.equal(session.core.outgoing(), null);
  session.open();
  const again = session.requests();
  assert.deepEqual(again[0], second);
  assert.deepEqual(again.map((request) => request.request_id), [b, c]);
  assert.equal(first.request_id, a);
  assert.deepEqual(kinds_of(session.say({ response: { request_id: b } }, { response: { request_id: c } })), ["response", "response"]);
});

test("requests about the session fail with it", () => {
  const session = opened(), failing = ["continue_export", "set_view", "unsubscribe", "request_keyframe"];
  const ids = failing.map((kind) => session.core.requests.add({ [kind]: {} }));
  const stays = session.core.requests.add({ pause: { world: "a" } });
  assert.deepEqual(session.core.lost(lost), ids.map((id) => ({ kind: "failed", id, ...lost })));
  session.open();
  assert.deepEqual(session.requests().map((request) => request.request_id), [stays]);
});

test("all requests fail when connecting again is pointless", () => {
  const session = new Session(), id = session.core.requests.add({ list_worlds: {} });
  session.core.opened();
  session.say({ goodbye: { status: { code: "CODE_UNAUTHENTICATED", message: "no" } } });
  assert.deepEqual(session.core.lost(session.core.failed), [{ kind: "failed", id, ...session.core.failed }]);
  assert.throws(() => session.core.requests.add({ list_worlds: {} }), { name: "InvalidMessage", message: /refused this client: no$/ });
  assert.throws(() => session.core.subscriptions.subscribe(snapshots()), core.InvalidMessage);
});

test("close() fails all requests", () => {
  const session = opened(), id = session.core.requests.add({ list_worlds: {} });
  assert.deepEqual(session.core.close(), [{ kind: "failed", id, message: "the connection was closed here", code: "" }]);
});

test("at most half of the allowed requests are in flight", () => {
  const session = new Session();
  session.open({ limits: { ...limits, requests_in_flight_max: 5 } });
  const ids = Array.from({ length: 4 }, () => session.core.requests.add({ list_worlds: {} }));
  assert.deepEqual(session.requests().map((request) => request.request_id), ids.slice(0, 2));
  const urgent = session.core.requests.add({ pause: {} }, true);
  session.say({ response: { request_id: ids[0] } });
  assert.deepEqual(session.requests().map((request) => request.request_id), [urgent]);
  session.core.requests.forget(ids[1]); // no longer awaited, but still in flight
  assert.deepEqual(session.requests(), []);
  assert.deepEqual(session.say({ response: { request_id: ids[1] } }), []);
  assert.deepEqual(session.requests().map((request) => request.request_id), [ids[2]]);
});

test("invalid and long requests are refused at once", () => {
  const session = new Session();
  session.open({ limits: { ...limits, control_frame_bytes_max: 100 } });
  assert.throws(() => session.core.requests.add({ pause: { worlds: "a" } }), { message: /request\.pause\.worlds/ });
  assert.throws(() => session.core.requests.add({ pause: { world: "a".repeat(100) } }), { message: /bytes long, allowed: at most 100$/ });
  assert.throws(() => session.core.subscriptions.subscribe({ subscribe_snapshots: { rate: 1 } }), core.InvalidMessage);
  assert.deepEqual(session.requests(), []);
});

test("a replay is closed if its caller no longer waits", () => {
  const session = opened(), id = session.core.requests.add({ open_replay: { world: "a" } });
  session.requests();
  session.core.requests.forget(id);
  assert.deepEqual(session.say({ response: { request_id: id, world: { name: "replay-1" } } }), []);
  assert.deepEqual(session.requests().map((request) => request.close_replay), [{ world: "replay-1" }]);
});

// ---- subscriptions -----------------------------------------------------------------------------------------------------

test("subscriptions come before other requests and again in each session", () => {
  const session = new Session(), subscription = session.core.subscriptions.subscribe(snapshots());
  session.core.requests.add({ list_worlds: {} });
  session.open();
  const requests = session.requests();
  assert.deepEqual(requests.map((request) => Object.keys(request)[0]), ["subscribe_snapshots", "list_worlds"]);
  const events = session.say({ response: { request_id: requests[0].request_id, subscription: { subscription_id: 3, rate_hz: 25 } } });
  assert.deepEqual(kinds_of(events), ["subscribed"]);
  assert.deepEqual([subscription.server_id, subscription.rate_hz, subscription.sessions], [3, 25, 1]);
  session.core.lost(lost);
  assert.equal(subscription.server_id, null);
  session.open();
  session.accept(4);
  assert.deepEqual([subscription.server_id, subscription.sessions], [4, 2]);
});

test("events reach the subscriptions to their world", () => {
  const session = opened(), all = session.subscribe({ subscribe_events: {} }, 1), one = session.subscribe({ subscribe_events: { world: "b" } }, 2);
  const event = { world: "a", run_terminated: { outcome: "OUTCOME_EXTINCTION" } };
  assert.deepEqual(session.say({ event }), [{ kind: "event", subscription: all, event }]);
  const of_server = { server_going_away: {} };
  assert.deepEqual(session.say({ event: of_server }).map(({ subscription }) => subscription), [all, one]);
});

test("after a reconnect an event says that events may be missing", () => {
  const session = opened(), subscription = session.subscribe({ subscribe_events: {} });
  session.core.lost(lost);
  session.open();
  assert.deepEqual(session.accept(9), [{ kind: "subscribed", subscription }, { kind: "event", subscription, event: { events_dropped: {} } }]);
});

test("a refused subscription is reported and tried again in the next session", () => {
  const session = opened(), subscription = session.core.subscriptions.subscribe(snapshots()), [request] = session.requests();
  const status = { code: "CODE_NOT_FOUND", message: "no such world" };
  assert.deepEqual(session.say({ response: { request_id: request.request_id, status } }), [{ kind: "subscription_refused", subscription, status }]);
  assert.deepEqual(subscription.refused, status);
  session.core.lost(lost);
  session.open();
  session.accept(5);
  assert.equal(subscription.refused, null);
});

test("an ended subscription is cancelled at the server, even if it is accepted late", () => {
  const session = opened(), accepted = session.subscribe(snapshots(), 7);
  session.core.subscriptions.unsubscribe(accepted);
  const [request] = session.requests();
  assert.deepEqual(request.unsubscribe, { subscription_id: 7 });
  assert.deepEqual(session.say({ response: { request_id: request.request_id } }), []);
  assert.deepEqual(session.show({ ...deltas[0], subscription_id: 7 }), []);
  const late = session.core.subscriptions.subscribe(snapshots()), [subscribing] = session.requests();
  session.core.subscriptions.unsubscribe(late);
  assert.deepEqual(session.say({ response: { request_id: subscribing.request_id, subscription: { subscription_id: 8 } } }), []);
  assert.deepEqual(session.requests().map((one) => one.unsubscribe), [{ subscription_id: 8 }]);
  session.core.lost(lost);
  session.open();
  assert.deepEqual(session.requests(), []);
});

test("one change of a view is in flight, and the newest follows", () => {
  const view = (left_px) => ({ region: { left_px, top_px: 5, width_px: 10, height_px: 10 } });
  const session = opened(), subscription = session.core.subscriptions.subscribe({ subscribe_snapshots: { ...snapshots().subscribe_snapshots, view: view(1) } });
  session.core.subscriptions.set_view(subscription, view(2)); // before the subscription is accepted
  session.core.subscriptions.set_view(subscription, view(3));
  session.accept(7);
  const [first] = session.requests();
  assert.deepEqual(first.set_view, { subscription_id: 7, view: view(3) });
  session.core.subscriptions.set_view(subscription, view(4));
  session.core.subscriptions.set_view(subscription, view(5));
  assert.deepEqual(session.requests(), []);
  assert.deepEqual(session.say({ response: { request_id: first.request_id, subscription: { subscription_id: 7 } } }), []);
  const [second, ...more] = session.requests();
  assert.deepEqual([second.set_view.view, more], [view(5), []]);
  const status = { code: "CODE_INVALID_ARGUMENT", message: "no" };
  assert.deepEqual(session.say({ response: { request_id: second.request_id, status } }), [{ kind: "view_refused", subscription, status }]);
  session.core.lost(lost);
  session.open();
  assert.deepEqual(session.requests().map((request) => request.subscribe_snapshots.view), [view(3)]); // the last accepted one
});

// ---- snapshots ---------------------------------------------------------------------------------------------------------

test("snapshots are acknowledged once, by the caller", () => {
  const session = opened(), subscription = session.subscribe(snapshots());
  const [event] = session.show({ ...deltas[0], subscription_id: 7 });
  assert.deepEqual([event.kind, event.subscription], ["snapshot", subscription]);
  assert.equal(event.snapshot.organisms.id.length, 12);
  assert.equal(session.core.outgoing(), null);
  session.core.subscriptions.acknowledge(subscription, event.snapshot);
  session.core.subscriptions.acknowledge(subscription, event.snapshot);
  const sequence = deltas[0].sequence;
  assert.deepEqual(session.sent(), [{ acknowledge_snapshot: { subscription_id: 7, sequence } }]); // island 0 is omitted
});

test("a snapshot of an earlier session is not acknowledged", () => {
  const session = opened(), subscription = session.subscribe(snapshots());
  const [event] = session.show({ ...deltas[0], subscription_id: 7 });
  session.core.lost(lost);
  session.open();
  session.accept(7);
  session.core.subscriptions.acknowledge(subscription, event.snapshot);
  assert.deepEqual(session.sent(), []);
});

test("after damage a keyframe is requested and deltas are skipped", () => {
  const session = opened(), subscription = session.subscribe(snapshots());
  const of_session = deltas.map((frame) => ({ ...frame, subscription_id: 7 }));
  const keyframe = of_session.findIndex((frame, i) => i > 3 && !frame.base_sequence);
  assert.deepEqual(kinds_of(session.show(of_session[0])), ["snapshot"]);
  const events = session.show({ ...of_session[1], checksum: 1 });
  assert.deepEqual(events, [{ kind: "damaged", subscription, message: "a snapshot's checksum does not match its body" }]);
  const [request, acknowledgement] = session.sent();
  assert.deepEqual(request.request.request_keyframe, { subscription_id: 7 });
  assert.equal(acknowledgement.acknowledge_snapshot.sequence, of_session[1].sequence);
  assert.deepEqual(session.show(of_session[2]), []); // acknowledged, not decoded, and no further request
  assert.deepEqual(session.sent().map((message) => Object.keys(message)[0]), ["acknowledge_snapshot"]);
  assert.deepEqual(session.say({ response: { request_id: request.request.request_id } }), []);
  assert.deepEqual(kinds_of(session.show(of_session[keyframe])), ["snapshot"]);
  assert.deepEqual(kinds_of(session.show(of_session[keyframe + 1])), ["snapshot"]);
  assert.equal(session.core.subscriptions.damaged_snapshot_count, 1);
});

test("three damaged keyframes in a row close the session", () => {
  const session = opened();
  session.subscribe(snapshots());
  const damaged = { ...deltas[0], subscription_id: 7, checksum: 1 };
  assert.deepEqual([0, 1, 2].flatMap(() => kinds_of(session.show(damaged))), ["damaged", "damaged", "damaged"]);
  assert.equal(session.requests().length, 3);
  assert.deepEqual(session.show(damaged), [{ kind: "close", code: "",
                                              message: "here:1 sent damaged data: a snapshot's checksum does not match its body" }]);
  session.core.lost(lost);
  session.open();
  session.accept(7);
  assert.deepEqual(kinds_of(session.show({ ...deltas[0], subscription_id: 7 })), ["snapshot"]);
});

test("islands of one subscription are decoded apart", () => {
  const frames = vectors.filter((vector) => vector.case === "islands_deltas").map((vector) => vector.frame);
  const session = opened();
  session.subscribe(snapshots());
  const events = frames.flatMap((frame) => session.show({ ...frame, subscription_id: 7 }));
  assert.equal(events.length, frames.length);
  assert.deepEqual(new Set(events.map((event) => event.snapshot.info.island)), new Set([0, 1]));
});

test("messages cut at any byte give the same events", () => {
  const messages = [{ welcome: { protocol_version: 1, limits } }, { response: { request_id: 1 } }, { event: { world: "a" } }];
  const bytes = messages.flatMap((message) => [...core.encode_frame(schema.encode("evod.v1.ServerMessage", message))]);
  for (let cut = 0; cut <= bytes.length; ++cut) {
    const session = new Session();
    session.core.requests.add({ list_worlds: {} });
    session.core.opened();
    const events = [bytes.slice(0, cut), bytes.slice(cut)].flatMap((part) => session.core.received(new Uint8Array(part)));
    assert.deepEqual(kinds_of(events), ["opened", "response"], `cut at ${cut}`);
  }
});

test("a full event queue drops progress, never clients' events", () => {
  const queue = new core.EventQueue(10);
  for (let generation = 1; generation <= 25; ++generation) {
    queue.push({ generation_finished: { statistics: [{ generation }] } });
    if (generation === 3) {
      queue.push({ parameters_changed: { revision: 2 } });
    }
  }
  const events = queue.take();
  assert.ok(events.length <= 11 && queue.is_empty);
  assert.equal(events.filter((event) => event.parameters_changed).length, 1);
  const dropped = events.reduce((sum, event) => sum + (event.events_dropped?.dropped_count ?? 0), 0);
  assert.equal(dropped + events.filter((event) => event.generation_finished).length, 25);
});
