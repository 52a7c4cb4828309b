// The logic of the glass box: records, steps, captions, inheritance, the wheel, tournaments, comparison, theory,
// account.
import assert from "node:assert/strict";
import { test } from "node:test";
import { bundle } from "./bundle.mjs";

const breeding = await bundle("breeding", "texts/breeding", "texts/breeding_theory");
const key = { world: "a", run_id: "r", island: 0, generation: 4 };

/** A record with two organisms, their parameters and the given lists. */
function record_of(fields) {
  const record = new breeding.BreedingRecord(key);
  record.add({ generation: 4, ...fields });
  return record;
}

function parameter(name, value) {
  return { name, value };
}

test("a record requests the lists page by page", () => {
  const record = new breeding.BreedingRecord(key);
  const scaling = { stage: "scaling", index: 0 };
  assert.deepEqual(record.wanted(scaling), { world: "a", island: 0, generation: 4 });
  assert.equal(record.add({ generation: 4, contender_count: 3, pick_count: 2, descendant_count: 3,
    contenders: [{}, { rank: 1 }], picks: [{}] }), true);
  assert.deepEqual(record.wanted(scaling),
    { world: "a", island: 0, generation: 4, first_contender: 2, first_pick: 2, first_descendant: 3 });
  record.add({ generation: 4, contenders: [{ rank: 2 }] });
  assert.equal(record.wanted(scaling), null);
  assert.deepEqual(record.wanted({ stage: "picking", index: 0 }),
    { world: "a", island: 0, generation: 4, first_contender: 3, first_pick: 1, first_descendant: 3 });
});

test("a record ends when an answer has no new row", () => {
  const record = record_of({ contender_count: 5, contenders: [{}] });
  record.add({ generation: 4 });
  assert.equal(record.wanted({ stage: "scaling", index: 0 }), null);
});

test("a record refuses another generation or island", () => {
  const record = new breeding.BreedingRecord(key);
  assert.equal(record.add({ generation: 5 }), false);
  assert.equal(record.add({ generation: 4, island: 1 }), false);
  assert.equal(record.head, null);
});

test("steps go through stages and stop at the ends", () => {
  const stepper = new breeding.Stepper();
  stepper.load(2, 3);
  const stages = [];
  for (let i = 0; i <= stepper.last_position; ++i) {
    stages.push(stepper.moment.stage + stepper.moment.index);
    stepper.step();
  }
  assert.deepEqual(stages, ["scaling0", "picking0", "picking1", "breeding0", "breeding1", "breeding2", "done0"]);
  assert.equal(stepper.at_end, true);
  stepper.previous_stage();
  assert.equal(stepper.position, 3);
  stepper.previous_stage();
  assert.equal(stepper.position, 1);
  stepper.next_stage();
  assert.equal(stepper.position, 3);
});

test("playing advances by time and stops at the end", () => {
  const stepper = new breeding.Stepper();
  stepper.load(2, 2);
  stepper.play();
  stepper.advance(0.4);
  assert.equal(stepper.position, 0);
  stepper.advance(0.4);
  assert.equal(stepper.position, 1);
  stepper.advance(60);
  assert.deepEqual([stepper.position, stepper.playing], [5, false]);
  stepper.play();
  assert.deepEqual([stepper.position, stepper.playing], [0, true]);
});

test("genes from the 33rd on use the further words", () => {
  const genes = (base) => Array.from({ length: 70 }, (_, gene) => base + gene);
  const inheritance = breeding.inheritance_of({
    kind: "DESCENDANT_KIND_CHILD", first_genes: genes(0), second_genes: genes(100), from_second: 2 ** 31 + 1,
    more_from_second: [1, 2 ** 5],
  });
  const from_second = inheritance.crossed.flatMap((origin, gene) => origin.from_second ? [gene] : []);
  assert.deepEqual(from_second, [0, 31, 32, 69]);
  assert.deepEqual(inheritance.cuts, [1, 31, 33, 69]);
  assert.equal(inheritance.genes[69], 169);
});

test("an absent further word means the first parent", () => {
  assert.equal(breeding.is_from_second({ from_second: 0xffffffff }, 31), true);
  assert.equal(breeding.is_from_second({ from_second: 0xffffffff }, 32), false);
});

test("blending takes the weighted mean rounded to float", () => {
  const { crossed, cuts } = breeding.inheritance_of({ kind: "DESCENDANT_KIND_CHILD", first_genes: [1, 2],
    second_genes: [2, 4], second_share: 0.1 });
  assert.deepEqual(crossed.map((origin) => origin.value), [Math.fround(1.1), Math.fround(2.2)]);
  assert.deepEqual([crossed[0].blended, cuts], [true, []]);
});

