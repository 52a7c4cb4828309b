// The logic of the organism panel: what is known about an organism, its texts, and the layout of its network.
import assert from "node:assert/strict";
import { test } from "node:test";
import { bundle } from "./bundle.mjs";

const organism = await bundle("organism"), { Selection } = await bundle("world/selection");
const place = { run_id: "r", island: 1, generation: 5, id: 3 };
const none = 0xffffffff;

function info(fields = {}) {
  return { id: 3, island: 1, generation: 5, alive: true, lived_s: 2, health: 50, genes: [1], parents: [45, 7],
    ...fields };
}

test("a history takes the organism's own answers only", () => {
  const history = new organism.OrganismHistory(place);
  history.add_info(info({ generation: 6 }));
  history.add_info(info({ id: undefined }));
  assert.equal(history.info, null);
  history.add_info(info());
  history.add_info(info());
  history.add_info(info({ lived_s: 3, health: 40 }));
  assert.deepEqual(history.health, [{ s: 2, health: 50 }, { s: 3, health: 40 }]);
});

test("a full health curve keeps every second point", () => {
  const history = new organism.OrganismHistory(place);
  for (let i = 0; i <= organism.health_points_max; ++i) {
    history.add_info(info({ lived_s: i }));
  }
  assert.equal(history.health.length, organism.health_points_max / 2 + 1);
  assert.deepEqual(history.health.slice(0, 2).map((point) => point.s), [0, 2]);
});

test("a dead organism keeps its last network", () => {
  const history = new organism.OrganismHistory(place);
  history.add_info(info({ brain: { inputs: [1] } }));
  history.add_info(info({ alive: undefined, lived_s: 3, cause_of_death: "CAUSE_OF_DEATH_POISONED" }));
  assert.deepEqual(history.brain, { inputs: [1] });
  assert.equal(organism.fate_text(history), "died of poison after 3.0 s");
});

const born = (fields = {}) => info({ number: 120, age_s: 2, parents: [4, 4], placed_tick: 9, ...fields });

test("with births nothing is asked about picks", () => {
  const history = new organism.OrganismHistory(place);
  history.add_info(born());
  assert.equal(history.wanted(true), null);
  assert.equal(organism.birth_text(history), "Child of organism 4 of this interval");
  history.add_info(born({ parents: [4, 9] }));
  assert.equal(organism.birth_text(history), "Child of organisms 4 and 9 of this interval");
  history.add_info(born({ parents: [], placed_tick: 7 }));
  assert.match(organism.birth_text(history), /^No parents: placed by a user after tick 7/);
  history.add_info(born({ parents: [], placed_tick: undefined }));
  assert.equal(organism.birth_text(history), "No parents: it came at the beginning of this interval");
  history.add_info(born({ age_s: 2, lived_s: 2, parents: [4], placed_tick: undefined })); // born in the last tick of an interval
  assert.equal(organism.birth_text(history), "It was born before this interval");
});

test("with births a life goes on over intervals", () => {
  const before = new organism.OrganismHistory(place), after = { ...place, id: 1, generation: 6 };
  before.add_info(born({ health: 50 }));
  const same = new organism.OrganismHistory(after, before), other = new organism.OrganismHistory(after, before);
  const next = { id: 1, generation: 6, age_s: 5, lived_s: 1, health: 30, parents: [3], placed_tick: undefined };
  same.add_info(born(next));
  other.add_info(born({ ...next, number: 121 }));
  assert.deepEqual(same.health, [{ s: 2, health: 50 }, { s: 5, health: 30 }]);
  assert.deepEqual(other.health, [{ s: 5, health: 30 }]);
  assert.equal(organism.birth_text(same), "It was born before this interval");
  assert.equal(organism.fate_text(same), "alive for 5.0 s, health 30.0");
});

test("a predator hunts, handles and dies of old age", () => {
  const predator = info({ species: "SPECIES_PREDATOR", choice: "CHOICE_SEEK", target_x_px: 5, target_y_px: 6 });
  assert.equal(organism.choice_text(predator), "about to hunt prey at (5, 6)");
  assert.equal(organism.choice_text({ ...predator, handling_s: 2.5 }), "handles its prey for another 2.5 s");
  assert.match(organism.choice_text(info({ choice: "CHOICE_FLEE" })), /^about to flee from poison at/);
  assert.match(organism.choice_text(info({ choice: "CHOICE_FLEE", flees_predator: true })), /^about to flee from the predator at/);
  const history = new organism.OrganismHistory(place);
  history.add_info(info({ alive: false, cause_of_death: "CAUSE_OF_DEATH_OLD" }));
  assert.equal(organism.fate_text(history), "died of old age after 2.0 s");
  history.add_info(info({ alive: false, cause_of_death: "CAUSE_OF_DEATH_EATEN" }));
  assert.equal(organism.fate_text(history), "eaten by a predator after 2.0 s");
});

