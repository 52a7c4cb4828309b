// What the page computes about lessons: texts, predictions, observations, answers, notes, and where a user is.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { bundle } from "./bundle.mjs";

const page = await bundle(
  "lesson/text", "lesson/curve", "lesson/observing", "lesson/answers", "lesson/course", "lesson/notes", "lesson/settings", "lesson/player",
  "world/lesson_link");
const folder = new URL("../../../experiments/lessons/", import.meta.url);
const files = ["", "de/"].flatMap((language) => readdirSync(new URL(language, folder)).filter((name) => name.endsWith(".json")).map((name) => language + name));
const read = (name) => JSON.parse(readFileSync(new URL(name, folder), "utf8"));

// ---- texts ----

test("a text has paragraphs, lists and marks", () => {
  assert.deepEqual(page.blocks_of("one *two*\nthree\n\n- a\n- **b** `c`\n\nend"), [
    { kind: "paragraph", spans: [{ mark: "", text: "one " }, { mark: "em", text: "two" }, { mark: "", text: " three" }] },
    { kind: "list", items: [[{ mark: "", text: "a" }], [{ mark: "strong", text: "b" }, { mark: "", text: " " }, { mark: "code", text: "c" }]] },
    { kind: "paragraph", spans: [{ mark: "", text: "end" }] }]);
});

test("a list may follow a line, and HTML is only text", () => {
  assert.deepEqual(page.blocks_of("see:\n- a").map(({ kind }) => kind), ["paragraph", "list"]);
  assert.deepEqual(page.spans_of("<b>2 * 3</b>"), [{ mark: "", text: "<b>2 * 3</b>" }]);
});