test("order mutation comes before the mutations of genes", () => {
  const { arranged, moves, genes, changed } = breeding.inheritance_of({
    kind: "DESCENDANT_KIND_CHILD", first_genes: [1, 2, 3], second_genes: [11, 12, 13], from_second: 1,
    order_mutation: { method: "swap", order: [2, 1, 0] },
    mutations: [{ kind: "MUTATION_KIND_CREEP", before: 3, after: 5 },
      { gene: 2, kind: "MUTATION_KIND_CLAMP", before: 11, after: 10 }],
  });
  assert.deepEqual(arranged.map((origin) => origin.value), [3, 2, 11]);
  assert.deepEqual(moves, [{ from: 2, to: 0 }, { from: 0, to: 2 }]);
  assert.deepEqual(genes, [5, 2, 10]);
  assert.deepEqual(changed, [true, false, true]);
});

test("a survivor has one parent: itself", () => {
  const { alone, crossed } =
    breeding.inheritance_of({ kind: "DESCENDANT_KIND_SURVIVOR", first_parent: 3, first_genes: [1, 2] });
  assert.equal(alone, true);
  assert.deepEqual(crossed.map((origin) => origin.value), [1, 2]);
});

test("contradicting lists have no inheritance", () => {
  assert.equal(breeding.inheritance_of({ kind: "DESCENDANT_KIND_CHILD", first_genes: [1], second_genes: [1, 2] }),
    null);
  assert.equal(breeding.inheritance_of({ kind: "DESCENDANT_KIND_CHILD", first_genes: [1], second_genes: [1],
    mutations: [{ gene: 1 }] }), null);
  assert.equal(breeding.inheritance_of({ kind: "DESCENDANT_KIND_CHILD", first_genes: [1], second_genes: [1],
    order_mutation: { order: [1] } }), null);
  assert.equal(breeding.inheritance_of({}), null);
});

test("texts say where a gene comes from", () => {
  const descendant = { kind: "DESCENDANT_KIND_CHILD", first_parent: 12, second_parent: 45, first_genes: [0.42, 1],
    second_genes: [1, 2], mutations: [{ kind: "MUTATION_KIND_CREEP", before: 0.42, after: 0.5 }], from_second: 2 };
  const inheritance = breeding.inheritance_of(descendant);
  assert.equal(breeding.origin_text(inheritance, 0, "hidden3<bias", descendant),
    "hidden3<bias: 0.42 of parent 12, creep to 0.5");
  assert.equal(breeding.other_genes_text(inheritance, 0, descendant),
    "2 other genes: 1 of parent 12, 1 of parent 45, 1 mutated");
  assert.equal(breeding.delta_text(-0.4), "−0.4");
});

test("weights of a neuron form a block", () => {
  const names = ["speed", "h1<a", "h1<bias", "h2<a", "free_1", "free_2"];
  assert.deepEqual(breeding.gene_blocks(names, 1).map((block) => [block.label, block.first, block.count]),
    [["h1", 1, 2], ["h2", 3, 1], ["free_1", 4, 2]]);
});

test("captions name the pick, the winner and the slot", () => {
  const record = record_of({
    contender_count: 2, pick_count: 1, contenders: [{ fitness: 10, rank: 1, slot_end: 0.25 },
      { fitness: 30, slot_begin: 0.25, slot_end: 1, migrant: { island: 2, organism: 5 } }],
    picks: [{ organism: 1, turns: 0.5 }],
  });
  assert.equal(breeding.caption(record, { stage: "picking", index: 0 }),
    "Pick 1 of 1. The pointer stopped in the slot of organism 1 (rank 1, fitness 30.0, migrated from island 2), 75 % " +
    "of the wheel.");
});

test("captions distinguish children, survivors and elite", () => {
  const record = record_of({
    contender_count: 2, descendant_count: 3, contenders: [{ fitness: 10, rank: 1 }, { fitness: 30 }],
    descendants: [{ kind: "DESCENDANT_KIND_ELITE", first_parent: 1 }, { id: 1, kind: "DESCENDANT_KIND_SURVIVOR" },
                  { id: 2, kind: "DESCENDANT_KIND_CHILD", second_parent: 1, crossed: true,
                    mutations: [{ kind: "MUTATION_KIND_CREEP" }, { kind: "MUTATION_KIND_CLAMP" }] }],
  });
  const of = (index) => breeding.caption(record, { stage: "breeding", index });
  assert.equal(of(0),
    "Organism 0 of the next generation: of the elite, organism 1 (rank 1, fitness 30.0), kept unchanged.");
  assert.equal(of(1), "Organism 1 of the next generation: a survivor, organism 0 (rank 2, fitness 10.0).");
  assert.equal(of(2), "Organism 2 of the next generation: a child of organisms 0 and 1, 1 mutation.");
});

