// The processor time in which the page decodes snapshots of a real server, in node: protobuf, checksum, delta codec and tiles.
//
//     node web_decode.mjs EVOD [SNAPSHOTS]
//
// It records SNAPSHOTS (default 200) snapshots of worlds of 10,000 and 100,000 organisms at full speed, whole, and of a view of
// the larger world. Then it decodes them from memory several times. The first round is not counted.
import { spawn } from "node:child_process";
import net from "node:net";
import { createInterface } from "node:readline";
import { core, descriptor, schema } from "../unit/web/support.mjs";

const [evod, wanted = "200"] = process.argv.slice(2);
if (evod === undefined) {
  console.error("usage: web_decode.mjs EVOD [SNAPSHOTS]");
  process.exit(2);
}
const rounds = 4;

/** Starts a server. Returns its process and its port. */
async function start() {
  const server = spawn(evod, ["--port", "0", "--keep-nothing"], { stdio: ["ignore", "ignore", "pipe"] });
  const port = await new Promise((resolve, reject) => {
    createInterface(server.stderr).on("line", (line) => {
      const found = /listening on 127\.0\.0\.1:(\d+)/.exec(line);
      if (found !== null) {
        resolve(Number(found[1]));
      }
    });
    server.on("exit", () => reject(new Error("evod ended at once")));
  });
  return { server, port };
}

/** Returns the bodies of successive snapshots of a world. view: makes a View for an island of this size. */
async function record(organisms, view) {
  const { server, port } = await start();
  const client = new core.ClientCore(descriptor, { client_name: "web_decode", client_version: "", token: "", server: "evod" });
  const socket = net.connect(port, "127.0.0.1"), bodies = [], name = "w";
  const send = () => {
    const bytes = client.outgoing();
    if (bytes !== null) {
      socket.write(bytes);
    }
  };
  const area_px2 = organisms * 46_080; // the density of experiments/bench.json
  const counts = { population_size: organisms, food_count: 2.5 * organisms, poison_count: 1.5 * organisms };
  const sizes = { island_width_px: Math.sqrt(area_px2 * 16 / 9), island_height_px: Math.sqrt(area_px2 * 9 / 16) };
  const parameters = [...Object.entries(counts).map(([field, count]) => ({ name: field, value: { count } })),
                      ...Object.entries(sizes).map(([field, real]) => ({ name: field, value: { real } }))];
  client.request({ create_world: { name, seed: 1, parameters } });
  client.request({ set_speed: { world: name, speed: { real_time_factor: 1 } } });
  client.request({ run: { world: name } });
  client.opened();
  let subscription = null;
  const done = new Promise((resolve, reject) => {
    const frames = new core.FrameReader(); // a second one, because the core does not return frames
    socket.on("data", (bytes) => {
      frames.feed(new Uint8Array(bytes));
      for (let frame = frames.next(); frame !== null; frame = frames.next()) {
        if (frame.channel === core.stream_channel) {
          bodies.push(frame.body.slice());
        }
      }
      for (const event of client.received(new Uint8Array(bytes))) {
        if (event.kind === "snapshot") {
          client.acknowledge(subscription, event.snapshot);
        } else if (event.kind === "close" || (event.kind === "response" && event.response.status !== undefined)) {
          reject(new Error(JSON.stringify(event)));
        } else if (event.kind === "response" && event.id === 1) {
          subscription = client.subscribe({ subscribe_snapshots: {
            world: name, rate_hz: 60, codec: "CODEC_DELTA", unacknowledged_max: 2, 
            ...(view === undefined ? {} : { view: view(sizes) }) } });
        }
      }
      send();
      if (bodies.length >= Number(wanted)) {
        resolve();
      }
    });
  });
  send();
  try {
    await done;
  } finally {
    socket.destroy();
    server.kill();
  }
  return bodies;
}

/** The processor time of all threads of this process, garbage collection included. */
function cpu_ms() {
  const { user, system } = process.cpuUsage();
  return (user + system) / 1000;
}

function percentile(sorted, share) {
  return sorted[Math.min(sorted.length - 1, Math.floor(share * sorted.length))];
}

function measure(what, bodies) {
  const protobuf = [], decoding = [];
  let entities = 0;
  for (let round = 0; round < rounds; ++round) {
    const decoder = new core.SnapshotDecoder();
    for (const body of bodies) {
      const begin = cpu_ms(), frame = schema.decode("evod.v1.SnapshotFrame", body), between = cpu_ms();
      const snapshot = decoder.decode(frame), end = cpu_ms();
      entities = snapshot.organisms.id.length + snapshot.food.id.length + snapshot.poison.id.length;
      if (round > 0) {
        protobuf.push(between - begin);
        decoding.push(end - between);
      }
    }
  }
  const figures = (times) => {
    times.sort((a, b) => a - b);
    return `p50 ${percentile(times, 0.5).toFixed(2)} ms, p95 ${percentile(times, 0.95).toFixed(2)} ms`;
  };
  const bytes = bodies.reduce((sum, body) => sum + body.length, 0) / bodies.length;
  console.log(`${what}: ${bodies.length} snapshots of ${entities} entities, ${(bytes / 1000).toFixed(1)} kB each; ` +
              `protobuf ${figures(protobuf)}; decoding ${figures(decoding)}`);
}

measure("10,000 organisms", await record(10_000));
measure("100,000 organisms", await record(100_000));
const middle = ({ island_width_px, island_height_px }) => ({
  region: { left_px: island_width_px / 3, top_px: island_height_px / 3, width_px: island_width_px / 3, height_px: island_height_px / 3 },
});
measure("a ninth of 100,000 organisms", await record(100_000, middle));
