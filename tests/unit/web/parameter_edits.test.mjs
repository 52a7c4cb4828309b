// The rules of the panel Parameters: groups, search, sliders, edits, transactions, conflicts, undo and planned changes.
import assert from "node:assert/strict";
import { test } from "node:test";
import { bundle } from "./bundle.mjs";

const rules = await bundle("world/parameter_edits", "world/parameter_values", "world/parameters", "world/slider_scale");

const chance = { name: "mutation_chance", kind: "PARAMETER_KIND_REAL", unit: "chance", max: 1, default_value: { real: 0.15 }, help: "How often a gene mutates." };
const count = { name: "food_count", kind: "PARAMETER_KIND_COUNT", unit: "items", max: 20_000_000, default_value: { count: 25 } };
const method = { name: "selection", kind: "PARAMETER_KIND_CHOICE", choices: ["roulette", "stochastic_universal"], choice_help: ["A wheel.", "One spin."], default_value: { choice: "roulette" } };
const flag = { name: "respawn", kind: "PARAMETER_KIND_FLAG", default_value: { flag: true } };
const registry = [chance, count, method, flag];

function state(name, value, pending) {
  return { name, value, ...(pending ? { pending } : {}) };
}

function made() {
  const edits = new rules.ParameterEdits();
  edits.describe(registry);
  edits.update_all({ revision: 5, parameters: registry.map((about) => state(about.name, about.default_value)) });
  return edits;
}

function accepted(edits, revision, ...states) {
  return edits.answered({ set: { revision, parameters: states } });
}

test("groups are the topics of the server", () => {
  const groups = rules.grouped([{ name: "fitness", topic: "Experiment" }, { name: "fitness_per_food", topic: "Experiment" }, { name: "food_count", topic: "Food and poison" }]);
  assert.deepEqual(groups, [{ title: "Experiment", members: [0, 1] }, { title: "Food and poison", members: [2] }]);
  assert.deepEqual(rules.most_used([{ name: "a" }, { name: "b", is_most_used: true }]).members, [1]);
});

test("the search finds words anywhere", () => {
  assert.ok(rules.matches(chance, "Mutation", "mutation_chance"));
  assert.ok(rules.matches(chance, "Mutation", "GENE often"));
  assert.ok(rules.matches(method, "Selection", "spin"));
  assert.ok(!rules.matches(chance, "Mutation", "gene food"));
});

test("labels leave out the unit", () => {
  assert.equal(rules.label_of({ name: "tick_s", unit: "s" }), "Tick");
  assert.equal(rules.label_of(chance), "Mutation chance");
  assert.equal(rules.unit_text(count, 1), "item");
});

test("typed numbers may have a comma", () => {
  assert.equal(rules.typed_number(chance, "0,15"), 0.15);
  assert.equal(rules.typed_number(chance, "1e-3"), 0.001);
  assert.equal(rules.typed_number(count, "1,250"), 1250);
  assert.equal(rules.typed_number(count, "1250"), 1250);
  for (const wrong of ["", "x", "1,2,3", "1.5", "-1", "5000000000"]) {
    assert.equal(rules.typed_number(count, wrong), null, wrong);
  }
  assert.equal(rules.typed_number(chance, "0.1 0.2"), null);
});

// ---- sliders ----

const wide = { name: "w", kind: "PARAMETER_KIND_REAL", min: 0.001, max: 86400 };
const signed = { name: "s", kind: "PARAMETER_KIND_REAL", min: -1000, max: 1000 };

test("only wide ranges are logarithmic", () => {
  assert.ok(rules.spans_decades(wide) && rules.spans_decades(count) && rules.spans_decades(signed));
  assert.ok(!rules.spans_decades(chance));
});

test("the ends of a slider are the bounds", () => {
  for (const about of [chance, count, wide, signed]) {
    assert.equal(rules.number_at(about, 0), about.min ?? 0);
    assert.equal(rules.number_at(about, 1), about.max);
    assert.equal(rules.share_of(about, about.min ?? 0), 0);
    assert.ok(Math.abs(rules.share_of(about, about.max) - 1) < 1e-12);
    assert.equal(rules.share_of(about, 1e300), rules.share_of(about, about.max));
  }
});

test("place and number of a slider are inverse and rise", () => {
  for (const about of [chance, count, wide, signed]) {
    let last = -Infinity;
    for (let share = 0; share <= 1; share += 1 / 64) {
      const number = rules.number_at(about, share);
      assert.ok(number >= last, `${about.name} at ${share}`);
      last = number;
      if (number !== 0 && Math.abs(number) > 10 * (about.max / 1e6)) {
        assert.ok(Math.abs(rules.share_of(about, number) - share) < 0.02, `${about.name} at ${share}: ${number}`);
      }
    }
  }
  assert.equal(rules.number_at(chance, 0.5), 0.5);
  assert.equal(rules.number_at(signed, 0.5), 0);
});

