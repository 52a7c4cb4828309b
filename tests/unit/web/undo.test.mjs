// Undo and redo of changes and of what was placed.
import assert from "node:assert/strict";
import { test } from "node:test";
import { bundle } from "./bundle.mjs";

const { UndoHistory, Placing, place, Refusal } = await bundle("world/undo", "world/placing", "world/server");

/** A step that writes what it does into `log`. */
function step(name, log, members = {}) {
  const act = (verb) => async () => log.push(`${verb} ${name}`) > 0;
  return { name, can_undo: () => true, can_redo: () => true, undo: act("undo"), redo: act("redo"), ...members };
}

test("steps are undone from the last to the first, and redone in their order", async () => {
  const log = [], history = new UndoHistory(() => undefined);
  assert.equal(await history.undo(), "There is nothing to undo.");
  history.add(step("a", log));
  history.add(step("b", log));
  assert.deepEqual([history.next_undo, history.next_redo], ["b", ""]);
  assert.equal(await history.undo(), "Undone: b.");
  await history.undo();
  assert.deepEqual([history.next_undo, history.next_redo], ["", "a"]);
  assert.equal(await history.redo(), "Done again: a.");
  history.add(step("c", log)); // b cannot be redone any more
  assert.equal(await history.redo(), "There is nothing to redo.");
  assert.deepEqual(log, ["undo b", "undo a", "redo a"]);
});

test("a step that fails stays, and one that has lost its meaning goes", async () => {
  const log = [], history = new UndoHistory(() => undefined);
  history.add(step("a", log));
  history.add(step("b", log, { can_undo: () => log.length === 0 }));
  history.add(step("c", log, { undo: () => Promise.reject(new Error("no answer")) }));
  await assert.rejects(history.undo(), /no answer/);
  assert.equal(history.next_undo, "c");
  history.add(step("d", log, { undo: async () => log.push("nothing left") < 0 }));
  assert.equal(await history.undo(), "“d” was not undone, because nothing of it is left.");
  history.add(step("e", log));
  await history.undo();
  assert.deepEqual([history.next_undo, history.next_redo], ["c", "e"]);
  assert.deepEqual(log, ["nothing left", "undo e"]);
});

test("only one step is undone at a time", async () => {
  const history = new UndoHistory(() => undefined);
  let end;
  history.add(step("a", []));
  history.add(step("b", [], { undo: () => new Promise((resolve) => { end = resolve; }) }));
  const first = history.undo();
  assert.equal(await history.undo(), "The last change is still being undone or redone.");
  end(true);
  assert.equal(await first, "Undone: b.");
});

test("undo removes what is left of what was placed, and redo places it again", async () => {
  const sent = [];
  let ids = [7, 8], eaten = false;
  const answers = {
    place: () => ({ generation: 3, food: ids, organisms: [50] }),
    remove: ({ food }) => {
      if (food?.[0] === 7 || eaten) {
        throw new Refusal("food[0]: got 7, allowed ids of present food", "CODE_INVALID_ARGUMENT", "REASON_FIELD_INVALID", []);
      }
    },
  };
  const server = { request: async (kind, fields) => (sent.push([kind, fields]), answers[kind](fields) ?? {}) };
  const world = { server, shown: "a", island: 1, info: { run_id: "r" }, snapshot: { generation: 3 },
                  undo: new UndoHistory(() => undefined) };
  await place(world, { items: [{ kind: "ITEM_KIND_FOOD" }] });
  assert.equal(world.undo.next_undo, "placed 2 food, 1 organism");
  await world.undo.undo();
  assert.deepEqual(sent.slice(1).map(([kind, { world: name, island, generation, ...rest }]) => [kind, name, island, generation, rest]),
                   [["remove", "a", 1, 3, { food: [7] }], ["remove", "a", 1, 3, { food: [8] }], ["remove", "a", 1, 3, { organisms: [50] }]]);
  ids = [9];
  await world.undo.redo();
  sent.length = 0;
  await world.undo.undo();
  assert.deepEqual(sent.map(([, { food, organisms }]) => food ?? organisms), [[9], [50]]);
  await world.undo.redo();
  eaten = true;
  answers.remove = answers.remove.bind(null, {});
  assert.equal(await world.undo.undo(), "“placed 2 food, 1 organism” was not undone, because nothing of it is left.");
  await place(world, {});
  world.snapshot.generation = 4; // all that was placed has ended
  assert.equal(world.undo.next_undo, "");
});

test("several requests are one change, and redo places what has room", async () => {
  const sent = [];
  let next = 50, full = false;
  const answers = {
    place: () => {
      if (full && next > 51) {
        throw new Refusal("occupied", "CODE_INVALID_ARGUMENT", "REASON_FIELD_INVALID", []);
      }
      return { generation: 3, organisms: [next++] };
    },
    remove: () => ({}),
  };
  const server = { request: async (kind, fields) => (sent.push(kind), answers[kind](fields)) };
  const world = { server, shown: "a", island: 0, info: { run_id: "r" }, snapshot: { generation: 3 },
                  undo: new UndoHistory(() => undefined) };
  const placing = new Placing(world);
  placing.end(); // nothing was placed
  assert.equal(world.undo.next_undo, "");
  for (let i = 0; i < 3; ++i) {
    await placing.place({ organisms: [{ genes: [i] }] });
  }
  placing.end();
  assert.equal(await world.undo.undo(), "Undone: placed 3 organisms.");
  assert.equal(world.undo.next_undo, "");
  assert.deepEqual(sent.slice(3), ["remove", "remove", "remove"]);
  next = 50;
  full = true;
  await world.undo.redo();
  sent.length = 0;
  await world.undo.undo();
  assert.deepEqual(sent, ["remove", "remove"]);
  await assert.rejects(world.undo.redo(), /occupied/);
  assert.equal(world.undo.next_redo, "placed 3 organisms");
});