test("a followed organism is found again by its number", async () => {
  // The interval began with the prey 3, 40, 120, 200 and the predators 50, 90; 300 and 301 were born in it.
  const living = [[3], [40], [120], [200], [50, 1], [90, 1], [300, 0, 1], [301, 1, 1]];
  const asked = [];
  const request = async (_, { organism }) => {
    asked.push(organism);
    const [number, is_predator, is_new] = living[organism];
    return { generation: 2, number, lived_s: 1, placed_tick: is_new, ...(is_predator ? { species: "SPECIES_PREDATOR" } : {}) };
  };
  const feed = { world: "w", island: 0, pane: 0, snapshot: { run_id: "r", generation: 1 }, server: { request, post: () => undefined } };
  for (const [number, species, id] of [[120, undefined, 2], [3, undefined, 0], [90, "SPECIES_PREDATOR", 5], [41, undefined, null]]) {
    const selection = new Selection(feed, { notify: () => undefined }, () => undefined);
    selection.select(7);
    selection.set_follow(true);
    selection.info = { number, species };
    selection.follow_generation({ run_id: "r", generation: 2, live: { organism_count: living.length } });
    await new Promise((resolve) => setTimeout(resolve));
    assert.deepEqual([selection.id, selection.follow, selection.is_lost], [id, id !== null, id === null], String(number));
  }
  assert.ok(asked.length <= 4 * 4);
});

test("picks of the parents are requested, then its own", () => {
  const history = new organism.OrganismHistory(place);
  history.add_info(info());
  const first = history.wanted(true);
  assert.deepEqual(first, { island: 1, generation: 4, first_contender: 45, first_pick: none, first_descendant: none });
  history.add_breeding(first, { generation: 4, island: 1, pick_count: 25, survivor_count: 2,
    contenders: [{ copies: 3, expected_copies: 1.71 }] });
  assert.equal(history.origin, "child");
  assert.equal(organism.picks_text("Its parent 45", history.picks_of_parent(45)),
    "Its parent 45 was picked 3 of 25 times, expected 1.71.");
  const second = history.wanted(true);
  assert.equal(second.first_contender, 7);
  history.add_breeding(second,
    { generation: 4, island: 1, pick_count: 25, contenders: [{ migrant: { organism: 9 } }] });
  assert.equal(organism.picks_text("Its parent 7", history.picks_of_parent(7)),
    "Its parent 7 (a copy of organism 9 of island 0) was picked 0 of 25 times, expected 0.");
  assert.equal(history.wanted(false), null);
  assert.deepEqual(history.wanted(true),
    { island: 1, generation: 5, first_contender: 3, first_pick: none, first_descendant: 0 });
});

test("offspring are read page by page", () => {
  const history = new organism.OrganismHistory(place);
  history.add_info(info({ parents: [] }));
  const pages = [
    { generation: 5, island: 1, pick_count: 2, descendant_count: 4, contenders: [{ copies: 2 }],
      descendants: [{ kind: "DESCENDANT_KIND_SURVIVOR", first_parent: 3 },
        { id: 1, kind: "DESCENDANT_KIND_CHILD", first_parent: 3, second_parent: 8 }] },
    { generation: 5, island: 1, descendant_count: 4,
      descendants: [{ id: 2, kind: "DESCENDANT_KIND_CHILD", first_parent: 8, second_parent: 8 },
        { id: 3, kind: "DESCENDANT_KIND_CHILD", first_parent: 3, second_parent: 3, mutations: [{}] }] },
  ];
  for (const page of pages) {
    history.add_breeding(history.wanted(true), page);
  }
  assert.equal(history.wanted(true), null);
  assert.deepEqual(history.children.map(organism.child_text), ["0 (unchanged)", "1 (with 8)", "3 (single parent)"]);
});

test("an answer without rows ends the search", () => {
  const history = new organism.OrganismHistory(place);
  history.add_info(info({ parents: [] }));
  history.add_breeding(history.wanted(true), { generation: 5, island: 1, descendant_count: 4, contenders: [{}] });
  assert.deepEqual([history.children_left_out, history.wanted(true)], [true, null]);
});

