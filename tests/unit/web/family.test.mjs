// The logic of the family tree: the lineage table and the positions of the ancestors.
import assert from "node:assert/strict";
import { test } from "node:test";
import { bundle } from "./bundle.mjs";

const family = await bundle("family");
const text = await bundle("texts/family");

const columns = ["generation", "island", "organism",
  ...["first", "second"].flatMap((one) => [`parent_${one}_generation`, `parent_${one}_island`, `parent_${one}`]),
  "origin", "fitness", "child_count", "kept_count"];

function row(generation, organism, first, second, island = 0) {
  const parent = (of) => of === null ? ["", "", ""] : [generation - 1, island, of];
  const origin = first === null ? "initial" : first === second ? "survivor" : "child";
  return [generation, island, organism, ...parent(first), ...parent(second), origin, 10 * generation, 2, 1].join(",");
}

const csv = (rows) => [columns.join(","), ...rows];

function lineage(rows, last_generation = Infinity) {
  const reader = new family.LineageReader(last_generation);
  reader.add(csv(rows));
  return reader.ancestors;
}

const lines = { both_parents: true, generations: 10, order: "lines" };
const root = (organism, generation = 3) => ({ generation, island: 0, organism });
const ids = (tree) => tree.rows.map((row) => row.map((spot) => spot.ancestor.organism));

const rows = [row(3, 9, 4, 1), row(2, 4, 2, 2), row(2, 1, 2, 0), row(1, 2, null, null), row(1, 0, null, null)];

/** A server that exports lines in parts of 7 bytes. Counts the requests. */
function exporting(lines) {
  const text = new TextEncoder().encode(lines.join("\n") + "\n");
  return {
    requests: 0,
    async request() {
      const begin = 7 * this.requests++, part = text.subarray(begin, begin + 7);
      return begin < text.length ? { export_id: 1, text: part } : { export_id: 1, last: true, generations_left_out: 2 };
    },
  };
}

test("parts may end within a row", async () => {
  const server = exporting(csv(rows)), read = await family.load_lineage(server, "w", root(9), false, 1);
  assert.equal(read.ancestors.size, 5);
  assert.deepEqual(read.ancestors.get("3/0/9").parents.map((parent) => parent.organism), [4, 1]);
  assert.deepEqual(read.ancestors.get("2/0/4").parents.map((parent) => parent.organism), [2]);
  assert.deepEqual([read.bytes, read.generations_left_out], [csv(rows).join("\n").length + 1, 2]);
});

test("a damaged table is named", () => {
  assert.throws(() => new family.LineageReader(1).add(["generation,island"]), /has no column organism/);
  assert.throws(() => lineage(["1,,x"]), /a row without an organism: 1,,x/);
});

test("reading ends at a later generation", async () => {
  const later = Array.from({ length: 20 }, (_, organism) => row(2, organism, 0, 0)), table = csv([row(1, 0, null, null), ...later]);
  const server = exporting(table), {ancestors} = await family.load_lineage(server, "w", root(0, 1), true, 1);
  assert.deepEqual([...ancestors.keys()], ["1/0/0"]);
  assert.ok(7 * server.requests < csv([row(1, 0, null, null), later[0], later[1]]).join("\n").length, String(server.requests));
});

test("the tree has one row per generation", () => {
  const tree = family.family_tree(lineage(rows), [root(9)], lines);
  assert.equal(tree.first_generation, 1);
  assert.deepEqual(ids(tree), [[2, 0], [4, 1], [9]]);
  assert.deepEqual(tree.rows[1].map((spot) => [spot.first, spot.second]), [[0, -1], [0, 1]]);
  assert.deepEqual([tree.rows[2][0].first, tree.rows[2][0].second], [0, 1]);
});

test("lines of first parents leave second parents out", () => {
  const tree = family.family_tree(lineage(rows), [root(9)], { ...lines, both_parents: false });
  assert.deepEqual(ids(tree), [[2], [4], [9]]);
});

test("the number of generations is bounded", () => {
  const tree = family.family_tree(lineage(rows), [root(9)], { ...lines, generations: 2 });
  assert.deepEqual([tree.first_generation, tree.rows.length], [2, 2]);
  assert.equal(family.family_tree(lineage(rows), [{ ...root(9), island: 1 }], lines), null);
});

test("organisms of a row keep their distance", () => {
  const wide = [row(2, 0, 0, 5), ...Array.from({ length: 6 }, (_, organism) => row(1, organism, null, null))];
  const tree = family.family_tree(lineage(wide), [root(0, 2)], lines);
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
  const tree = family.family_tree(lineage(rows), [root(9)], lines);
  assert.deepEqual(family.neighbour(tree, { row: 2, place: 0 }, "ArrowUp"), { row: 1, place: 0 });
  assert.deepEqual(family.neighbour(tree, { row: 1, place: 0 }, "ArrowRight"), { row: 1, place: 1 });
  assert.deepEqual(family.neighbour(tree, { row: 1, place: 1 }, "ArrowDown"), { row: 2, place: 0 });
  assert.deepEqual(family.neighbour(tree, { row: 0, place: 0 }, "ArrowUp"), { row: 0, place: 0 });
});

test("a text names kind, parents, fitness and offspring", () => {
  const ancestors = lineage(rows);
  assert.equal(text.family_texts.organism(ancestors.get("3/0/9")),
    "Organism 9 of generation 3: a child of 4 and 1, fitness 30.0; 2 children and 1 copy in the next generation.");
  assert.equal(text.family_texts.organism(ancestors.get("1/0/2")),
    "Organism 2 of generation 1: without known parents, fitness 10.0; 2 children and 1 copy in the next generation.");
});

