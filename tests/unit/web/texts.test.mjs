// Numbers and sentences of the page: the same as those of evoview (tests/unit/viewer/text, tests/unit/viewer/world).
import assert from "node:assert/strict";
import { test } from "node:test";
import { bundle } from "./bundle.mjs";

const page = await bundle("texts/numbers", "texts/texts", "world/event_text");

function parameters(choices, numbers = {}) {
  const all = { population_size: 50, food_health: 25, poison_harm: 40, health_loss_per_s: 6, fitness_per_second: 1, fitness_per_health: 1, ...numbers };
  return { parameters: [...Object.entries(all).map(([name, real]) => ({ name, value: { real } })),
                        ...Object.entries(choices).map(([name, choice]) => ({ name, value: { choice } }))] };
}

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

test("a refusal is a sentence that names each fact once", () => {
  const refused = (message, ...violations) => page.refusal_text({ message, violations });
  assert.equal(refused("there is no such island", { field: "subscribe_snapshots.island", got: "9", allowed: "0 to 7" }),
               "There is no such island (9); allowed: 0 to 7");
  const name = { field: "fork_world.name", got: "a b", allowed: "1 to 64 letters" };
  assert.equal(refused('fork_world.name must be 1 to 64 letters, not "a b"', name), 'Name must be 1 to 64 letters, not "a b"');
  assert.equal(refused("the run has no such tick: allowed: 193 in generation 1", { field: "open_replay.at", got: "0", allowed: "193 in generation 1" }),
               "The run has no such tick: allowed: 193 in generation 1");
  assert.equal(refused("2 fields are not as they must be", name, { field: "fork_world.seed", allowed: "a number" }),
               "2 fields are not as they must be: name must be 1 to 64 letters, not a b; seed must be a number");
});

test("speeds are multiples of real time", () => {
  for (const [speed, text] of [[{ real_time_factor: 1 }, "1×"], [{ real_time_factor: 64 }, "64×"], [{ real_time_factor: 0.125 }, "1/8×"],
                               [{ real_time_factor: 0.3 }, "0.3×"], [{ max: true }, "max"]]) {
    assert.equal(page.speed_text(speed), text);
  }
});

test("the island is named only if there are several", () => {
  const snapshot = { island: 0, island_count: 1, ticks_per_s: 119.7 }, speed = { real_time_factor: 2 };
  assert.equal(page.place_and_speed_text("default", snapshot, speed, true), "default · 2× (120 ticks/s)");
  assert.equal(page.place_and_speed_text("default", { ...snapshot, island: 2, island_count: 8 }, speed, true), "default · island 2 of 0–7 · 2× (120 ticks/s)");
  assert.equal(page.place_and_speed_text("default", snapshot, speed, false), "default · 2×");
});

test("a world may wait for the disk or for fitness", () => {
  const storage = { state: "STORAGE_STATE_STALLED", reason: "it is full" };
  assert.equal(page.storage_text(storage), "Worlds wait for the disk, commands are refused: it is full");
  assert.equal(page.storage_text({ state: "STORAGE_STATE_KEEPS_UP" }), "");
  assert.equal(page.state_word("RUN_STATE_RUNNING", storage), "waits for the disk");
  assert.equal(page.state_word("RUN_STATE_RUNNING", null, true), "waits for fitness");
  assert.equal(page.state_word("RUN_STATE_PAUSED", storage, true), "paused");
});

test("the description says what the organisms try to do", () => {
  const life = { fitness: "life", selection: "roulette" };
  assert.equal(page.experiment_text(parameters(life)),
               "50 organisms seek food (+25 health) and avoid poison (−40). Each loses 6 health per second and dies at 0. Fitness is the time lived plus " +
               "the health at the end. On average, fitter organisms have more offspring (roulette selection).");
  assert.match(page.experiment_text(parameters({ ...life, controller: "network" })),
               /^50 organisms, each steered by an evolving neural network, eat food \(\+25 health\) and poison \(−40\); a line shows where each heads\. Each loses 6 health/);
  const mild = page.experiment_text(parameters(life, { poison_count: 0, health_loss_per_s: 0, fitness_per_food: -2.5 }));
  assert.ok(!mild.includes("poison (") && mild.includes("They lose no health over time.") && mild.includes("minus 2.5 × the food eaten"), mild);
});

test("an event names the client that caused it", () => {
  const by = { kind: "ACTOR_KIND_CLIENT", user: "anna", client: "evoview", address: "10.0.0.7:5" };
  assert.deepEqual(page.event_text({ world: "a", parameters_changed: { by, changed: [{ name: "food_count", value: { count: 30 } }, { name: "selection", value: { choice: "rank" }, pending: { choice: "random" } }] } }),
                   ["Anna: evoview 10.0.0.7:5 changed food_count to 30, selection to random", false]);
  assert.deepEqual(page.event_text({ world: "a", world_reset: { by: { kind: "ACTOR_KIND_SCHEDULE" } } }), ["The schedule reset the world", false]);
  assert.deepEqual(page.event_text({ world: "a", placed: { by: {}, food: [1, 2], organisms: [3] } }), ["A local client placed 2 food, 1 organism", false]);
  assert.equal(page.event_text({ generation_finished: { statistics: [{ generation: 3, simulated_s: 40, fitness_best: 12, fitness_mean: 3.5 }] } })[1], true);
});
