// What the page computes about classes: codes, order, comparison, the archive, and what members and teachers may do.
import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { test } from "node:test";
import { bundle } from "./bundle.mjs";
import { schema } from "./support.mjs";

globalThis.window = {}; // the page reads its storage; here there is none
const page = await bundle(
  "class/codes", "class/compare", "class/standing", "class/tar", "class/qr", "class/collecting", "class/tiles", "plots/history_table",
  "texts/access", "world/access", "world/names", "world/parameter_edits", "world/worlds");

test("codes are read as a student types them", () => {
  assert.equal(page.letters_of(" ktr-mxb "), "KTRMXB");
  assert.equal(page.is_personal("KTRMXB"), false);
  assert.equal(page.is_personal("KTRMXBKTRM"), true);
  assert.equal(page.spaced("KTRMXB"), "KTR MXB");
  assert.equal(page.spaced("KTRMXBLPQZ"), "KTRMX BLPQZ");
  assert.equal(page.join_link("http://lab:7745/", "KTRMXB"), "http://lab:7745/#join=KTRMXB");
});

// ---- standing and order ----

function table_of(best) {
  const table = new page.HistoryTable();
  table.add(best.map((fitness, i) => ({ generation: i + 1, island: 0, organism_count: 10, fitness_best: fitness, fitness_mean: fitness / 2 })));
  return table;
}

test("standing counts generations without improvement", () => {
  assert.deepEqual(page.standing_of(table_of([3, 7, 5, 7])), { generation: 4, best: 7, mean: 3.5, stuck: 2 });
  assert.equal(page.standing_of(table_of([-2])).best, -2);
  assert.equal(page.standing_of(table_of([])).generation, 0);
});

test("tiles are sorted by name, fitness and need of help", () => {
  const student = (name, best) => ({ name, standing: page.standing_of(table_of(best)) });
  const order = (by) => page.sort_by([student("b 10", [5]), student("b 2", [1, 9]), student("a", []), student("c", [4, 3, 2])], by).map(({ name }) => name);
  assert.deepEqual(order("name"), ["a", "b 2", "b 10", "c"]);
  assert.deepEqual(order("fitness"), ["b 2", "b 10", "c", "a"]);
  assert.deepEqual(order("help"), ["c", "a", "b 2", "b 10"]);
});

test("the small curve skips what is not finite", () => {
  assert.equal(page.curve_path([1]), "");
  assert.match(page.curve_path([NaN, 1, 2]), /^M50\.0 23\.0L100\.0 1\.0$/);
  assert.equal(page.curve_path(Array.from({ length: 5000 }, (_, i) => i)).match(/[ML]/g).length, 60);
});

// ---- comparison ----

const values = (fields) => new Map(Object.entries(fields).map(([name, real]) => [name, { real }]));

test("parameters that differ are found", () => {
  assert.deepEqual(page.differing([values({ a: 1, b: 2 }), values({ a: 1, b: 3 }), values({ a: 1, b: 2 })]), ["b"]);
  assert.deepEqual(page.differing([values({ a: 1 })]), []);
  assert.deepEqual(page.differing([]), []);
  assert.deepEqual(page.changed_since(values({ a: 1, b: 2 }), values({ a: 5, b: 2, c: 7 })), ["a"]);
});

test("a pending value counts as the value of a world", () => {
  const set = { parameters: [{ name: "a", value: { real: 1 }, pending: { real: 2 } }] };
  assert.deepEqual(page.values_of(set).get("a"), { real: 2 });
});

test("groups have their medians", () => {
  const worlds = [values({ a: 2 }), values({ a: 1 }), values({ a: 2 })].map((of, i) => ({ name: i, values: of }));
  assert.deepEqual(page.grouped_by(worlds, "a").map(({ value, members }) => [value.real, members.map(({ name }) => name)]), [[1, [1]], [2, [0, 2]]]);
  assert.deepEqual(page.median_of([{ x: [1, 2], y: [1, 5] }, { x: [1, 2, 3], y: [3, NaN, 9] }, { x: [1], y: [10] }]), { x: [1, 2, 3], y: [3, 5, 9] });
});

