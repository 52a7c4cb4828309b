// Numbers and sentences of the page: the same as those of evoview (tests/unit/viewer/text, tests/unit/viewer/world).
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { bundle } from "./bundle.mjs";

const page = await bundle("texts/numbers", "texts/refusals", "texts/snapshot", "texts/states", "texts/users", "world/event_text");

test("numbers have separators and six digits", () => {
  for (const [number, text] of [[0, "0"], [1234.5, "1,234.5"], [0.0123, "0.0123"], [-7, "−7"], [1e6, "1,000,000"], [-1e-9, "−1e-09"], [NaN, "–"]]) {
    assert.equal(page.shown_number(number), text);
  }
  assert.equal(page.with_separators(1234567), "1,234,567");
  assert.equal(page.with_separators((1n << 64n) - 1n), "18,446,744,073,709,551,615");
});

test("three digits are enough for a glance", () => {
  for (const [number, text] of [[1.20817, "1.21"], [348.59, "349"], [999.7, "1,000"], [12345.6, "12,346"], [-0.01234, "−0.0123"], [Infinity, "–"]]) {
    assert.equal(page.three_digits(number), text);
  }
  for (const [number, text] of [[1234.5, "1,230"], [104286, "104,000"], [0.64032, "0.64"], [-343.082, "−343"], [9.996, "10"], [0, "0"], [-1.2345e-9, "−1.23e-09"]]) {
    assert.equal(page.significant(number), text);
  }
  assert.equal(page.with_sign(1.20817), "+1.21");
});

test("a fitness has the text of all programs", () => {
  for (const [fitness, text] of JSON.parse(readFileSync(new URL("../../../proto/vectors/fitness.json", import.meta.url)))) {
    assert.equal(page.plain_fitness(fitness), text);
  }
  assert.equal(page.fitness_text(-1234.56), "−1,234.6");
  assert.equal(page.fitness_text(NaN), "–");
});

test("a colony has the counts of both species", () => {
  const snapshot = { tick: 60, simulated_s: 1, live: { alive_count: 170, organism_count: 230, predator_count: 20, born_count: 30, health_mean: 90 } };
  assert.deepEqual(page.statistics_texts(snapshot, true).slice(0, 2), ["alive 170 of 230", "mean health 90.0"]);
  assert.deepEqual(page.statistics_texts(snapshot, true, true, true).slice(0, 3), ["prey 150", "predators 20", "born 30"]);
  assert.deepEqual(page.statistics_texts(snapshot, true, true).slice(0, 2), ["alive 170", "born 30"]);
});

test("durations have the format of all programs", () => {
  for (const [seconds, text] of [[0, "0.0 s"], [59.96, "60.0 s"], [245, "4:05 min"], [119.9999, "2:00 min"], [7200, "2:00:00 h"]]) {
    assert.equal(page.duration(seconds), text);
  }
});

test("a number of a field is checked against its range", () => {
  assert.equal(page.number_in("ticks", "60", 1, 1000), 60);
  for (const text of ["0", "1001", "-3", "", "6 0", "1.5"]) {
    assert.equal(page.number_in("ticks", text, 1, 1000), `ticks: got "${text}", allowed whole numbers from 1 to 1,000`);
  }
});

test("a refusal is on one line and names fields without their paths", () => {
  const refused = (message, ...fields) => page.refusal_text({ message, violations: fields.map((field) => ({ field })) });
  assert.equal(refused("no such island\n  subscribe_snapshots.island: got 9, allowed 0 to 7", "subscribe_snapshots.island"),
               "No such island: island: got 9, allowed 0 to 7");
  assert.equal(refused('fork_world.name: got "a b", allowed 1 to 64 letters', "fork_world.name"), 'Name: got "a b", allowed 1 to 64 letters');
  assert.equal(refused("2 fields are invalid\n  fork_world.name: got a b, allowed 1 to 64 letters\n  fork_world.seed: got x, allowed a number", "fork_world.name", "fork_world.seed"),
               "2 fields are invalid: name: got a b, allowed 1 to 64 letters; seed: got x, allowed a number");
});

test("speeds are multiples of real time", () => {
  for (const [factor, text] of JSON.parse(readFileSync(new URL("../../../proto/vectors/speeds.json", import.meta.url)))) { // as evoctl prints them
    assert.equal(page.speed_text({ real_time_factor: factor }), text);
  }
  assert.equal(page.speed_text({ max: true }), "max");
});

test("the island is named only if there are several", () => {
  const snapshot = { island: 0, island_count: 1, ticks_per_s: 119.7 }, speed = { real_time_factor: 2 };
  assert.equal(page.place_and_speed_text("default", snapshot, speed, true), "default · 2× (120 ticks/s)");
  assert.equal(page.place_and_speed_text("default", { ...snapshot, island: 2, island_count: 8 }, speed, true), "default · island 2 of 0–7 · 2× (120 ticks/s)");
  assert.equal(page.place_and_speed_text("default", snapshot, speed, false), "default · 2×");
});

test("a world may wait for the disk or for fitness", () => {
  const storage = { state: "STORAGE_STATE_STALLED", reason: "it is full", text: "worlds wait: it is full" };
  assert.equal(page.storage_text(storage), "Worlds wait: it is full");
  assert.equal(page.storage_text({ state: "STORAGE_STATE_KEEPS_UP" }), "");
  assert.equal(page.state_word("RUN_STATE_RUNNING", storage), "waits for the disk");
  assert.equal(page.state_word("RUN_STATE_RUNNING", null, true), "waits for fitness");
  assert.equal(page.state_word("RUN_STATE_PAUSED", storage, true), "paused");
});

test("an event has the sentence of the server", () => {
  const examples = JSON.parse(readFileSync(new URL("../../../proto/vectors/events.json", import.meta.url)));
  assert.ok(examples.length > 40);
  for (const { event, text } of examples) {
    assert.equal(page.event_text(event)[0], page.capitalised(text), JSON.stringify(event));
  }
});

test("whole numbers in events may be larger than a double can hold", () => {
  const dropped = { events_dropped: { dropped_count: (1n << 64n) - 1n } };
  assert.equal(page.event_text(dropped)[0], "18,446,744,073,709,551,615 events were dropped: the client read too slowly");
});

test("an event that the page does not know has the text of the server", () => {
  assert.deepEqual(page.event_text({ world: "a", text: "something new", something_new: {} }), ["something new", false]);
});

test("an event may be about the progress of the simulation", () => {
  assert.equal(page.event_text({ generation_finished: { statistics: [{ generation: 3 }] } })[1], true);
  assert.equal(page.event_text({ world_reset: { by: {} } })[1], false);
});