test("numbers of a slider are round, and whole for counts", () => {
  assert.equal(rules.number_at(chance, 0.1234567), 0.125);
  assert.ok(Number.isInteger(rules.number_at(count, 0.2)));
  assert.equal(String(rules.number_at(wide, 0.7)).replace(/[.0]/g, "").length, 2);
});

test("a step always moves, and stops at the bounds", () => {
  assert.equal(rules.stepped(count, 25, true, false), 26);
  assert.equal(rules.stepped(chance, 0.15, false, false), 0.14);
  assert.equal(rules.stepped(chance, 1, true, false), 1);
  assert.equal(rules.stepped(count, 0, false, true), 0);
  assert.ok(rules.stepped(wide, 40, true, true) > 40);
});

// ---- edits ----

test("an edit back to the value is none", () => {
  const edits = made();
  edits.edit(0, { real: 0.3 });
  assert.deepEqual([edits.edit_count, edits.parameters[0].edit !== null, edits.parameters[0].is_default], [1, true, false]);
  edits.edit(0, { real: 0.15 });
  assert.equal(edits.edit_count, 0);
});

test("all edits are one request with the revision", () => {
  const edits = made();
  edits.edit(0, { real: 0.3 });
  edits.edit(2, { choice: "stochastic_universal" });
  assert.deepEqual(edits.apply("w"), {
    world: "w", expected_revision: 5,
    parameters: [{ name: "mutation_chance", value: { real: 0.3 } }, { name: "selection", value: { choice: "stochastic_universal" } }],
  });
  assert.ok(edits.busy);
  assert.equal(edits.apply("w"), null);
});

test("an accepted edit becomes the value", () => {
  const edits = made();
  edits.edit(0, { real: 0.3 });
  edits.apply("w");
  assert.equal(accepted(edits, 6, state("mutation_chance", { real: 0.3 })), false);
  assert.deepEqual([edits.edit_count, edits.revision, edits.parameters[0].value], [0, 6, { real: 0.3 }]);
});

test("a value edited while it was sent stays edited", () => {
  const edits = made();
  edits.edit(0, { real: 0.3 });
  edits.apply("w");
  edits.edit(0, { real: 0.4 });
  accepted(edits, 6, state("mutation_chance", { real: 0.3 }));
  assert.deepEqual([edits.edit_count, edits.parameters[0].shown], [1, { real: 0.4 }]);
});

test("a refusal marks its parameters and keeps the edits", () => {
  const edits = made();
  edits.edit(0, { real: 3 });
  edits.apply("w");
  const violation = { field: "set_parameters.mutation_chance", allowed: "0 to 1", got: "3" };
  assert.equal(edits.answered({ refusal: { message: "no", violations: [violation] } }), true);
  assert.equal(edits.problem, "Nothing was changed: see the marked parameters");
  assert.deepEqual([edits.parameters[0].violation, edits.edit_count, edits.busy], [violation, 1, false]);
  edits.edit(0, { real: 0.5 });
  assert.deepEqual([edits.parameters[0].violation, edits.problem], [null, ""]);
});

test("a conflict asks to check the values", () => {
  const edits = made();
  edits.edit(0, { real: 0.3 });
  edits.apply("w");
  assert.equal(edits.answered({ refusal: { message: "no", violations: [{ field: "set_parameters.expected_revision", allowed: "6", got: "5" }] } }), true);
  assert.match(edits.problem, /^Another client changed parameters at the same time/);
  edits.update_all({ revision: 6, parameters: [state("food_count", { count: 9 })] });
  assert.equal(edits.apply("w").expected_revision, 6);
});

test("without an answer the change may have happened", () => {
  const edits = made();
  edits.edit(0, { real: 0.3 });
  edits.apply("w");
  assert.equal(edits.answered({ lost: true }), true);
  assert.match(edits.problem, /^No answer arrived/);
});

test("changes of others are named", () => {
  const edits = made();
  const by = { kind: "ACTOR_KIND_CLIENT", user: "anna", client: "evoview" };
  edits.update_changed({ revision: 6, by, changed: [state("food_count", { count: 25 }, { count: 60 })] });
  assert.deepEqual([edits.parameters[1].client_of_last_change, edits.parameters[1].pending !== null, edits.parameters[1].requested], ["anna: evoview", true, { count: 60 }]);
  edits.update_changed({ revision: 6, by: {}, changed: [state("food_count", { count: 70 })] }); // known already
  assert.deepEqual(edits.parameters[1].requested, { count: 60 });
});