test("the summary names method, scaling and counts", () => {
  const record = record_of({
    contender_count: 50, pick_count: 25, descendant_count: 50, survivor_count: 25, elite_count: 1,
    parameters: [parameter("selection", { choice: "roulette" }), parameter("fitness_scaling", { choice: "windowing" }),
      parameter("population_model", { choice: "hybrid" })],
  });
  assert.equal(breeding.breeding_summary(record),
    "Roulette with windowing · hybrid · 50 organisms, 25 picks: 25 survivors (1 of the elite) and 25 children");
});

test("narrow neighbouring slots share an arc", () => {
  const contenders = [{ slot_end: 0.5 }, { rank: 1, slot_begin: 0.5, slot_end: 0.501 },
    { rank: 2, slot_begin: 0.501, slot_end: 0.502 }, {}, { rank: 3, slot_begin: 0.502, slot_end: 1 }];
  assert.deepEqual(breeding.wheel_arcs(contenders, 0.01).map((arc) => [arc.first, arc.last]), [[0, 0], [1, 2], [4, 4]]);
  assert.equal(breeding.wheel_arcs(contenders, 0.01)[1].rank, 1.5);
});

test("the wheel begins at the top and turns clockwise", () => {
  const { x, y } = breeding.point_at(100, 50, 0.25);
  assert.deepEqual([Math.round(x), Math.round(y)], [150, 100]);
  assert.deepEqual(breeding.rank_colour(0, 50).slice(0, 3), [254, 232, 56]);
});

test("winners of a tournament are marked, each once", () => {
  const picks = [{ organism: 7, tournament: 0, contestants: [3, 7, 7] },
    { organism: 7, tournament: 0, contestants: [3, 7, 7] }, { organism: 1, tournament: 1, contestants: [1] }];
  const record = record_of({ contender_count: 8, pick_count: 3, picks });
  assert.deepEqual(breeding.contestants_of(record, 1).map(({ won, picked_now }) => [won, picked_now]),
    [[false, false], [true, false], [true, true]]);
  assert.deepEqual(breeding.contestants_of(record, 2), [{ organism: 1, won: true, picked_now: true }]);
});

/** Four organisms on a roulette wheel with fitness 4, 3, 2, 1; ids are in reverse order of rank. */
function roulette() {
  const contenders = [1, 2, 3, 4].map((fitness, organism) => ({
    fitness, rank: 3 - organism, expected_copies: 10 * fitness / 10,
    expected_copies_error: Math.sqrt(10 * fitness / 10 * (1 - fitness / 10)),
    unpicked_chance: (1 - fitness / 10) ** 10, copies: [0, 2, 2, 6][organism],
  }));
  const picks = [3, 3, 3, 2, 1, 3, 3, 2, 1, 3].map((organism) => ({ organism, turns: 0 }));
  return record_of({ contender_count: 4, pick_count: 10, contenders, picks,
    parameters: [parameter("selection", { choice: "roulette" }), parameter("fitness_scaling", { choice: "none" })] });
}

test("copies are compared by rank in standard errors", () => {
  const record = roulette(), comparison = breeding.compare(record);
  assert.deepEqual(comparison.organisms, [3, 2, 1, 0]);
  assert.deepEqual(comparison.copies, [6, 2, 2, 0]);
  assert.equal(comparison.deviations[0].toFixed(3), (2 / Math.sqrt(2.4)).toFixed(3));
  assert.equal(comparison.deviations[2], 0);
  assert.deepEqual(breeding.copies_after(record, 4), [3, 1, 0, 0]);
  const [best, rest] = breeding.rank_columns(comparison, comparison.copies, 1, 2);
  assert.deepEqual([best.first, best.last, best.copies, best.expected, rest.copies], [0, 1, 8, 7, 2]);
});

test("a missing contender has no comparison yet", () => {
  const record = record_of({ contender_count: 2, contenders: [{}] });
  assert.equal(breeding.compare(record), null);
});

test("an impossible number of copies deviates infinitely", () => {
  assert.equal(breeding.deviation(1, 0, 0), Infinity);
  assert.equal(breeding.deviation(2, 2, 0), 0);
});

