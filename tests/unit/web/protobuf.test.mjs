// Protobuf by the descriptor set: round trips, agreement with protoc, and damaged input.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import path from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { core, descriptor, read_vectors, schema } from "./support.mjs";

const protos = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../../../proto");
const protoc = (action, type, file, input) =>
  execFileSync("protoc", [`-I${protos}`, `--${action}=evod.v1.${type}`, `evod/v1/${file}.proto`], { input });

const request = {
  request_id: 2 ** 53 - 1, client_key: "ключ", create_world: {
    name: "a", seed: 18446744073709551615n,
    parameters: [{ name: "mutation_chance", value: { real: 0.5 } }, { name: "food_count", value: { count: 4294967295 } },
                 { name: "wrap", value: { flag: false } }, { name: "selection", value: { choice: "" } }],
    population: [{ genes: [0, -1.5, 3] }],
  },
};

test("a message is the same after writing and reading", () => {
  assert.deepEqual(schema.decode("evod.v1.Request", schema.encode("evod.v1.Request", request)), request);
  const event = { world: "a", time_ms: -1, run_terminated: { outcome: "OUTCOME_EXTINCTION" } };
  assert.deepEqual(schema.decode("evod.v1.Event", schema.encode("evod.v1.Event", event)), event);
  const frame = { run_id: new Uint8Array([1, 255]), checksum: 0xffffffff, tiles: [{ tile: 3 }, {}], simulated_s: -0.25 };
  assert.deepEqual(schema.decode("evod.v1.SnapshotFrame", schema.encode("evod.v1.SnapshotFrame", frame)), frame);
});

test("a message of any length is written", () => {
  for (let length = 1; length < 1100; ++length) { // some fill the writer's memory exactly, and a tag follows
    const message = { create_world: { experiment_json: "x".repeat(length), population_gene_names: ["y"] } };
    assert.deepEqual(schema.decode("evod.v1.Request", schema.encode("evod.v1.Request", message)), message);
  }
});

test("protoc reads what the writer writes", () => {
  const text = protoc("decode", "Request", "commands", schema.encode("evod.v1.Request", request)).toString();
  assert.deepEqual(schema.decode("evod.v1.Request", new Uint8Array(protoc("encode", "Request", "commands", text))), request);
  assert.match(text, /seed: 18446744073709551615/);
  assert.match(text, /flag: false/); // members of a oneof are written even if they are 0
});

test("the values of fields without presence are omitted", () => {
  assert.deepEqual(schema.encode("evod.v1.Response", { request_id: 0 }), new Uint8Array(0));
  assert.deepEqual(schema.encode("evod.v1.Response", { applied_tick: 0 }), new Uint8Array([3 << 3, 0]));
  assert.deepEqual(schema.encode("evod.v1.View", { detail: "DETAIL_UNSPECIFIED" }), new Uint8Array(0));
  assert.equal(schema.decode("evod.v1.Response", new Uint8Array([3 << 3, 0])).applied_tick, 0);
});

test("whole numbers of 64 bits are exact up to 2^53, seeds always", () => {
  for (const value of [0, 1, 2 ** 32 - 1, 2 ** 32, 2 ** 53 - 1, 2n ** 53n + 1n, 2n ** 64n - 1n]) {
    const { seed } = schema.decode("evod.v1.CreateWorld", schema.encode("evod.v1.CreateWorld", { seed: value }));
    assert.equal(BigInt(seed), BigInt(value));
    assert.equal(typeof seed, value < 2 ** 53 ? "number" : "bigint");
    const { at_tick } = schema.decode("evod.v1.SetParameters", schema.encode("evod.v1.SetParameters", { at_tick: value }));
    assert.equal(at_tick, Number(value));
  }
  for (const value of [-1, -(2 ** 31), -(2n ** 63n), 2n ** 63n - 1n]) {
    const { time_ms } = schema.decode("evod.v1.Event", schema.encode("evod.v1.Event", { time_ms: value }));
    assert.equal(time_ms, Number(value));
  }
});

test("kind_of names what an event is about", () => {
  const event = schema.decode("evod.v1.Event", schema.encode("evod.v1.Event", { world: "a", tick: 3, placed: { food: [1] } }));
  assert.deepEqual(core.kind_of(event), { kind: "placed", value: { food: [1] } });
  assert.equal(core.kind_of({ world: "a" }), null);
});

