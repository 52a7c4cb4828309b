// The freezer of the page: files of chromosomes, the reading of a whole population, first generations, comparisons, limits.
import assert from "node:assert/strict";
import { test } from "node:test";
import { bundle } from "./bundle.mjs";

const page = await bundle("freezer", "world/names");
const genes = ["normal_speed", "impulse", "body_size", "base_health", "food_radius", "poison_radius"];
const heading = ["island", "organism", ...genes].join(",");
const row = "103.2,97.5,100,-1.5e-7,99.25,101";

test("a population is the same after writing and reading", () => {
  const islands = [Float32Array.of(0.1, 1 / 3, -0, 16777217, 1.17549435e-38, 3.4028235e38, 1, 2, 3, 4, 5, 6), Float32Array.of(6, 5, 4, 3, 2, 1)];
  const text = page.population_text({ gene_names: [...genes], islands });
  assert.deepEqual(page.read_population(text), { gene_names: [...genes], islands });
  assert.match(text, /^0,0,0\.1,0\.33333334,-0,16777216,/m);
  assert.deepEqual(page.read_population(`\ufeff${text.replaceAll("\n", "\r\n").trimEnd()}`).islands, islands);
});

test("random floats are the same after writing and reading", () => {
  const floats = new Float32Array(1), bits = new Uint32Array(floats.buffer);
  for (let i = 0; i < 20000; ++i) {
    bits[0] = Math.imul(i, 2654435761);
    assert.ok(!Number.isFinite(floats[0]) || Object.is(Math.fround(Number(page.float_text(floats[0]))), floats[0]), `${floats[0]}`);
  }
});

test("a file of another program is read as evod reads it", () => {
  const expected = { gene_names: ["normal_speed", "turn"], islands: [Float32Array.of(1.5, 2), Float32Array.of(3, -4e-3, 5, 6)] };
  for (const text of [
    "island,organism,normal_speed,turn\n7,0,3,-4e-3\n2,0,1.5,2\n7,0,5,6\n",
    "turn,island,normal_speed,organism\n2,0,1.5,0\n-4e-3,1,3,0\n6,1,5,1\n",
    "\ufeffisland;organism;normal_speed;turn\r\n0;0;1,5;2\r\n1;0;3;-4e-3\r\n;;;\r\n1;1;5;6\r\n",
    "island\torganism\tnormal_speed\tturn\n0\t0\t1,5\t2\n1\t0\t3\t-4e-3\n1\t1\t5\t6\n",
    '"","island","organism","normal_speed","turn"\n"1",0,0,1.5,2\n"2",1,0,3,"-4e-3"\n"3",1, 1 ,5,6\n',
    "island , organism, normal_speed,turn\n\n0,0, 1.5,2 \n1,0,3,-4e-3\n,,,\n1,1,5,6"]) {
    assert.deepEqual(page.read_population(text), expected, text);
  }
});

test("a choice is read as a text and as an index, and written as a text", () => {
  const choices = new Map([["act", ["relu", "tanh", "1", "16", "a,b"]]]);
  assert.deepEqual(page.read_population("island,organism,act\n0,0,tanh\n0,1,0\n0,2,1\n0,3,16\n0,4,3\n", choices).islands, [Float32Array.of(1, 0, 2, 3, 3)]);
  const population = { gene_names: ["rate", "act"], islands: [Float32Array.of(1, 2, 0.5, 4)] };
  const text = page.population_text(population, choices);
  assert.equal(text, 'island,organism,rate,act\n0,0,1,1\n0,1,0.5,"a,b"\n');
  assert.deepEqual(page.read_population(text, choices), population);
  assert.match(page.read_population("island,organism,act\n0,0,gelu\n", choices), /^line 2: got "0,0,gelu", allowed: a number, or one of relu, tanh, 1, 16, a,b \(column act\)$/);
});

test("a wrong file names the line, what it contains and what is allowed", () => {
  for (const [text, problem] of [
    ["", /^line 1: got "", allowed: a heading with island, organism and the name of each gene once, in any order$/],
    ["island,organism\n0,0\n", /^line 1: /],
    [`${heading},\n`, /^line 1: /],
    [`${heading},turn,turn\n`, /^line 1: /],
    [`${heading}\n`, /^there is no organism in it$/],
    [`${heading}\n0,0,1,2,3,4,5\n`, /^line 2: got "0,0,1,2,3,4,5", allowed: an island, an organism and 6 genes, so 8 cells, not 7$/],
    [`${heading}\n0,0,1,5,2,3,4,5,6\n`, /so 8 cells, not 9; decimal commas need semicolons/],
    [`${heading}\n0,0,1,2,3,4,5,nan\n`, /^line 2: .*, allowed: a number \(column poison_radius\)$/],
    [`${heading}\n\n0,x,1,2,3,4,5,6\n`, /^line 3: .*, allowed: a whole number \(column organism\)$/],
    [`${heading}\n0,0,1,2,3,4,5,1e39\n`, /^line 2: /],
    [`${heading}\n"0,0,${row}\n`, /^line 2: a cell in quotation marks does not end as it must$/]]) {
    assert.match(page.read_population(text), problem);
  }
});