test("the start of a class follows from its template", () => {
  const registry = [
    { name: "a", kind: "PARAMETER_KIND_REAL", default_value: { real: 1 } }, { name: "n", kind: "PARAMETER_KIND_COUNT", default_value: { count: 3 } },
    { name: "s", kind: "PARAMETER_KIND_CHOICE", default_value: { choice: "x" } }, { name: "f", kind: "PARAMETER_KIND_FLAG", default_value: { flag: false } }];
  const template = { experiment_json: '{"description": "…", "n": {"1": 5, "9": 7}, "s": "y", "f": true}', parameters: [{ name: "a", value: { real: 4 } }] };
  assert.deepEqual(Object.fromEntries(page.start_of(template, registry)), { a: { real: 4 }, n: { count: 5 }, s: { choice: "y" }, f: { flag: true } });
  assert.equal(page.start_of({ experiment_json: "{" }, registry), null);
});

// ---- the archive ----

test("tar unpacks the archive", () => {
  const folder = mkdtempSync(path.join(tmpdir(), "evod-tar-"));
  const content = Uint8Array.from({ length: 1500 }, (_, i) => i % 251);
  const files = [{ name: "bio2/a.evod", content }, { name: "bio2/empty.csv", content: new Uint8Array() }, { name: "bio2/b.evod", content: content.slice(0, 512) }];
  writeFileSync(path.join(folder, "x.tar"), Buffer.concat(page.tar_of(files, 1_700_000_000)));
  assert.equal(execFileSync("tar", ["-xvf", "x.tar"], { cwd: folder, encoding: "utf8" }), "bio2/a.evod\nbio2/empty.csv\nbio2/b.evod\n");
  for (const file of files) {
    assert.deepEqual(new Uint8Array(readFileSync(path.join(folder, file.name))), file.content);
  }
  rmSync(folder, { recursive: true });
  assert.throws(() => page.tar_of([{ name: "x".repeat(101), content }], 0), RangeError);
});

test("the row of a student has what the teacher marks", () => {
  const student = { name: "=1+1", world: "bio2_fox", info: { run_id: "ab", generation: 9 }, standing: { generation: 8, best: 4.5, mean: NaN, stuck: 0 } };
  assert.deepEqual(page.row_of(student, values({ a: 1, b: 2 }), values({ a: 0.5, b: 2 }), "3"), ["'=1+1", "bio2_fox", "ab", "9", "4.5", "", "a=0.5", "3"]);
});

test("a QR code becomes runs of dark modules", () => {
  assert.equal(page.path_of({ size: 2, modules: Uint8Array.from([1, 1, 0, 1]) }), "M0 0h2v1h-2zM1 1h1v1h-1z");
});

// ---- what members and teachers may do ----

const own = { name: "bio2_fox", owner: "bio2/fox", class: "bio2" }, other = { name: "bio2_owl", owner: "bio2/owl", class: "bio2" };
const fork = { name: "bio2_fox_2", owner: "bio2/fox", class: "bio2" };

function access_of(welcome, worlds, classes = []) {
  const known = { find: (name) => worlds.find((world) => world.name === name) ?? null, is_own_replay: (name) => name === "replay-1" };
  const access = new page.Access(() => ({ phase: "open", welcome }), known, () => {});
  access.rules = schema.request_rules();
  access.roles = schema.enum_names("evod.v1.Role");
  access.classes = new Set(classes);
  return access;
}

const member = { role: "ROLE_VIEWER", user: "bio2/fox", membership: { class: "bio2", world: "bio2_fox" } };
const commands = ["run", "pause", "reset_world", "set_parameters", "place", "fork_world"];
const texts = page.access_texts;