test("unpacked, packed and divided repeated fields are equal", () => {
  const packed = [2 << 3 | 2, 2, 5, 6], single = [2 << 3, 5, 2 << 3, 6], divided = [2 << 3, 5, 2 << 3 | 2, 1, 6];
  for (const bytes of [packed, single, divided]) { // AwaitedFitness.islands
    assert.deepEqual(schema.decode("evod.v1.AwaitedFitness", new Uint8Array(bytes)), { islands: [5, 6] });
  }
});

test("parts of a message are merged", () => {
  const a = schema.encode("evod.v1.Response", { status: { message: "a", violations: [{ field: "x" }] } });
  const b = schema.encode("evod.v1.Response", { status: { code: "CODE_NOT_FOUND", violations: [{ field: "y" }] } });
  assert.deepEqual(schema.decode("evod.v1.Response", new Uint8Array([...a, ...b])),
                   { status: { message: "a", code: "CODE_NOT_FOUND", violations: [{ field: "x" }, { field: "y" }] } });
});

test("the last member of a oneof replaces the others", () => {
  const bytes = [...schema.encode("evod.v1.ParameterValue", { real: 1 }), ...schema.encode("evod.v1.ParameterValue", { count: 2 })];
  assert.deepEqual(schema.decode("evod.v1.ParameterValue", new Uint8Array(bytes)), { count: 2 });
});

test("unknown fields, groups and wire types are skipped", () => {
  const group = [1000 << 3 & 127 | 3 | 128, 1000 >> 4, 1 << 3, 5, 1000 << 3 & 127 | 4 | 128, 1000 >> 4];
  const bytes = [...group, 5 << 3, 1, 5 << 3 | 1, 0, 0, 0, 0, 0, 0, 0, 0, 5 << 3 | 2, 1, 9, 5 << 3 | 5, 0, 0, 0, 0,
                 1 << 3 | 5, 1, 1, 1, 1, // request_id of another wire type
                 1 << 3, 7];
  assert.deepEqual(schema.decode("evod.v1.Response", new Uint8Array(bytes)), { request_id: 7 });
});

test("an unknown number of an enum stays a number", () => {
  assert.deepEqual(schema.decode("evod.v1.Status", new Uint8Array([1 << 3, 99])), { code: 99 });
  assert.deepEqual(schema.encode("evod.v1.Status", { code: 99 }), new Uint8Array([1 << 3, 99]));
});

test("bytes are views", () => {
  const bytes = schema.encode("evod.v1.SnapshotFrame", { body: new Uint8Array([1, 2, 3]) });
  assert.equal(schema.decode("evod.v1.SnapshotFrame", bytes).body.buffer, bytes.buffer);
});

test("rules of requests are read by reflection", () => {
  const rules = schema.request_rules();
  assert.deepEqual(rules.get("seek"), { kind: "REQUEST_KIND_REPLAY", role: "ROLE_CONTROLLER", viewer_in_own_replay: true, answer: "world" });
  assert.deepEqual(rules.get("delete_world"), { kind: "REQUEST_KIND_COMMAND", role: "ROLE_ADMIN", by_owner: true });
  const oneof = schema.type("evod.v1.Request").fields.filter((field) => field.oneof !== null).map((field) => field.name);
  assert.deepEqual([...rules.keys()], oneof);
  assert.deepEqual(schema.enum_names("evod.v1.Role"), ["ROLE_UNSPECIFIED", "ROLE_VIEWER", "ROLE_TEACHER", "ROLE_CONTROLLER", "ROLE_ADMIN"]);
});

test("a message that does not fit its type is refused by name", () => {
  const refused = (message, pattern) =>
    assert.throws(() => schema.encode("evod.v1.Request", message), { name: "InvalidMessage", message: pattern });
  refused({ run: { generations: 1.5 } }, /^run\.generations: got 1\.5, allowed: a whole number from 0 to 18446744073709551615$/);
  refused({ run: { generations: -1 } }, /^run\.generations: got -1/);
  refused({ run: { worlds: "a" } }, /^run\.worlds: evod\.v1\.Run has no field of this name$/);
  refused({ run: [] }, /^run: got a list, allowed: a evod\.v1\.Run$/);
  refused({ pause: { world: 5 } }, /^pause\.world: got 5, allowed: a text$/);
  refused({ set_parameters: { dry_run: 1 } }, /^set_parameters\.dry_run: got 1, allowed: true or false$/);
  refused({ set_parameters: { parameters: {} } }, /^set_parameters\.parameters: got an object, allowed: a list$/);
  refused({ subscribe_snapshots: { codec: "CODEC_X" } }, /^subscribe_snapshots\.codec: got CODEC_X, allowed: CODEC_UNSPECIFIED, /);
  refused({ create_world: { parameters: [{ value: { real: "1" } }] } }, /^create_world\.parameters\[0\]\.value\.real: got 1, allowed: a number$/);
});

