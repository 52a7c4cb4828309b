// Links to moments, in the form of tests/unit/core/page_link_test.cpp and tests/python/page_link_test.py, and the time line's scale.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { bundle } from "./bundle.mjs";

const page = await bundle("world/link", "world/time_scale");
const none = { world: null, generation: null, tick: null, island: null, organism: null, rate: null };

/** The texts that page_link_test.cpp expects, with the moments that it makes them of. */
const texts_of_cpp = readFileSync(new URL("../core/page_link_test.cpp", import.meta.url), "utf8");
const cases = [
  [{ world: "default" }, "#world=default"],
  [{ world: "a", generation: 12, tick: 600, island: 1, organism: 7 }, "#world=a&generation=12&tick=600&island=1&organism=7"],
  [{ world: "a", generation: 12 }, "#world=a&generation=12&tick=0"],
  [{ world: "a", organism: 0 }, "#world=a&island=0&organism=0"],
  [{ world: "default", generation: 3, tick: 40 }, "#world=default&generation=3&tick=40"],
];

test("links have the form of the other programs", () => {
  for (const [moment, text] of cases) {
    assert.ok(texts_of_cpp.includes(`"${text}"`), text);
    assert.equal(page.link_of("http://lab:7745/", { ...none, ...moment }), `http://lab:7745/${text}`);
  }
  assert.equal(page.link_of("", { ...none, world: "a", rate: 10 }), "#world=a&rate=10");
});

test("written links are read again", () => {
  for (const [moment, text] of cases) {
    const read = page.read_link(text);
    assert.deepEqual(read.wrong, []);
    const tick = moment.generation === undefined ? null : moment.tick ?? 0, island = moment.island ?? (moment.organism === undefined ? null : 0);
    assert.deepEqual(read.moment, { ...none, ...moment, tick, island });
  }
});

test("an address without fields is not a link", () => {
  for (const hash of ["", "#", "#worlds", "#token=evod_00"]) {
    assert.equal(page.read_link(hash), null);
  }
});

test("a link never contains a token", () => {
  const { moment } = page.read_link("#world=a&token=evod_00");
  assert.equal(page.link_of("", moment), "#world=a");
});

test("values that are not numbers are named", () => {
  assert.deepEqual(page.read_link("#world=a&generation=twelve&tick=1.5").wrong,
                   ['generation: got "twelve", allowed whole numbers', 'tick: got "1.5", allowed whole numbers']);
  assert.deepEqual(page.read_link("#world=a&tick=600").wrong, ["tick: got 600 without a generation, allowed only with a generation"]);
  assert.deepEqual(page.read_link("#world=a&generation=").wrong, ['generation: got "", allowed whole numbers']);
});

test("a tick beyond its generation becomes the last one", () => {
  const read = page.read_link("#world=default&generation=12&tick=9e9");
  assert.deepEqual(page.nearest(read, { generation: 12, tick: 9e9 }, "open_replay.at.tick", "0 to 2400 in generation 12"), { generation: 12, tick: 2400 });
  assert.deepEqual(read.wrong, ["tick: got 9e9, generation 12 has 0 to 2,400"]);
});

test("a generation beyond the run becomes its last moment", () => {
  const read = page.read_link("#world=default&generation=99&tick=5");
  assert.deepEqual(page.nearest(read, { generation: 99, tick: 5 }, "seek.to.generation", "3 to 13"), {});
  assert.deepEqual(page.nearest(read, { generation: 1 }, "at.generation", "3 to 13"), { generation: 3 });
  assert.deepEqual(page.read_link("#world=a&generation=-1").moment.generation, 0);
  assert.deepEqual(read.wrong, ["generation: got 99, the run has 3 to 13", "generation: got 99, the run has 3 to 13"]);
});

test("other refusals have no nearest moment", () => {
  const read = page.read_link("#world=a&generation=2");
  assert.equal(page.nearest(read, { generation: 2 }, "open_replay.world", "the name of a world"), null);
  assert.equal(page.nearest(read, { generation: 2 }, "open_replay.at.tick", "0 to 3"), null);
});

test("islands and organisms beyond the world are named", () => {
  const read = page.read_link("#world=a&island=7&organism=-2&rate=10");
  assert.equal(page.within(read, "island", "the world a", 0, 3), 3);
  assert.equal(page.within(read, "organism", "generation 2", 0, 49), 0);
  assert.equal(page.within(read, "rate", "this server", 1, 60), 10);
  assert.deepEqual(read.wrong, ["island: got 7, the world a has 0 to 3", "organism: got -2, generation 2 has 0 to 49"]);
  const one = page.read_link("#world=a&island=1");
  assert.equal(page.within(one, "island", "the world a", 0, 0), 0);
  assert.deepEqual(one.wrong, ["island: got 1, the world a has only 0"]);
});

// ---- the scale of the time line ----

const range = { first_generation: 1, last_generation: 4, first_tick: 0, last_tick: 3100 };
const ticks_of = (generation) => [null, { first: 0, last: 1000 }, { first: 1000, last: 1500 }, { first: 1500, last: 3000 }, { first: 3000, last: 3100 }][generation];