test("no text of a lesson keeps a mark", () => {
  assert.ok(files.length >= 2);
  for (const file of files) {
    for (const { text, title } of read(file).steps) {
      const spans = page.blocks_of(text).flatMap((block) => block.spans ?? block.items.flat());
      assert.ok(spans.length > 0, `${file}: ${title}`);
      spans.forEach((span) => assert.doesNotMatch(span.text, /\*\*|`|^- /, `${file}: ${title}`));
    }
  }
});

// ---- curves ----

const curve_question = { kind: "curve", id: "c", ask: "?", x: { label: "x", min: 0, max: 30 }, y: { label: "y", min: 0, max: 10 } };

test("the pointer draws a curve without gaps", () => {
  const curve = new page.DrawnCurve(curve_question);
  curve.draw(3, 1, true);
  curve.draw(6, 4, false);
  assert.deepEqual(curve.points, [[3, 1], [4, 2], [5, 3], [6, 4]]);
  curve.draw(-5, 99, true); // beyond the axes, and not connected
  assert.deepEqual(curve.points[0], [0, 10]);
  assert.equal(curve.points.length, 5);
});

test("typed values make straight lines", () => {
  const curve = new page.DrawnCurve(curve_question);
  curve.set_field(0, 2);
  assert.equal(curve.points.length, 1);
  curve.set_field(1, 8);
  assert.deepEqual(curve.points.map(([, y]) => y), [2, 3, 4, 5, 6, 7, 8]);
  assert.deepEqual(curve.field(1), { x: 6, y: 8 });
  curve.set_field(1, null);
  assert.deepEqual(curve.points, [[0, 2]]);
  curve.clear();
  assert.deepEqual(curve.points, []);
});

test("a curve is constant beyond its points", () => {
  const points = [[1, 10], [3, 30]];
  assert.deepEqual([0, 1, 2, 3, 9].map((x) => page.value_at(points, x)), [10, 10, 20, 30, 30]);
  assert.equal(page.distance(points, [0, 2, 5], [13, 20, 26]), 5 / Math.sqrt(3));
});

// ---- observations ----

test("earlier numbers are put into expressions", () => {
  const known = new Map([["before", -2.5], ["none", null], ["big", 1e21]]);
  assert.equal(page.filled("a[20] / {before}", known), "a[20] / (-2.5)");
  assert.equal(page.filled("{big}", known), "(1e21)");
  assert.equal(page.filled("{none} + 1", known), null);
  assert.equal(page.filled("{unknown}", known), null);
});

test("answers find their observations", () => {
  const step = { observe: { a: "mean(c)", b: { each: "c[{x}]", at: [1, 5] }, lost: "{none}" }, law: { text: "", of: "a", value: "3", error: "1" } };
  const asked = page.asked_by(step, new Map([["none", null]]));
  assert.deepEqual(asked.expressions, ["mean(c)", "c[1]", "c[5]", "3", "1"]);
  const { observed, law } = page.values_of(asked, [7, undefined, 9, 3, 1]);
  assert.deepEqual([...observed], [["a", 7], ["b", [null, 9]], ["lost", null]]);
  assert.deepEqual(law, { value: 3, error: 1 });
});

test("a step asks for at most 32 expressions", () => {
  for (const file of files) {
    const known = new Map(read(file).steps.flatMap(({ observe = {} }) => Object.keys(observe).map((name) => [name, 1])));
    for (const step of read(file).steps) {
      const { expressions } = page.asked_by(step, known);
      assert.ok(expressions.length <= 32, file);
      expressions.forEach((one) => assert.doesNotMatch(one, /[{}]/, file));
    }
  }
});

// ---- answers ----

const lesson_with = (step) => ({ steps: [{ observe: { line: { each: "c[{x}]", at: [0, 2] } }, predict: { id: "p", kind: "number" }, ...step }] });
const answer = (check, predicted, known, law = null, more = {}) => {
  const lesson = lesson_with({ check, ...more });
  return page.answer_of(lesson, lesson.steps[0], new Map([["p", predicted]]), new Map(Object.entries(known)), law);
};

test("numbers are compared within a distance", () => {
  assert.deepEqual(answer({ near: "n", within: 2 }, 12, { n: 14.5 }), { id: "p", predicted: 12, observed: 14.5, passed: false, apart: -2.5 });
  assert.equal(answer({ near: "n", within: 2.5 }, 12, { n: 14.5 }).passed, true);
  assert.equal(answer({ near: "n", within_percent: 10 }, -11, { n: -10 }).passed, true);
  assert.deepEqual(answer({ near: "n", within: 2 }, 12, { n: null }), { id: "p", predicted: 12 });
});

test("a choice is right if its observation is the largest", () => {
  assert.deepEqual(answer({ argmax: ["a", "b"] }, 0, { a: 3, b: 3 }), { id: "p", predicted: 0, observed: 0, passed: true });
  assert.deepEqual(answer({ argmin: ["a", "b"] }, 0, { a: 3, b: 2 }), { id: "p", predicted: 0, observed: 1, passed: false });
});

test("an order counts the pairs that are wrong", () => {
  assert.deepEqual(answer({ order: ["a", "b", "c"] }, [2, 0, 1], { a: 1, b: 3, c: 2 }), { id: "p", predicted: [2, 0, 1], observed: [1, 2, 0], passed: false, apart: 2 });
  assert.deepEqual(page.order_of([1, 5, 5]), [1, 2, 0]);
});

test("a curve is compared at the places of the observation", () => {
  assert.deepEqual(answer({ curve: "line", within: 1 }, [[0, 1], [2, 3]], { line: [1, 3] }), { id: "p", predicted: [[0, 1], [2, 3]], observed: [1, 3], passed: true, apart: 0 });
  assert.deepEqual(answer({ curve: "line", within: 1 }, [[0, 1], [2, 3]], { line: [1, null] }), { id: "p", predicted: [[0, 1], [2, 3]] });
});

test("a law needs no prediction", () => {
  const law = { text: "1", of: "n", value: "1", error: "2" }, lesson = { steps: [{ law }] };
  assert.deepEqual(page.answer_of(lesson, lesson.steps[0], new Map(), new Map([["n", 5]]), { value: 4, error: 2 }), { id: "n", observed: 5, law: 4, error: 2 });
  assert.deepEqual(answer({ near: "n", within: 9 }, 1, { n: 2 }, { value: 4, error: null }, { law }), { id: "p", predicted: 1, observed: 2, passed: true, apart: -1, law: 4 });
});

// ---- notes ----

const prediction = (id, value, step = 1) => ({ kind: "lesson_prediction", lesson: "drift", step, id, value });

test("notes are read as they are written", () => {
  const note = prediction("fixed", 12, 2), row = (fields) => JSON.stringify({ number: 4, tick: 0, user: "", ...fields });
  assert.equal(page.note_text(note), '{"lesson":"drift","step":2,"id":"fixed","value":12}');
  assert.deepEqual(page.read_note(row({ kind: note.kind, text: page.note_text(note) }), "drift"), note);
  for (const wrong of [row({ kind: "lesson_prediction", text: "no JSON" }), row({ kind: "remark", text: page.note_text(note) }), "{", row({ kind: note.kind, text: "{}" })]) {
    assert.equal(page.read_note(wrong, "drift"), null, wrong);
  }
  assert.equal(page.read_note(row({ kind: note.kind, text: page.note_text(note) }), "other"), null);
});

test("the longest prediction fits into a note", () => {
  const longest = prediction("a".repeat(32), "ß漢".repeat(500));
  assert.ok(new TextEncoder().encode(page.note_text(longest)).length <= page.note_bytes_max);
});

test("remembered notes follow those of the run", () => {
  const [a, b] = [prediction("a", 1), prediction("b", [1, 2])];
  const kept = page.united("run 2", [a], [{ note: { ...a }, run: "run 1" }, { note: b, run: "run 1" }]);
  assert.deepEqual(kept, [{ note: a, run: "run 2" }, { note: b, run: "run 1" }]);
});

// ---- where a user is ----

const lesson = { steps: [
  { title: "number", text: "", predict: { id: "n", kind: "number" }, do: { run: 1 }, observe: { seen: "x", also: "y" }, check: { near: "seen", within: 1 } },
  { title: "text", text: "" },
  { title: "act", text: "", do: { set: { a: 1 } } },
  { title: "sentence", text: "", predict: { id: "s", kind: "sentence" } }] };
const observation = (id, value) => ({ kind: "lesson_observation", lesson: "l", step: 1, id, value });

test("a run is offered when the prediction is given", () => {
  assert.deepEqual([0, 1, 2].map((i) => new page.Course(lesson, []).phase(i)), ["predict", "done", "do"]);
  const given = new page.Course(lesson, [prediction("n", 3)]);
  assert.equal(given.phase(0), "do");
  assert.equal(given.open, 0);
});

test("a step is done when all is observed", () => {
  const notes = [prediction("n", 3), observation("seen", null)];
  assert.equal(new page.Course(lesson, notes).phase(0), "do");
  const course = new page.Course(lesson, [...notes, observation("also", 2)]);
  assert.equal(course.phase(0), "done");
  assert.equal(course.open, 2);
});

test("a step without observations is remembered", () => {
  const notes = [prediction("n", 3), observation("seen", 1), observation("also", 2)];
  assert.equal(new page.Course(lesson, notes, new Set([2])).open, 3);
  const later = new page.Course(lesson, [...notes, prediction("s", "why", 4)]);
  assert.equal(later.is_finished, true);
  assert.equal(later.open, 3);
});

test("the last note of an id counts", () => {
  const course = new page.Course(lesson, [prediction("n", 3), prediction("n", 4),
                                          { kind: "lesson_answer", lesson: "l", step: 1, id: "n", predicted: 4, observed: 5, passed: true, apart: -1 }]);
  assert.equal(course.predictions.get("n"), 4);
  assert.deepEqual(course.answer(0), { id: "n", predicted: 4, observed: 5, passed: true, apart: -1 });
});

// ---- parameters ----

const registry = [{ name: "chance", kind: "PARAMETER_KIND_REAL", default_value: { real: 0.1 } }, { name: "size", kind: "PARAMETER_KIND_COUNT", default_value: { count: 50 } },
                  { name: "selection", kind: "PARAMETER_KIND_CHOICE", default_value: { choice: "roulette" } }];
const set = { parameters: [{ name: "chance", value: { real: 0.3 } }, { name: "size", value: { count: 50 }, pending: { count: 7 } }, { name: "selection", value: { choice: "roulette" } }] };

test("a lesson begins with defaults", () => {
  const all = page.changed(page.set_parameters(registry, set, { selection: "tournament" }, true));
  assert.deepEqual(page.assignments(all), [{ name: "chance", value: { real: 0.1 } }, { name: "size", value: { count: 50 } }, { name: "selection", value: { choice: "tournament" } }]);
});

test("a step changes only what it names", () => {
  const some = page.set_parameters(registry, set, { size: 7, chance: 0 });
  assert.deepEqual(some.map(({ before, after }) => [before, after]), [[{ real: 0.3 }, { real: 0 }], [{ count: 7 }, { count: 7 }]]);
  assert.deepEqual(page.assignments(page.changed(some)), [{ name: "chance", value: { real: 0 } }]);
});

// ---- links ----

test("a link names the lesson", () => {
  assert.equal(page.lesson_in("#world=default&lesson=drift"), "drift");
  assert.equal(page.lesson_in("#world=default"), "");
  assert.equal(page.with_lesson("http://lab/#world=a", "drift"), "http://lab/#world=a&lesson=drift");
  assert.equal(page.with_lesson("http://lab/", "drift"), "http://lab/#lesson=drift");
  assert.equal(page.with_lesson("", "drift"), "");
});

// ---- playing ----

/** A server that answers at once, and writes down what it is asked. */
class FakeServer {
  asked = [];
  state = { phase: "open" };
  world = { name: "w", run_id: "run 1", generation: 1, tick: 0, state: "RUN_STATE_WAITING", speed: { real_time_factor: 1 } };
  parameters = registry;
  exported = "";
  refuses = "";
  worlds = { find: () => this.world };
  access = { why_not: () => this.why };
  why = "";
  runs = 1;

  async request(kind, fields) {
    this.asked.push([kind, fields]);
    if (kind === this.refuses) {
      throw new Error(`${kind} is refused`);
    }
    switch (kind) {
      case "export_run": return { text: new TextEncoder().encode(this.exported), last: true };
      case "get_parameters": return set;
      case "reset_world": return this.world = { ...this.world, run_id: `run ${++this.runs}`, generation: 1 };
      case "run": return { ...this.world, run_until_generation: this.world.generation + fields.generations };
      case "observe": return { observations: fields.expressions.map((_, i) => ({ value: i + 1 })) };
      default: return {};
    }
  }

  kinds() {
    return this.asked.map(([kind]) => kind);
  }
}

const played = { experiment: {}, seed: 7, steps: [
  { title: "", text: "", predict: { id: "n", kind: "number" }, do: { set: { chance: 0 }, reset: true, run: 3 }, observe: { seen: "x" }, check: { near: "seen", within: 1 } },
  { title: "", text: "", predict: { id: "s", kind: "sentence" } }] };
globalThis.window = { sessionStorage: { stored: new Map(), getItem(key) { return this.stored.get(key) ?? null; }, setItem(key, value) { this.stored.set(key, value); }, removeItem(key) { this.stored.delete(key); } } };

async function until(condition) {
  for (let i = 0; i < 500 && !condition(); ++i) {
    await new Promise((resolve) => setTimeout(resolve, 10));
  }
  assert.ok(condition());
}

async function begun(server) {
  window.sessionStorage.stored.clear();
  const player = new page.LessonPlayer(server, "w", "drift", played, () => undefined);
  await until(() => player.state === "not begun");
  await player.begin();
  return player;
}

test("a step sets, resets, writes the notes again, runs, observes", async () => {
  const server = new FakeServer(), player = await begun(server);
  assert.deepEqual(server.kinds(), ["export_run", "get_parameters", "set_parameters", "reset_world"]);
  await player.predict(2);
  server.asked = [];
  await player.perform(true);
  assert.deepEqual(server.kinds(), ["get_parameters", "set_parameters", "reset_world", "add_note", "set_speed", "run"]);
  assert.equal(player.running.until, 4);
  server.world = { ...server.world, generation: 4 };
  await until(() => player.running === null && !player.is_busy);
  const texts = server.asked.filter(([kind]) => kind === "add_note").map(([, { kind, text }]) => [kind, JSON.parse(text)]);
  assert.deepEqual(texts, [
    ["lesson_prediction", { lesson: "drift", step: 1, id: "n", value: 2 }], ["lesson_observation", { lesson: "drift", step: 1, id: "seen", value: 1 }],
    ["lesson_answer", { lesson: "drift", step: 1, id: "n", predicted: 2, observed: 1, passed: true, apart: 1 }]]);
  assert.deepEqual(server.asked.at(-1), ["set_speed", { world: "w", speed: { real_time_factor: 1 } }]);
  assert.equal(player.course.open, 1);
});

test("after a reload the lesson goes on from the notes", async () => {
  const server = new FakeServer();
  window.sessionStorage.stored.clear();
  server.exported = `${JSON.stringify({ kind: "lesson_prediction", text: page.note_text(prediction("n", 5)) })}\n`;
  const player = new page.LessonPlayer(server, "w", "drift", played, () => undefined);
  await until(() => player.state === "begun");
  assert.equal(player.course.predictions.get("n"), 5);
  assert.equal(player.has_unwritten, false);
});

test("a run goes on after a reload", async () => {
  const server = new FakeServer(), player = await begun(server);
  await player.predict(2);
  await player.perform(false);
  player.close();
  const again = new page.LessonPlayer(server, "w", "drift", played, () => undefined);
  server.world = { ...server.world, generation: 2, state: "RUN_STATE_RUNNING", run_until_generation: 4 };
  await until(() => again.running !== null);
  assert.equal(again.progress, 1 / 3);
  server.world = { ...server.world, generation: 4 };
  await until(() => again.course.phase(0) === "done");
  again.close();
});

test("a note that is refused is written later", async () => {
  const server = new FakeServer(), player = await begun(server);
  server.refuses = "add_note";
  await player.predict(2);
  assert.equal(player.problem, "add_note is refused");
  assert.equal(player.has_unwritten, true);
  server.refuses = "";
  player.retry();
  await until(() => !player.has_unwritten);
  assert.equal(server.kinds().filter((kind) => kind === "add_note").length, 2);
});

test("a lesson that begins again forgets the predictions", async () => {
  const server = new FakeServer(), player = await begun(server);
  await player.predict(2);
  await player.begin();
  assert.equal(player.course.predictions.size, 0);
  assert.equal(player.state, "begun");
});