test("absent and null fields are not written", () => {
  assert.deepEqual(schema.encode("evod.v1.Request", { run: null, pause: undefined }), new Uint8Array(0));
});

// ---- damaged input -----------------------------------------------------------------------------------------------------

const damaged = (bytes, type = "evod.v1.Response") => {
  assert.throws(() => schema.decode(type, new Uint8Array(bytes)), core.DamagedData, String(bytes));
};

test("damaged fields are refused", () => {
  damaged([1 << 3]); // no value
  damaged([1 << 3, 128, 128]); // the number does not end
  damaged([1 << 3, ...Array(10).fill(255), 1]); // 11 bytes
  damaged([0, 0]); // field number 0
  damaged([2 << 3 | 2, 5, 1]); // the length is beyond the end
  damaged([2 << 3 | 2, 255, 255, 255, 255, 255, 255, 255, 255, 255, 1]); // 2^64 - 1 bytes
  damaged([5 << 3 | 6]); // no such wire type
  damaged([5 << 3 | 4]); // the end of no group
  damaged([5 << 3 | 3, 14 << 3 | 4]); // the end of another group
  damaged([5 << 3 | 3, 1 << 3, 1]); // a group without end
  damaged([2 << 3 | 2, 1, 0xff], "evod.v1.Status"); // not UTF-8
  damaged([2 << 3 | 2, 3, 1, 128, 128], "evod.v1.AwaitedFitness"); // the packed field ends within a number
});

test("deep nesting is refused", () => {
  damaged(Array(200).fill(5 << 3 | 3));
  let bytes = []; // google.protobuf.DescriptorProto.nested_type
  for (let depth = 0; depth < 150; ++depth) {
    const length = bytes.length < 128 ? [bytes.length] : [bytes.length & 127 | 128, bytes.length >> 7];
    bytes = [3 << 3 | 2, ...length, ...bytes];
  }
  damaged(bytes, "google.protobuf.DescriptorProto");
});

test("each cut of a frame is read or refused as damaged", () => {
  const { body } = read_vectors().find(({ frame }) => (frame.tiles ?? []).length > 2);
  for (let length = 0; length < body.length; ++length) {
    try {
      schema.decode("evod.v1.SnapshotFrame", body.slice(0, length));
    } catch (error) {
      assert.ok(error instanceof core.DamagedData, error);
    }
  }
});

test("random changes are read or refused as damaged", () => {
  const messages = [["evod.v1.SnapshotFrame", read_vectors().find(({ frame }) => (frame.tiles ?? []).length > 2).body],
                    ["google.protobuf.FileDescriptorSet", descriptor.slice(0, 4000)],
                    ["evod.v1.Request", schema.encode("evod.v1.Request", request)]];
  let state = 1, refused = 0;
  const random = (end) => (state = Math.imul(state, 1103515245) + 12345 >>> 0) % end;
  for (let i = 0; i < 6000; ++i) {
    const [type, sound] = messages[i % messages.length], bytes = sound.slice();
    for (let change = random(3); change >= 0; --change) {
      bytes[random(bytes.length)] = random(2) ? random(256) : 255;
    }
    try {
      schema.decode(type, bytes);
    } catch (error) {
      assert.ok(error instanceof core.DamagedData, error);
      ++refused;
    }
  }
  assert.ok(refused > 500, String(refused));
});

test("a damaged descriptor is refused", () => {
  for (let length = 1; length < descriptor.length; length += 97) {
    try {
      new core.Schema(descriptor.slice(0, length)).type("evod.v1.Request");
    } catch (error) {
      assert.ok(error instanceof core.DamagedData || error instanceof core.InvalidMessage, error);
    }
  }
});