test("generations have equal widths", () => {
  const scale = new page.TimeScale(range, ticks_of);
  assert.deepEqual([1, 2, 3, 4].map((generation) => scale.part_of(generation)), [0, 0.25, 0.5, 0.75]);
  assert.equal(scale.part_of(2, 1250), 0.375);
  assert.equal(scale.part_of(4, 3100), 1);
  assert.equal(scale.part_of(9), 1);
});

test("a position is a moment of a generation", () => {
  const scale = new page.TimeScale(range, ticks_of);
  assert.deepEqual(scale.moment_at(0.375, 400), { generation: 2, tick: 1250 });
  assert.deepEqual(scale.moment_at(1, 400), { generation: 4, tick: 3100 });
  assert.deepEqual(scale.moment_at(-1, 400), { generation: 1, tick: 0 });
  assert.deepEqual(scale.moment_at(0.375, 20), { generation: 2 }, "narrow generations begin at their first moment");
  assert.deepEqual(scale.moment_at(1, 20), { generation: 4, tick: 3100 });
  assert.deepEqual(new page.TimeScale(range, () => null).moment_at(0.6, 400), { generation: 3 });
});

test("labels are round generations", () => {
  assert.deepEqual(page.marked_generations(1, 4, 10), [1, 2, 3, 4]);
  assert.deepEqual(page.marked_generations(1, 742, 8), [100, 200, 300, 400, 500, 600, 700]);
  assert.deepEqual(page.marked_generations(30, 33, 2), [30, 32]);
  assert.deepEqual(page.marked_generations(1, 4, 0), []);
});

test("marks in the same place are joined", () => {
  const mark = (part, text, kind = "change") => ({ part, kind, label: text, text });
  const [a, b, c, d] = [mark(0.101, "a"), mark(0.102, "b"), mark(0.9, "c"), mark(0.103, "d", "placed")];
  assert.deepEqual(page.joined_marks([a, b, c, d], 10), [
    { part: 0.101, texts: ["a", "b"], first: a }, { part: 0.9, texts: ["c"], first: c }, { part: 0.103, texts: ["d"], first: d }]);
});

// ---- the zoom of the time line ----

const long = { first_generation: 1, last_generation: 500, first_tick: 0, last_tick: 5000 };

test("a zoomed line keeps the place of the pointer", () => {
  const zoom = new page.TimeZoom();
  assert.deepEqual(zoom.shown(long), { from: 1, to: 501 });
  assert.equal(zoom.is_on, false);
  zoom.zoom(long, 0.5, 10);
  assert.deepEqual(zoom.shown(long), { from: 226, to: 276 });
  zoom.zoom(long, 0, 2);
  assert.deepEqual(zoom.shown(long), { from: 226, to: 251 });
  zoom.zoom(long, 0.5, 1e9);
  const { from, to } = zoom.shown(long);
  assert.equal(to - from, 2, "two generations at least");
  zoom.zoom(long, 0.5, 1e-9);
  assert.equal(zoom.is_on, false);
});

test("a zoomed line moves within the run", () => {
  const zoom = new page.TimeZoom();
  zoom.pan(long, 1);
  assert.equal(zoom.is_on, false, "a line that shows all cannot move");
  zoom.zoom(long, 0, 10);
  zoom.pan(long, 0.5);
  assert.deepEqual(zoom.shown(long), { from: 26, to: 76 });
  zoom.pan(long, -9);
  assert.deepEqual(zoom.shown(long), { from: 1, to: 51 });
  zoom.include(long, 60);
  assert.deepEqual(zoom.shown(long), { from: 11, to: 61 });
  zoom.include(long, 5);
  assert.deepEqual(zoom.shown(long), { from: 5, to: 55 });
  zoom.include(long, 30);
  assert.deepEqual(zoom.shown(long), { from: 5, to: 55 });
});

test("a line that ends at the present follows it", () => {
  const zoom = new page.TimeZoom(), later = { ...long, last_generation: 520 };
  zoom.zoom(long, 1, 10);
  assert.deepEqual(zoom.shown(long), { from: 451, to: 501 });
  assert.deepEqual(zoom.shown(later), { from: 471, to: 521 });
  zoom.pan(later, -0.2);
  assert.deepEqual(zoom.shown({ ...long, last_generation: 600 }), { from: 461, to: 511 });
  assert.deepEqual(zoom.shown({ ...long, last_generation: 3 }), { from: 1, to: 4 }, "another run is shown as a whole");
});

test("positions on a zoomed line may be outside it", () => {
  const scale = new page.TimeScale(range, ticks_of, { from: 2, to: 4 });
  assert.deepEqual([1, 2, 3, 4].map((generation) => scale.part_of(generation)), [-0.5, 0, 0.5, 1]);
  assert.deepEqual(scale.moment_at(0.75, 400), { generation: 3, tick: 2250 });
});