// Generation 3 has organisms 0 to 3. All but 3 descend from 4 of generation 2; 3 descends from 5; both descend from 7.
const pedigree = lineage([
  row(1, 7, null, null), row(1, 8, null, null), row(2, 4, 7, 8), row(2, 5, 7, 7), row(3, 0, 4, 4), row(3, 1, 4, 5),
  row(3, 2, 5, 4), row(3, 3, 5, 5),
]);
const whole = (form = {}) => family.family_tree(pedigree, [0, 1, 2, 3].map((id) => root(id)), { ...lines, ...form });
const at = (tree, organism, generation) => family.place_of(tree, root(organism, generation));

test("the most recent common ancestor of all is found", () => {
  const tree = whole(), { row: found, places, all_row } = family.ancestors_of_all(tree);
  assert.deepEqual([found, places.map((place) => tree.rows[0][place].ancestor.organism), all_row], [0, [7], null]);
  assert.equal(family.ancestors_of_all(whole({ generations: 2 })), null);
  assert.equal(family.ancestors_of_all(whole({ both_parents: false })).all_row, 0);
});

test("bits beyond a word count as well", () => {
  const many = Array.from({ length: 70 }, (_, organism) => row(2, organism, 0, organism === 69 ? 1 : 0));
  const roots = many.map((_, organism) => root(organism, 2));
  const tree = family.family_tree(lineage([row(1, 0, null, null), row(1, 1, null, null), ...many]), roots, lines);
  assert.deepEqual(family.ancestors_of_all(tree).places.map((place) => tree.rows[0][place].ancestor.organism), [0]);
});

test("two organisms have the latest common ancestors", () => {
  const tree = whole();
  const of_two = (one, other) => {
    const { row: found, places, between } = family.ancestors_of_two(tree, at(tree, ...one), at(tree, ...other));
    return [found, places.map((place) => tree.rows[found][place].ancestor.organism), between.size];
  };
  assert.deepEqual(of_two([0, 3], [1, 3]), [1, [4], 3]);
  assert.deepEqual(of_two([0, 3], [3, 3]), [0, [7], 5]);
  assert.deepEqual(of_two([4, 2], [2, 3]), [1, [4], 2]); // one is an ancestor of the other
  const short = whole({ generations: 2 });
  assert.equal(family.ancestors_of_two(short, at(short, 0, 3), at(short, 3, 3)), null);
});

test("the fittest come first", () => {
  const fit = (organism, fitness) => `1,0,${organism},,,,,,,initial,${fitness},0,0`;
  const tree = family.family_tree(lineage([fit(0, 5), fit(1, ""), fit(2, 9)]), [0, 1, 2].map((one) => root(one, 1)),
    { ...lines, order: "fitness" });
  assert.deepEqual(ids(tree), [[2, 0, 1]]);
});

test("ordering removes crossings and never adds any", () => {
  const chance = ((seed) => () => (seed = (seed * 48271) % 2147483647) / 2147483647)(7);
  const random = [1, 2, 3, 4].flatMap((generation) => Array.from({ length: 30 }, (_, organism) =>
    row(generation, organism, generation === 1 ? null : Math.floor(30 * chance()), generation === 1 ? null
      : Math.floor(30 * chance()))));
  const roots = Array.from({ length: 30 }, (_, organism) => root(organism, 4));
  const tree = family.family_tree(lineage(random), roots, lines);
  const crossings = (rows) => rows.slice(1).reduce((sum, below) => {
    const ends = below.flatMap((spot, place) => [spot.first, spot.second].flatMap((up) => up < 0 ? [] : [[up, place]]));
    return sum + ends.reduce((count, [up, low]) => count + ends.filter(([u, l]) => u < up && l > low).length, 0);
  }, 0);
  const after = family.crossing_count(tree.rows);
  assert.equal(after, crossings(tree.rows)); // counted by brute force
  family.order_by_first_parents(tree.rows);
  assert.ok(after < crossings(tree.rows), `${after} crossings, ordered by first parents: ${crossings(tree.rows)}`);
  assert.deepEqual(tree.rows[3].map((spot) => tree.rows[2][spot.first].ancestor.organism),
    tree.rows[3].map((spot) => spot.ancestor.parents[0].organism));
});

test("the colours name lineages and scales", () => {
  const tree = whole(), by_lineage = family.colouring_of(tree, { kind: "lineage" }, new family.GeneTable());
  assert.deepEqual(by_lineage.legend.lineages.map(({ founder, count }) => [founder.organism, count]), [[7, 4]]);
  const table = new family.PopulationReader(), genes = new family.GeneTable();
  table.add(["island,organism,speed,size", "0,0,1.5,2", "0,1,2.5,4"]);
  genes.set(3, table.islands);
  assert.equal(genes.value(root(1), 1), 4);
  const choices = new family.PopulationReader(new Map([["act", ["relu", "1", "a,b"]]]));
  choices.add(["island,organism,rate,act", '0,0,1,"a,b"']);
  choices.add(["0,1,2,1"]);
  assert.deepEqual(choices.islands.get(0), [Float32Array.of(1, 2), Float32Array.of(2, 1)]);
  const { least, most, unknown } = family.colouring_of(tree, { kind: "gene", gene: 0 }, genes).legend;
  assert.deepEqual([least, most, unknown], [1.5, 2.5, 6]);
});