test("a member controls the own worlds and no others", () => {
  const replay = { name: "replay-1", replay: { replay_of: "bio2_fox" } };
  const access = access_of(member, [own, other, fork, replay]);
  assert.equal(access.taking_part, true);
  for (const kind of commands) {
    assert.equal(access.why_not(kind, "bio2_fox"), "", kind);
    assert.equal(access.why_not(kind, "bio2_owl"), texts.own_worlds, kind);
  }
  assert.equal(access.why_not("fork_world", "replay-1"), "");
  assert.equal(access.why_not("delete_world", "bio2_fox_2"), "");
  assert.equal(access.why_not("delete_world", "bio2_fox"), texts.first_world);
  assert.equal(access.why_not("create_world"), texts.own_worlds);
  assert.equal(access.why_not("get_parameters", "bio2_owl"), "");
});

test("a frozen member has to wait", () => {
  const access = access_of(member, [{ ...own, frozen: true }]);
  for (const kind of commands) {
    assert.equal(access.why_not(kind, "bio2_fox"), texts.frozen, kind);
  }
  assert.equal(access.why_not("get_history", "bio2_fox"), "");
});

test("a teacher controls the worlds of the own classes", () => {
  const access = access_of({ role: "ROLE_TEACHER", user: "kay" }, [{ ...own, frozen: true }, { ...other, class: "chem" }], ["bio2"]);
  access.set_taking_part(true);
  assert.equal(access.may_teach, true);
  assert.equal(access.why_not("run", "bio2_fox"), "");
  assert.equal(access.why_not("run", "bio2_owl"), texts.own_classes);
  assert.equal(access.why_not("create_class"), "");
  assert.equal(access.why_not("for_each_world"), "");
});

test("a viewer cannot teach, and roles rise", () => {
  assert.equal(access_of({ role: "ROLE_VIEWER" }, []).may_teach, false);
  assert.equal(access_of({ role: "ROLE_CONTROLLER" }, []).may_teach, true);
  const access = access_of({ role: "ROLE_CONTROLLER" }, [own]);
  access.set_taking_part(true);
  assert.equal(access.why_not("run", "bio2_fox"), "");
  assert.equal(access.why_not("create_world"), texts.admin_only);
});

test("a member sees only the own worlds", () => {
  const worlds = new page.Worlds(() => {});
  worlds.show_only_of("bio2/fox");
  worlds.take_list({ worlds: [own, other, { name: "default" }], damaged: [{ name: "bio2_elk" }] });
  assert.deepEqual(worlds.names, ["bio2_fox"]);
  assert.equal(worlds.hides("bio2_owl"), true);
  worlds.take_event({ world: "bio2_owl_2", world_created: { world: { ...other, name: "bio2_owl_2" } } });
  worlds.take_event({ world: "bio2_fox_2", world_created: { world: fork } });
  assert.deepEqual(worlds.names, ["bio2_fox", "bio2_fox_2"]);
  worlds.take_event({ world: "bio2_fox", run_control_changed: { world: { ...own, frozen: true } } });
  assert.equal(worlds.find("bio2_fox").frozen, true);
  worlds.replay_opened({ name: "replay-1", replay: { replay_of: "bio2_fox" } });
  assert.notEqual(worlds.find("replay-1"), null);
  assert.equal(page.fork_name(own, worlds.taken_names), "bio2_fox_3");
  assert.equal(page.fork_name({ name: "default" }, worlds.taken_names), "default-2");
});

test("a class narrows the range of a slider", () => {
  const edits = new page.ParameterEdits();
  edits.describe([{ name: "n", min: 2, max: 1000, default_value: { count: 50 } }]);
  edits.update_all({ revision: 1, parameters: [{ name: "n", value: { count: 50 }, max: 500 }] });
  assert.deepEqual([edits.parameters[0].about.min, edits.parameters[0].about.max], [2, 500]);
  edits.update_changed({ revision: 2, changed: [{ name: "n", value: { count: 60 } }] });
  assert.equal(edits.parameters[0].about.max, 500);
  edits.forget();
  assert.equal(edits.parameters[0].about.max, 1000);
});