test("gene ranges come from the organism's generation", () => {
  const history = new organism.OrganismHistory(place);
  const genes = [new Float32Array([1, 2, 6])];
  history.add_population({ generation: 6, island: 1, genes });
  history.add_population({ generation: 5, island: 0, genes });
  assert.deepEqual(history.ranges, []);
  history.add_population({ generation: 5, island: 1, genes });
  assert.deepEqual(history.ranges, [{ min: 1, mean: 3, max: 6 }]);
});

test("parents are named with the way into the generation", () => {
  assert.equal(organism.parents_text(info(), "child"), "Parents: 45 and 7 (generation 4)");
  assert.equal(organism.parents_text(info({ parents: [7, 7] }), "child"),
    "One parent: 7 (generation 4), which was both parents");
  assert.equal(organism.parents_text(info({ parents: [7] }), "elite"),
    "One parent: 7 (generation 4): this organism belongs to the elite");
  assert.equal(organism.parents_text(info({ parents: [] }), "unknown"),
    "No parents: founder of generation 1, or loaded from a file");
  assert.equal(organism.parents_text(info({ placed_tick: 0 }), "unknown"),
    "No parents: placed by a user after tick 0 of the generation");
});

test("the next action names its target", () => {
  assert.equal(organism.choice_text({ choice: "CHOICE_SEEK", target_x_px: 12.4, target_y_px: 1000.2 }),
    "about to seek food at (12, 1,000)");
  assert.equal(organism.choice_text({ choice: "CHOICE_STEER" }), "steered by its network");
  assert.equal(organism.choice_text({}), "");
});

test("groups of genes are contiguous ranges", () => {
  const groups = ["GENE_GROUP_BODY", "GENE_GROUP_BODY", "GENE_GROUP_BRAIN", "GENE_GROUP_FREE"];
  assert.deepEqual(organism.genes_of(groups, "brain", 4), { first: 2, count: 1 });
  assert.deepEqual(organism.genes_of([], "body", 6), { first: 0, count: 6 });
  assert.deepEqual(organism.genes_of([], "brain", 6), { first: 6, count: 0 });
});

const brain = { input_names: ["food_bearing", "speed"], inputs: [0.5, -1], hidden: [0.1, 0.2, 0.3],
  output_names: ["turn"], outputs: [-0.25], has_bias: true };
const weights = [1, 2, 3, 4, 5, 6, 7, 8, -9, 0.5, 0.25, 0.125, -0.0625]; // 3 × (2 + 1) + 1 × (3 + 1)

test("weights follow the order of the chromosome", () => {
  const diagram = organism.brain_diagram(brain, weights, 300, { inputs: 80, outputs: 60 });
  assert.deepEqual(diagram.neurons.map((neuron) => neuron.name),
    ["food_bearing", "speed", "bias", "hidden1", "hidden2", "hidden3", "bias", "turn"]);
  const weight = (from, to) => diagram.connections
    .find((connection) => connection.from === from && connection.to === to).weight;
  assert.deepEqual([weight(0, 3), weight(2, 3), weight(0, 4), weight(2, 5), weight(3, 7), weight(6, 7)],
    [1, 3, 4, -9, 0.5, -0.0625]);
  assert.equal(diagram.connections[diagram.connections.length - 1].weight, -9);
});

test("a wrong number of weights has no diagram", () => {
  assert.equal(organism.brain_diagram(brain, weights.slice(1), 300, { inputs: 80, outputs: 60 }), null);
});

test("notes list the inputs, the strongest first", () => {
  const diagram = organism.brain_diagram(brain, weights, 300, { inputs: 80, outputs: 60 });
  assert.equal(organism.neuron_text(diagram, 5),
    "hidden3: 0.30. Inputs: bias × −9.00, speed × 8.00, food bearing × 7.00");
  assert.equal(organism.connection_text(diagram, diagram.connections[diagram.connections.length - 1]),
    "bias → hidden3: weight −9.00");
});

test("arrow keys move between neurons and stay inside", () => {
  const diagram = organism.brain_diagram(brain, weights, 300, { inputs: 80, outputs: 60 });
  assert.equal(organism.neighbour(diagram, 0, "ArrowUp"), 0);
  assert.equal(organism.neighbour(diagram, 2, "ArrowDown"), 2);
  assert.equal(organism.neighbour(diagram, 3, "ArrowRight"), 7);
  assert.equal(organism.neighbour(diagram, 7, "ArrowRight"), 7);
});

test("the axis of the health ends at a round number", () => {
  assert.deepEqual([1, 104, 201].map(organism.axis_end), [1, 150, 250]);
});
