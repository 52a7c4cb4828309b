// Wire frames from pieces of any size, and damaged headers.
import assert from "node:assert/strict";
import { test } from "node:test";
import { core } from "./support.mjs";

function frame_of(channel, body) {
  return [0x45, 0x56, 1, channel, body.length & 255, body.length >> 8, 0, 0, ...body];
}

const bodies = [[1, 2, 3], [], Array.from({ length: 300 }, (_, i) => i & 255), [9]];
const stream = bodies.flatMap((body, i) => frame_of(1 + i % 2, body));
const frames = bodies.map((body, i) => ({ channel: 1 + i % 2, body }));

/** Feeds pieces and returns all frames. */
function read(pieces) {
  const reader = new core.FrameReader(), read_frames = [];
  for (const piece of pieces) {
    reader.feed(new Uint8Array(piece));
    for (let frame = reader.next(); frame !== null; frame = reader.next()) {
      read_frames.push({ channel: frame.channel, body: frame.body });
    }
  }
  return read_frames.map(({ channel, body }) => ({ channel, body: Array.from(body) }));
}

test("a stream cut at any byte gives the same frames", () => {
  for (let cut = 0; cut <= stream.length; ++cut) {
    assert.deepEqual(read([stream.slice(0, cut), stream.slice(cut)]), frames, `cut at ${cut}`);
  }
});

test("single bytes and everything at once give the same frames", () => {
  assert.deepEqual(read(stream.map((byte) => [byte])), frames);
  assert.deepEqual(read([stream]), frames);
  assert.deepEqual(read([[], stream, []]), frames);
});

test("bodies stay valid while further bytes arrive", () => {
  const reader = new core.FrameReader(), kept = [];
  for (let round = 0; round < 3; ++round) {
    for (const byte of stream) {
      reader.feed(new Uint8Array([byte]));
      for (let frame = reader.next(); frame !== null; frame = reader.next()) {
        kept.push(frame.body);
      }
    }
  }
  assert.deepEqual(kept.map((body) => Array.from(body)), [...bodies, ...bodies, ...bodies]);
});

test("a written frame is read again", () => {
  const body = new Uint8Array([5, 6]);
  assert.deepEqual(read([core.encode_frame(body)]), [{ channel: 1, body: [5, 6] }]);
});

test("damaged headers are refused at the first wrong byte", () => {
  const refused = (bytes, message) => assert.throws(() => read([bytes]), { name: "DamagedData", message });
  refused([0x46], /does not begin with 'EV'/);
  refused([0x45, 0x57], /does not begin with 'EV'/);
  refused([0x45, 0x56, 2], /framing version 2, not 1/);
  refused([0x45, 0x56, 1, 0], /channel 0, not 1 or 2/);
  refused([0x45, 0x56, 1, 3], /channel 3, not 1 or 2/);
  refused([0x45, 0x56, 1, 1, 1, 0, 0, 4], /declares 67108865 bytes, allowed on its channel: at most 67108864/);
  refused([0x45, 0x56, 1, 2, 1, 0, 0, 16], /declares 268435457 bytes/);
});

test("memory follows received bytes, not the declared length", () => {
  const reader = new core.FrameReader();
  reader.feed(new Uint8Array([0x45, 0x56, 1, 2, 0, 0, 0, 16])); // 256 MiB
  const before = process.memoryUsage().arrayBuffers;
  for (let i = 0; i < 1000; ++i) {
    reader.feed(new Uint8Array(100));
    assert.equal(reader.next(), null);
  }
  assert.ok(process.memoryUsage().arrayBuffers - before < 16e6);
});
