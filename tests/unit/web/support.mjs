// Support of the tests of client/web/src/core: bundles the core, makes the descriptor set, and reads the test vectors.
import { execFileSync } from "node:child_process";
import { webcrypto } from "node:crypto";
import { mkdtempSync, readdirSync, readFileSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";

globalThis.crypto ??= webcrypto; // node 18 has it in a module only

const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../../..");
const folder = path.join(root, "client/web/src/core");
const made = mkdtempSync(path.join(tmpdir(), "evod-web-"));

const all = readdirSync(folder).map((file) => `export * from "./${file.replace(/\.ts$/, "")}";\n`).join("");
execFileSync("esbuild", ["--bundle", "--format=esm", "--loader=ts", "--log-level=warning", `--outfile=${made}/core.mjs`],
             { cwd: folder, input: all });
export const core = await import(`${made}/core.mjs`);

execFileSync("protoc", [`-I${root}/proto`, "-I/usr/include", "--include_imports", `--descriptor_set_out=${made}/protocol.bin`,
                        ...["commands", "session", "stream", "world"].map((name) => `${root}/proto/evod/v1/${name}.proto`)]);
/** What /protocol.bin contains. */
export const descriptor = new Uint8Array(readFileSync(`${made}/protocol.bin`));
rmSync(made, { recursive: true });
export const schema = new core.Schema(descriptor);

export const kinds = ["organisms", "food", "poison", "crates", "obstacles"];

/** Returns a file of proto/vectors. */
export function vectors_file(name) {
  return readFileSync(path.join(root, "proto/vectors", name));
}

/** Returns the vectors in the order of the files: { name, case, codec, body, frame, decoded }. */
export function read_vectors() {
  const lines = vectors_file("snapshots.jsonl").toString().trimEnd().split("\n").map((line) => JSON.parse(line));
  const reader = new core.FrameReader(), vectors = [];
  reader.feed(new Uint8Array(vectors_file("snapshots.frames")));
  for (let i = 0, wire = reader.next(); wire !== null; ++i, wire = reader.next()) {
    const { case: of, codec, frame_bytes, frame_crc32, ...decoded } = lines[i];
    vectors.push({ name: `${of}, line ${i + 1}`, case: of, codec, frame_bytes, frame_crc32, body: wire.body,
                   frame: schema.decode("evod.v1.SnapshotFrame", wire.body),
                   decoded: "same_as_line" in decoded ? vectors[decoded.same_as_line - 1].decoded : decoded });
  }
  if (vectors.length !== lines.length) {
    throw new Error("proto/vectors: there are more lines than frames");
  }
  return vectors;
}