test("an edit that another client makes too is done", () => {
  const edits = made();
  edits.edit(1, { count: 60 });
  edits.update_changed({ revision: 6, by: {}, changed: [state("food_count", { count: 60 })] });
  assert.equal(edits.edit_count, 0);
});

test("an older set is ignored", () => {
  const edits = made();
  edits.update_all({ revision: 4, parameters: [state("food_count", { count: 1 })] });
  assert.deepEqual([edits.parameters[1].value, edits.revision], [{ count: 25 }, 5]);
});

// ---- undo ----

/** Returns the changes that were sent. */
function changed_to(edits, value, revision) {
  edits.edit(0, { real: value });
  edits.apply("w");
  const { sent } = edits;
  accepted(edits, revision, state("mutation_chance", { real: value }));
  return sent;
}

test("undo and redo send the values again", () => {
  const edits = made(), changes = changed_to(edits, 0.3, 6);
  assert.deepEqual(edits.reverse("w", changes).parameters, [{ name: "mutation_chance", value: { real: 0.15 } }]);
  const { sent } = edits;
  assert.equal(edits.reverse("w", changes), null); // a transaction is pending
  accepted(edits, 7, state("mutation_chance", { real: 0.15 }));
  assert.deepEqual(edits.reverse("w", sent).parameters, [{ name: "mutation_chance", value: { real: 0.3 } }]);
});

test("undo leaves values of others", () => {
  const edits = made(), changes = changed_to(edits, 0.3, 6);
  edits.update_changed({ revision: 7, by: {}, changed: [state("mutation_chance", { real: 0.9 })] });
  assert.equal(edits.reverse("w", changes), null);
  assert.equal(edits.busy, false);
});

test("a refused undo can be tried again", () => {
  const edits = made(), changes = changed_to(edits, 0.3, 6);
  edits.reverse("w", changes);
  edits.answered({ lost: true });
  assert.deepEqual(edits.reverse("w", changes).parameters, [{ name: "mutation_chance", value: { real: 0.15 } }]);
});

// ---- plans and dry runs ----

test("a planned change ends its edits", () => {
  const edits = made();
  edits.edit(0, { real: 0.3 });
  assert.equal(edits.apply("w", { generation: 30 }).at_generation, 30);
  assert.equal(edits.answered({ set: null }), true);
  assert.equal(edits.edit_count, 0);
  edits.update_all({ revision: 5, parameters: [], planned: [{ id: 1, generation: 30, parameters: [{ name: "mutation_chance", value: { real: 0.3 } }] }],
                     schedule: [{ name: "mutation_chance", generation: 50, value: { real: 0.01 } }] });
  assert.deepEqual(rules.planned_values(edits, "mutation_chance"), ["0.01 in generation 50", "0.3 in generation 30"]);
  assert.equal(rules.when_text({ tick: 1200 }), "after tick 1,200");
});

test("a dry run marks values and changes nothing", () => {
  const edits = made();
  assert.equal(edits.check("w", null), null);
  edits.edit(0, { real: 3 });
  const { fields, number } = edits.check("w", { tick: 9 });
  assert.deepEqual([fields.dry_run, fields.at_tick, edits.busy], [true, 9, false]);
  const refusal = { message: "no", violations: [{ field: "set_parameters.mutation_chance", allowed: "0 to 1", got: "3" }] };
  edits.checked(number, { refusal });
  assert.equal(edits.parameters[0].violation.allowed, "0 to 1");
  assert.equal(edits.problem, "");
});

test("warnings of a dry run stay until the next edit", () => {
  const edits = made();
  edits.edit(0, { real: 0 });
  edits.checked(edits.check("w", null).number, { warnings: ["nothing can evolve"] });
  assert.deepEqual(edits.warnings, ["nothing can evolve"]);
  edits.edit(0, { real: 0.5 });
  assert.deepEqual(edits.warnings, []);
});

test("a dry run of earlier edits is ignored", () => {
  const edits = made();
  edits.edit(0, { real: 3 });
  const { number } = edits.check("w", null);
  edits.edit(0, { real: 0.5 });
  edits.checked(number, { refusal: { message: "no", violations: [{ field: "set_parameters.mutation_chance", allowed: "0 to 1", got: "3" }] } });
  assert.equal(edits.parameters[0].violation, null);
});