test("theory predicts what Blickle and Thiele derive", () => {
  const record = roulette(), comparison = breeding.compare(record);
  const all = new Map(breeding.predictions(breeding.selection_of(record), comparison)
    .map((prediction) => [prediction.name, prediction]));
  // Proportional selection: intensity = standard deviation / mean of the fitness.
  assert.ok(Math.abs(all.get("Selection intensity").expected - Math.sqrt(1.25) / 2.5) < 1e-12);
  assert.ok(Math.abs(all.get("Loss of diversity").expected - 0.2) < 1e-12);
  assert.equal(all.get("Share not selected").observed, 0.25);
  // After t generations the fittest has the share 4^t / (4^t + 3^t + 2^t + 1), which reaches 3/4 at t = 5.
  assert.equal(all.get("Takeover time").expected, 5);
  assert.equal(all.get("Agreement of all copies").observed, (4 / 4 + 1 / 3 + 0 + 1) / 4);
});

test("overlapping generations have no takeover time", () => {
  const selection = { method: "roulette", pressure: "fitness", independent_picks: true, overlapping: true, picks: 2 };
  assert.equal(breeding.takeover_generations(selection, [2, 1], [2, 1]), null);
});

test("the account says why a mean changed", () => {
  const accounts =
    breeding.accounts_of({ genes: [{ mean: 100, deviation: 2,
      account: { selection: 0.4, transmission: -0.1, change: 0.3 } }, { mean: 1, deviation: 1, account: {} }] },
      ["normal_speed", "impulse"]);
  assert.equal(breeding.account_texts.change(accounts[0]),
    "The mean of normal speed rose by 0.3: selection +0.4, transmission −0.1, migration 0.");
  assert.equal(breeding.account_texts.change(accounts[1]),
    "The mean of impulse did not change: selection 0, transmission 0, migration 0.");
  assert.equal(breeding.reason_text(accounts[0]), "Organisms with more of it had more descendants.");
  assert.deepEqual(breeding.most_changed(accounts, 1).map((account) => account.name), ["normal speed"]);
  assert.deepEqual(breeding.accounts_of(null, []), []);
});

test("bets score hits against chance and the law", () => {
  const record = roulette(), comparison = breeding.compare(record), bets = new breeding.Bets();
  bets.toggle(3);
  bets.toggle(0);
  bets.toggle(0);
  bets.toggle(1);
  assert.deepEqual(bets.organisms, [3, 1]);
  const score = breeding.score_of(bets, comparison, comparison.copies, 10);
  assert.deepEqual(score, { bets: 2, picks: 10, hits: 8, random: 5, law: 6, most: 8 });
  assert.equal(breeding.score_text(score, true), "8 of 10 picks hit your 2 bets. Random bets: 5 expected. " +
    "Your bets: 6 expected by the law of the selection. The best possible bets: 8. Score: 1.6 times random betting.");
  assert.equal(breeding.score_text(score, false), "8 of 10 picks hit your 2 bets. Random bets: 5 expected.");
});

test("at most five bets count", () => {
  const bets = new breeding.Bets();
  [1, 2, 3, 4, 5, 6].forEach((organism) => bets.toggle(organism));
  assert.deepEqual(bets.organisms, [1, 2, 3, 4, 5]);
});

test("a hold runs a generation, then one tick", () => {
  const hold = new breeding.GenerationHold();
  assert.equal(hold.update("a r", "RUN_STATE_RUNNING", false), "none");
  hold.hold("a r");
  assert.equal(hold.update("a r", "RUN_STATE_RUNNING", false), "run one generation");
  assert.equal(hold.update("a r", "RUN_STATE_RUNNING", false), "none");
  assert.equal(hold.update("a r", "RUN_STATE_WAITING", false), "step one tick");
  assert.equal(hold.update("a r", "RUN_STATE_RUNNING", true), "none");
  assert.equal(hold.update("a r", "RUN_STATE_RUNNING", false), "run one generation");
});

test("a hold ends when another run is shown", () => {
  const hold = new breeding.GenerationHold();
  hold.hold("a r");
  assert.equal(hold.update("a@1 r", "RUN_STATE_RUNNING", false), "none");
  assert.equal(hold.on, false);
});

test("normal quantiles agree with tables", () => {
  for (const [above, quantile] of [[0.5, 0], [0.158655253931457, 1], [0.022750131948179, 2], [0.001349898031630, 3],
      [0.9, -1.2815515655446]]) {
    assert.ok(Math.abs(breeding.upper_normal_quantile(above) - quantile) < 1e-8, `${above}`);
  }
});

test("ranking of a binary tournament has intensity 0.564", () => {
  // Blickle & Thiele 1996: the selection intensity of tournaments of two under normal fitness is 1/√π.
  const population = 2000,
    copies = Array.from({ length: population }, (_, rank) => 2 * (population - rank - 0.5) / population);
  assert.ok(
    Math.abs(breeding.weighted_mean(copies, breeding.normal_scores(population)) - 1 / Math.sqrt(Math.PI)) < 1e-3);
});
