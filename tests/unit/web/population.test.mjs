// The pure parts of the drawing of a population without bodies, and of the best solution.
import assert from "node:assert/strict";
import { test } from "node:test";
import { bundle } from "./bundle.mjs";

const page = await bundle("plots/parallel_axes", "world/gene_axes", "world/best_organism");

test("axes have the bounds of lists and of parameters", () => {
  const info = {
    gene_names: ["body_size", "rate", "act", "order0", "order1", "free0"],
    gene_groups: ["GENE_GROUP_BODY", ...Array(5).fill("GENE_GROUP_FREE")],
    free_genes: { genes: [{ name: "rate", min: 0.001, max: 1, logarithmic: true }, { name: "act", choices: ["relu", "tanh"] }, { name: "order", permutation: 2 }] },
  };
  const set = { parameters: [["body_size_min", 50], ["body_size_max", 200], ["free_gene_min", -2], ["free_gene_max", 2]].map(([name, real]) => ({ name, value: { real } })) };
  const axes = page.gene_axes(info, set);
  assert.deepEqual(axes.map(({ name, min, max }) => [name, min, max]),
                   [["body_size", 50, 200], ["rate", 0.001, 1], ["act", 0, 1], ["order0", 0, 1], ["order1", 0, 1], ["free0", -2, 2]]);
  assert.deepEqual([page.gene_value_text(axes[2], 1), page.gene_value_text(axes[1], 0.00123456)], ["tanh", "0.001235"]);
  assert.deepEqual(page.gene_axes(info, null)[0].min, null);
});

test("a value lies between the bounds of its axis", () => {
  assert.equal(page.place_on({ min: -2, max: 2, logarithmic: false }, 1), 0.75);
  assert.equal(page.place_on({ min: 0.01, max: 1, logarithmic: true }, 0.1).toFixed(9), "0.500000000");
  assert.equal(page.place_on({ min: 0, max: 1, logarithmic: false }, 7), 1);
  const unknown = { name: "a", min: null, max: null, logarithmic: false, choices: [] };
  assert.deepEqual([page.bounded(unknown, [3, -1]).min, page.bounded(unknown, [3, -1]).max], [-1, 3]);
  assert.deepEqual([page.bounded(unknown, [4, 4]).min, page.bounded(unknown, [4, 4]).max], [4, 5]);
});

test("a sample is evenly spaced and contains the best", () => {
  assert.deepEqual(page.sample_of(3, 1000, 2), [0, 1, 2]);
  assert.deepEqual(page.sample_of(10000, 4, null), [0, 2500, 5000, 7500]);
  assert.deepEqual(page.sample_of(10000, 4, 9999), [0, 2500, 5000, 9999]);
  assert.equal(page.best_of(Float64Array.of(-3, -1, -1)), 1);
  assert.equal(page.best_of(null), null);
});

test("as many axes are shown as have room, at most 40", () => {
  assert.deepEqual([page.axes_with_room(6, 390), page.axes_with_room(200, 390), page.axes_with_room(200, 3000), page.axes_with_room(6, 5)], [6, 16, 40, 1]);
});

test("the best solution is the first with the greatest fitness", () => {
  const best = new page.BestOrganism();
  assert.equal(best.in([]), null);
  const rows = [{ generation: 1, island: 0, fitness_best: -5 }, { generation: 1, island: 1, fitness_best: -2 }];
  assert.equal(best.in(rows), rows[1]);
  rows.push({ generation: 2, island: 0, fitness_best: -2 }, { generation: 2, island: 1 });
  assert.equal(best.in(rows), rows[3]);
  assert.equal(best.in(rows.slice(0, 1)).fitness_best, -5);
});