/** A page of GetPopulation: gene g of organism o of an island is 100 island + 10 o + g. */
function page_of(island, first, count, generation = 3, organism_count = 3) {
  const columns = Array.from({ length: 2 }, (_, gene) => Array.from({ length: count }, (_, i) => 100 * island + 10 * (first + i) + gene));
  const bytes = new Uint8Array(8 * count + 1); // views in messages have no alignment
  bytes.set(new Uint8Array(Float32Array.from(columns.flat()).buffer), 1);
  return { generation, organism_count, count, genes: bytes.subarray(1) };
}

test("a whole population is read again if a generation ends meanwhile", async () => {
  let asked = 0;
  const ask = async ({ island, first_organism }) =>
    page_of(island, first_organism, first_organism === 0 ? 2 : 1, ++asked > 3 ? 4 : 3); // the fourth page is of the next one
  const { generation, population } = await page.whole_population(ask, "w", 2, ["a", "b"]);
  assert.equal(generation, 4);
  assert.deepEqual(population.islands, [Float32Array.of(0, 1, 10, 11, 20, 21), Float32Array.of(100, 101, 110, 111, 120, 121)]);
  let number = 0;
  await assert.rejects(page.whole_population(async () => page_of(0, 0, 2, ++number), "w", 1, ["a", "b"]), /too short to read a whole one/);
});

test("a world begins with a population or with copies of an organism", () => {
  const registry = [{ name: "population_size", default_value: { count: 50 } }, { name: "island_count", default_value: { count: 1 } }];
  const population = (...islands) => ({ gene_names: ["a", "b"], islands: islands.map((island) => Float32Array.from(island)) });
  const whole = page.first_population(population([1, 2, 3, 4], [5, 6, 7, 8]), "{}", registry);
  assert.deepEqual(whole.parameters, [{ name: "population_size", value: { count: 2 } }, { name: "island_count", value: { count: 2 } }]);
  const copies = page.first_population(population([1, 2]), '{"population_size": {"1": 3}, "island_count": 2}', registry);
  assert.deepEqual(copies.population.map(({ genes }) => [...genes]), [[1, 2, 1, 2, 1, 2], [1, 2, 1, 2, 1, 2]]);
  assert.equal(page.first_population(population([1, 2]), "no JSON", registry).population[0].genes.length, 100);
  assert.match(page.first_population(population([1, 2, 3, 4], [5, 6]), "{}", registry), /got islands of 2 and 1 organisms/);
});

test("genes are compared by name", () => {
  const compared = page.compared_genes(["a", "b", "c"], [1, 2, 3], ["c", "a"], [3, 0]);
  assert.deepEqual(compared.map(({ other }) => other), [0, null, 3]);
  assert.deepEqual(page.difference_counts(compared), { common: 2, different: 1 });
  assert.deepEqual(page.range_of_gene({ gene_names: ["a", "b"], islands: [Float32Array.of(1, 9, 3, 9), Float32Array.of(8, 9)] }, 0),
                   { min: 1, mean: 4, max: 8 });
});

test("organisms with other genes do not fit", () => {
  assert.equal(page.gene_problem("leader", ["a", "b"], "w", ["a", "b"]), "");
  assert.match(page.gene_problem("leader", ["a"], "w", ["a", "b"]), /^leader has 1 gene, but the organisms of the world w have 2\.$/);
  assert.match(page.gene_problem("leader", ["a", "c"], "w", ["a", "b"]), /gene 2 is c, not b/);
});

test("a full freezer says how much is free", () => {
  assert.equal(page.room_problem([{ genes_bytes: 24 }], 24), "");
  assert.match(page.room_problem([{ genes_bytes: page.genes_bytes_max - (1 << 20) }], 3 << 20), /need 3 MiB, and 1 of 64 MiB are free/);
  assert.match(page.room_problem(Array(page.kept_max).fill({ genes_bytes: 0 }), 24), /1,000 entries/);
  assert.equal(page.name_of_origin({ world: "w".repeat(64), generation: 12, island: 0, organism: 7 }).length, 64);
});
