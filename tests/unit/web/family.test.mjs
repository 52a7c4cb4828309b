// The logic of the family tree: the lineage table and the positions of the ancestors.
import assert from "node:assert/strict";
import { test } from "node:test";
import { bundle } from "./bundle.mjs";

const family = await bundle("family");

function row(generation, organism, first, second, island = 0) {
  return {
    generation, island, organism, parent_first_generation: first === null ? null
      : generation - 1, parent_first_island: first === null ? null : island, parent_first: first,
    parent_second_generation: second === null ? null : generation - 1, parent_second_island: second === null ? null
      : island, parent_second: second,
    origin: first === null ? "initial" : first === second ? "survivor"
      : "child", fitness: 10 * generation, child_count: 2, kept_count: 1,
  };
}

function lineage(rows) {
  const reader = new family.LineageReader();
  reader.add(new TextEncoder().encode(rows.map((one) => JSON.stringify(one) + "\n").join("")), true);
  return reader.ancestors;
}

const rows = [row(3, 9, 4, 1), row(2, 4, 2, 2), row(2, 1, 2, 0), row(1, 2, null, null), row(1, 0, null, null)];

test("parts may end within a row", () => {
  const text = new TextEncoder().encode(rows.map((one) => JSON.stringify(one) + "\n").join(""));
  const reader = new family.LineageReader();
  for (let i = 0; i < text.length; i += 7) {
    reader.add(text.subarray(i, i + 7), false);
  }
  reader.add(undefined, true);
  assert.equal(reader.ancestors.size, 5);
  assert.deepEqual(reader.ancestors.get("3/0/9").parents.map((parent) => parent.organism), [4, 1]);
  assert.deepEqual(reader.ancestors.get("2/0/4").parents.map((parent) => parent.organism), [2]);
});

test("a damaged line is named", () => {
  const reader = new family.LineageReader();
  assert.throws(() => reader.add(new TextEncoder().encode("{\n"), true), /a line that is no JSON: \{/);
  assert.throws(() => reader.add(new TextEncoder().encode("{}\n"), true), /a row without an organism/);
});

test("the tree has one row per generation", () => {
  const tree = family.family_tree(lineage(rows), { generation: 3, island: 0, organism: 9 }, true, 10);
  assert.equal(tree.first_generation, 1);
  assert.deepEqual(tree.rows.map((row) => row.map((spot) => spot.ancestor.organism)), [[0, 2], [4, 1], [9]]);
  assert.deepEqual(tree.rows[1].map((spot) => [spot.first, spot.second]), [[1, -1], [1, 0]]);
  assert.deepEqual([tree.rows[2][0].first, tree.rows[2][0].second], [0, 1]);
});

test("lines of first parents leave second parents out", () => {
  const tree = family.family_tree(lineage(rows), { generation: 3, island: 0, organism: 9 }, false, 10);
  assert.deepEqual(tree.rows.map((row) => row.map((spot) => spot.ancestor.organism)), [[2], [4], [9]]);
});

test("the number of generations is bounded", () => {
  const tree = family.family_tree(lineage(rows), { generation: 3, island: 0, organism: 9 }, true, 2);
  assert.deepEqual([tree.first_generation, tree.rows.length], [2, 2]);
  assert.equal(family.family_tree(lineage(rows), { generation: 3, island: 1, organism: 9 }, true, 2), null);
});

test("organisms of a row keep their distance", () => {
  const wide = [row(2, 0, 0, 5), ...Array.from({ length: 6 }, (_, organism) => row(1, organism, null, null))];
  const tree = family.family_tree(lineage(wide), { generation: 2, island: 0, organism: 0 }, true, 10);
  for (const places of tree.rows) {
    places.forEach((spot, i) => {
      assert.ok(spot.x >= 0.5 && spot.x <= tree.width - 0.5);
      assert.ok(i === 0 || spot.x - places[i - 1].x >= 1 - 1e-9);
    });
  }
});

test("positions move as little as possible", () => {
  assert.deepEqual(family.spread([1, 1, 4], 5), [0.5, 1.5, 4]);
  assert.deepEqual(family.spread([0, 0], 2), [0.5, 1.5]);
});

test("arrow keys follow parents and children", () => {
  const tree = family.family_tree(lineage(rows), { generation: 3, island: 0, organism: 9 }, true, 10);
  assert.deepEqual(family.neighbour(tree, 2, 0, "ArrowUp"), { row: 1, place: 0 });
  assert.deepEqual(family.neighbour(tree, 1, 0, "ArrowRight"), { row: 1, place: 1 });
  assert.deepEqual(family.neighbour(tree, 1, 1, "ArrowDown"), { row: 2, place: 0 });
  assert.deepEqual(family.neighbour(tree, 0, 0, "ArrowUp"), { row: 0, place: 0 });
});

test("a text names kind, parents, fitness and offspring", () => {
  const ancestors = lineage(rows);
  assert.equal(family.ancestor_text(ancestors.get("3/0/9")),
    "Organism 9 of generation 3: a child of 4 and 1, fitness 30; 2 children and 1 copy in the next generation.");
  assert.equal(family.ancestor_text(ancestors.get("1/0/2")),
    "Organism 2 of generation 1: without known parents, fitness 10; 2 children and 1 copy in the next generation.");
});
