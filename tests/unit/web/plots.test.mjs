// The pure parts of the plots: ticks, decimation, zoom, running means, marks, notes, the columns of a history, figures and CSV.
import assert from "node:assert/strict";
import { test } from "node:test";
import { bundle } from "./bundle.mjs";

const plots = await bundle("plots/plot_layout", "plots/history_table", "plots/figures", "plots/history_csv", "plots/change_marks", "world/change_text", "core/csv", "plots/motion", "plots/other_history",
                           "widgets/visible_range", "world/changes");
const shown = { min: 0, max: 100 };

test("ticks are round and inside the range", () => {
  assert.deepEqual(plots.ticks_in({ min: 0, max: 100 }, 5), { step: 50, at: [0, 50, 100] });
  assert.deepEqual(plots.ticks_in({ min: 0.1, max: 0.95 }, 10).at.map((tick) => plots.tick_label(tick, 0.1)),
                   ["0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7", "0.8", "0.9"]);
  assert.deepEqual(plots.ticks_in({ min: -1, max: 1 }, 3).at, [-1, 0, 1]);
});

test("counts have no ticks between them", () => {
  assert.deepEqual(plots.ticks_in({ min: 1, max: 3 }, 10, 1).at, [1, 2, 3]);
});

test("an empty or infinite range has no ticks", () => {
  assert.deepEqual(plots.ticks_in({ min: 2, max: 2 }, 5).at, []);
  assert.deepEqual(plots.ticks_in({ min: 0, max: Infinity }, 5).at, []);
});

test("tick labels have the decimals of their step", () => {
  assert.equal(plots.tick_label(1500, 500), "1,500");
  assert.equal(plots.tick_label(0.25, 0.05), "0.25");
  assert.equal(plots.tick_label(-2, 1), "−2");
});

test("zooming keeps the point under the pointer", () => {
  const half = plots.zoomed(shown, 0.25, 2, shown, 4);
  assert.deepEqual(half, { min: 12.5, max: 62.5 });
  assert.deepEqual(plots.zoomed(half, 0.25, 0.5, shown, 4), shown);
  assert.equal(plots.zoomed(shown, 0.5, 1000, shown, 4).max - plots.zoomed(shown, 0.5, 1000, shown, 4).min, 4);
});

test("moving stops at the ends of the axis", () => {
  assert.deepEqual(plots.moved({ min: 10, max: 30 }, -50, shown), { min: 0, max: 20 });
  assert.deepEqual(plots.moved({ min: 10, max: 30 }, 500, shown), { min: 80, max: 100 });
  assert.deepEqual(plots.revealed({ min: 0, max: 10 }, 99, 0.5, shown), { min: 90, max: 100 });
  assert.deepEqual(plots.revealed({ min: 0, max: 10 }, 9, 0.5, shown), { min: 0, max: 10 });
});

test("a short series is not grouped", () => {
  assert.deepEqual([...plots.groups_of([1, 2, 3], { min: 0, max: 4 }, 100)], [0, 1, 2, 3]);
  assert.deepEqual([...plots.groups_of([], shown, 100)], [0]);
});

test("a series outside the view keeps one number at each end", () => {
  assert.deepEqual([...plots.groups_of([0, 1, 2, 3, 4, 5], { min: 1.5, max: 3.5 }, 100)], [1, 2, 3, 4, 5]);
});

test("a long series keeps every peak with few points", () => {
  const count = 100_000, columns = 500;
  const x = Float64Array.from({ length: count }, (_, i) => i), y = Float64Array.from(x, (i) => Math.sin(i));
  y[33_333] = 50;
  y[77_777] = -50;
  const points = plots.line_of(x, y, plots.groups_of(x, { min: 0, max: count - 1 }, columns));
  const heights = points.filter((_, i) => i % 2 === 1);
  assert.ok(points.length / 2 <= 4 * (columns + 1), `${points.length / 2} points`);
  assert.ok(heights.includes(50) && heights.includes(-50));
  assert.equal(points[0], 0);
  assert.equal(points[points.length - 2], count - 1);
});

test("a gap interrupts the line", () => {
  const y = [1, 2, NaN, 4, 5], x = [0, 1, 2, 3, 4];
  const points = plots.line_of(x, y, plots.groups_of(x, { min: 0, max: 4 }, 100));
  assert.deepEqual(points, [0, 1, 1, 2, 2, NaN, 3, 4, 4, 5]);
});

test("a running mean contains no later number", () => {
  assert.deepEqual([...plots.running_mean([1, 3, 5, 100], 3)], [1, 2, 3, 36]);
  assert.deepEqual([...plots.running_mean([1, NaN, 5], 2)], [1, NaN, 5]);
  assert.deepEqual([...plots.running_mean([1, 3], 1)], [1, 3]);
});

test("the nearest number is found, ties at the lower one", () => {
  assert.equal(plots.nearest([1, 3, 7], 2), 0);
  assert.equal(plots.nearest([1, 3, 7], 5.1), 2);
  assert.equal(plots.nearest([1, 3, 7], 99), 2);
  assert.equal(plots.nearest([], 1), -1);
});

test("near marks share a line", () => {
  const marks = [1, 2, 3, 10].map((x) => ({ x, text: "" }));
  assert.deepEqual(plots.mark_lines(marks, { min: 0, max: 20 }, 2.5), [1, 10]);
  assert.deepEqual(plots.mark_lines(marks, { min: 2, max: 20 }, 1), [2, 3, 10]);
});

test("a note never covers its plot if there is room", () => {
  const box = { left: 900, top: 300, right: 1270, bottom: 600 }, window = { width: 1280, height: 720 };
  assert.deepEqual(plots.note_place(box, { width: 200, height: 100 }, 400, window), { left: 696, top: 350 });
  const phone = { left: 10, top: 300, right: 350, bottom: 500 };
  assert.equal(plots.note_place(phone, { width: 300, height: 150 }, 400, { width: 360, height: 740 }).top, 146);
});

test("the upper end belongs to the last bin", () => {
  assert.deepEqual(plots.histogram([0, 0.5, 1, 2], { min: 0, max: 2 }, 2), [2, 2]);
});

// ---- the columns of a history ----

function statistics(generation, island, fields = {}) {
  return { generation, ...(island > 0 ? { island } : {}), organism_count: 10, fitness_best: generation, fitness_mean: 1, ...fields };
}

test("absent fields are 0, and unknown numbers NaN", () => {
  const table = new plots.HistoryTable();
  table.add([{ generation: 1, genes: [{ mean: 2 }] }]);
  assert.deepEqual(table.column(null, "fitness_best"), [0]);
  assert.deepEqual(table.column(null, "gene:0:deviation"), [0]);
  assert.ok(Number.isNaN(table.column(null, "gene:0:selection")[0]));
  assert.ok(Number.isNaN(table.column(null, "gene:7:mean")[0]));
});

test("islands are combined as in evoview", () => {
  const table = new plots.HistoryTable();
  table.add([statistics(1, 0, { organism_count: 30, fitness_best: 5, fitness_mean: 2, fitness_worst: 1, fitness_deviation: 1, food_eaten: 7 }),
             statistics(1, 1, { organism_count: 10, fitness_best: 9, fitness_mean: 6, fitness_worst: 3, fitness_deviation: 2, food_eaten: 8 })]);
  assert.equal(table.island_count, 2);
  assert.deepEqual(table.column(null, "organism_count"), [40]);
  assert.deepEqual(table.column(null, "food_eaten"), [15]);
  assert.deepEqual(table.column(null, "fitness_best"), [9]);
  assert.deepEqual(table.column(null, "fitness_worst"), [1]);
  assert.deepEqual(table.column(null, "fitness_mean"), [3]);
  assert.ok(Math.abs(table.column(null, "fitness_deviation")[0] - Math.sqrt(0.75 * (1 + 1) + 0.25 * (4 + 9))) < 1e-12);
  assert.ok(Number.isNaN(table.column(null, "fitness_median")[0]));
  assert.deepEqual(table.column(1, "fitness_mean"), [6]);
});

test("columns grow with the history", () => {
  const table = new plots.HistoryTable(), history = [statistics(1, 0), statistics(2, 0)];
  table.set_history(history);
  assert.deepEqual(table.column(null, "fitness_best"), [1, 2]);
  const revision = table.revision;
  table.set_history([...history]);
  assert.equal(table.revision, revision);
  table.set_history([...history, statistics(3, 0)]);
  assert.deepEqual(table.column(null, "fitness_best"), [1, 2, 3]);
});

test("the first generations may leave the history", () => {
  const table = new plots.HistoryTable(), history = [1, 2, 3, 4].flatMap((generation) => [statistics(generation, 0), statistics(generation, 1)]);
  table.set_history(history);
  assert.deepEqual(table.column(null, "generation"), [1, 2, 3, 4]);
  table.set_history([...history.slice(4), statistics(5, 0), statistics(5, 1)]);
  assert.deepEqual(table.column(null, "generation"), [3, 4, 5]);
  assert.deepEqual(table.column(1, "fitness_best"), [3, 4, 5]);
});

test("another run replaces the table", () => {
  const table = new plots.HistoryTable();
  table.set_history([statistics(1, 0), statistics(2, 0)]);
  table.set_history([statistics(1, 0)]);
  assert.deepEqual(table.column(null, "generation"), [1]);
  table.set_history([]);
  assert.deepEqual(table.column(null, "generation"), []);
});

test("a missing island is NaN", () => {
  const table = new plots.HistoryTable();
  table.add([statistics(1, 0), statistics(1, 1), statistics(2, 1)]);
  assert.deepEqual(table.column(0, "generation"), [1, 2]);
  assert.ok(Number.isNaN(table.column(0, "fitness_best")[1]));
  assert.deepEqual(table.column(null, "fitness_best"), [1, 2]);
});

test("the history of a compared world follows it", async () => {
  const events = new plots.Listeners(), settled = () => new Promise(setImmediate);
  const server = {
    events, state: { welcome: null }, worlds: { find: () => ({ run_id: "r", generation: 3 }) },
    request: async () => ({ generations: [statistics(1, 0), statistics(2, 0)], changes: [{ generation: 2, values: [] }] }),
  };
  let changes = 0;
  const other = new plots.OtherHistory(server, "w", () => ++changes);
  await settled();
  assert.deepEqual([other.table.column(null, "generation"), other.changes.length, other.problem], [[1, 2], 1, ""]);
  events.call({ world: "w", generation_finished: { statistics: [statistics(3, 0)] } });
  events.call({ world: "v", generation_finished: { statistics: [statistics(9, 0)] } });
  await settled();
  assert.deepEqual(other.table.column(null, "generation"), [1, 2, 3]);
  server.request = async () => { throw new Error("gone"); };
  events.call({ world: "w", world_reset: {} });
  await settled();
  assert.deepEqual([other.table.column(null, "generation"), other.problem], [[], "gone"]);
  const before = changes;
  other.close();
  events.call({ world: "w", generation_finished: { statistics: [statistics(1, 0)] } });
  await settled();
  assert.equal(changes, before);
});

// ---- figures ----

function subject(name, gene_names, rows) {
  const table = new plots.HistoryTable();
  table.add(rows);
  return { table, island: null, name, gene_names, changes: [] };
}

function figure(quantity, subject, request = {}) {
  return plots.figure_of({ quantity, subject, other: null, genes: [], gene: "", window: 1, ...request });
}

test("every line differs from the others in colour, dash or thickness", () => {
  const names = Array.from({ length: 12 }, (_, i) => `g${i}`);
  const one = subject("a", names, [{ generation: 1, genes: names.map(() => ({ mean: 1 })) }]);
  const { series } = figure("genes", one, { genes: names, window: 10 });
  assert.equal(series.length, 12);
  assert.equal(new Set(series.map(({ colour, dash, thickness }) => JSON.stringify([colour, dash, thickness]))).size, 12);
  assert.equal(new Set(series.map(({ dash, thickness }) => JSON.stringify([dash, thickness]))).size, 12, "without colours, too");
});

test("the compared history is dashed, and finds genes by their names", () => {
  const one = subject("a", ["x", "y"], [{ generation: 1, genes: [{ mean: 1 }, { mean: 2 }] }]);
  const two = subject("b", ["y"], [{ generation: 1, genes: [{ mean: 5 }] }]);
  const { series, solid, dashed } = figure("genes", one, { other: two, genes: ["x", "y"] });
  assert.deepEqual(series.map(({ name, y }) => [name, ...y]), [["x", 1], ["y", 2], ["y, b", 5]]);
  assert.deepEqual([solid, dashed], ["a", "b"]);
  assert.deepEqual(series.map(({ dash }) => dash.length > 0), [false, false, true]);
});

test("the band stays between the worst and the best", () => {
  const one = subject("a", [], [{ generation: 1, fitness_best: 12, fitness_mean: 10, fitness_worst: 1, fitness_deviation: 20 }]);
  const band = figure("fitness", one).series.find(({ kind }) => kind === "band");
  assert.deepEqual([band.low[0], band.y[0]], [1, 12]);
});

test("selection of a gene is shown with its causes", () => {
  const account = { selection: 1, transmission: -0.25, change: 0.75 };
  const one = subject("a", ["x"], [{ generation: 1, genes: [{ mean: 1 }] }, { generation: 2, genes: [{ mean: 1.75, account }] }]);
  const { series } = figure("selection", one, { genes: ["x"], gene: "x" });
  assert.deepEqual(series.map(({ name, y }) => [name, y[1]]), [["change", 0.75], ["selection", 1], ["transmission", -0.25], ["migration", 0]]);
  assert.ok(Number.isNaN(series[0].y[0]));
});

test("the most changed genes come first", () => {
  const names = ["a", "b", "c"];
  const one = subject("w", names, [{ generation: 1, genes: [{ mean: 1 }, { mean: 1 }, { mean: 1 }] }, { generation: 2, genes: [{ mean: 2 }, { mean: 1 }, { mean: -9 }] }]);
  assert.deepEqual(plots.most_changed("genes", one, names, 2), ["c", "a"]);
  assert.deepEqual(plots.most_changed("genes", one, names, 3), names);
});

test("rare extinctions are marked", () => {
  const rows = Array.from({ length: 20 }, (_, i) => statistics(i + 1, 0, { alive_count: i === 4 ? 0 : 3 }));
  const { table } = subject("a", [], rows);
  assert.deepEqual(plots.extinctions(table, null).map(({ x }) => x), [5]);
  assert.deepEqual(plots.extinctions(subject("a", [], rows.map((row) => ({ ...row, alive_count: 0 }))).table, null), []);
});

test("a change of parameters has evoview's text", () => {
  const [mark] = plots.marks_of([{ generation: 20, by: { kind: "ACTOR_KIND_CLIENT", user: "alice" },
                                   values: [{ name: "mutation_chance", before: { real: 0.01 }, after: { real: 0.2 } }] }]);
  assert.deepEqual(mark, { x: 20, text: "generation 20: mutation_chance 0.01 → 0.2 by alice", label: "mutation_chance 0.01 → 0.2" });
});

// ---- CSV ----

test("quoted cells keep commas, quotes and line breaks", () => {
  const records = (text) => [...plots.csv_records(text)].map((record) => ({ ...record }));
  const cells = ["plain", 'a,"b"', "two\nlines", ""];
  assert.equal(plots.csv_line(cells), 'plain,"a,""b""","two\nlines",');
  assert.deepEqual(records(`# made by evod\r\n${plots.csv_line(cells)}\r\n\n"",x`),
                   [{ line: 2, cells }, { line: 5, cells: ["", "x"] }]);
  assert.deepEqual(records('a\n"b\nc'), [{ line: 1, cells: ["a"] }, { line: 2, wrong: "open quote" }]);
  assert.deepEqual(records('"a"b'), [{ line: 1, wrong: "text after quote" }]);
});

test("a saved history is read again", () => {
  const account = { selection: 1, transmission: 2, migration: 0, change: 3 };
  const rows = [statistics(1, 0, { genes: [{ mean: 1.5, deviation: 0.25, min: 1, max: 2 }] }), statistics(2, 0, { genes: [{ mean: 2, deviation: 0, min: 2, max: 2, account }] })];
  const { gene_names, runs: [run, ...others] } = plots.read_history_csv(plots.history_csv(rows, ['turn,"left"']));
  assert.deepEqual([gene_names, run.name, others], [['turn,"left"'], "", []]);
  assert.deepEqual(run.history.map((one) => [one.generation, one.fitness_best, one.organism_count]), [[1, 1, 10], [2, 2, 10]]);
  assert.deepEqual(run.history[1].genes[0], { mean: 2, deviation: 0, min: 2, max: 2, account });
  assert.equal(run.history[0].genes[0].account, undefined);
});

const colony_row = (generation, prey, predators) => statistics(generation, 0, {
  colony: { count_mean: prey, lowest_count: prey - 5, children_mean: 1.5 },
  ...(predators === undefined ? {} : { predators: { fitness_best: 7, colony: { count_mean: predators } } }) });

test("a saved colony is read as one run", () => {
  const rows = [colony_row(1, 150, undefined), colony_row(2, 140, 20)];
  const { gene_names, runs } = plots.read_history_csv(plots.history_csv(rows, []));
  assert.deepEqual([gene_names, runs.length], [[], 1]);
  const { colony, predators } = runs[0].history[1];
  assert.deepEqual([colony.count_mean, colony.children_mean, predators.colony.count_mean], [140, 1.5, 20]);
  assert.equal(runs[0].history[0].predators, undefined);
});

test("the population has a line for each species", () => {
  const population = (rows) => figure("population", subject("a", [], rows)).series;
  const names = (rows) => population(rows).map(({ name, y }) => [name, ...y]);
  assert.deepEqual(names([statistics(1, 0)]), []);
  assert.deepEqual(names([colony_row(1, 150, undefined)]), [["prey, mean", 150], ["prey, fewest", 145]]);
  assert.deepEqual(names([colony_row(1, 150, undefined), colony_row(2, 140, 20)]),
                   [["prey, mean", 150, 140], ["prey, fewest", 145, 135], ["predators, mean", 0, 20], ["predators, fewest", 0, 0]]);
  assert.equal(figure("fitness", subject("a", [], []), { births: true }).y_label, "children");
});

test("the runs of a sweep are distinguished", () => {
  const [heading, first, second] = plots.history_csv([statistics(1, 0), statistics(2, 0)], []).trimEnd().split("\n");
  const lines = [`cell,replicate,seed,selection,${heading}`, `0,0,7,random,${second}`, `0,0,7,random,${first}`, `1,0,7,roulette,${first}`];
  const { runs } = plots.read_history_csv(`# evod sweep: …\n${lines.join("\n")}\n`);
  assert.deepEqual(runs.map(({ name, history }) => [name, ...history.map((one) => one.generation)]),
                   [["selection random", 1, 2], ["selection roulette", 1]]);
  assert.match(plots.read_history_csv([...lines, lines[3]].join("\n")), /^line 5: generation 1 of island 0 occurs twice; allowed: once, or once per run /);
});

test("a wrong table names its line and what is allowed", () => {
  const text = plots.history_csv([statistics(1, 0)], []);
  assert.match(plots.read_history_csv("a,b\n1,2\n"), /^line 1: there is no column "generation"; allowed: tables of Save CSV, /);
  assert.match(plots.read_history_csv(text.replace(/\n1,/, "\nx,")), /^line 2, generation: got "x", allowed: a number$/);
  assert.match(plots.read_history_csv(text.replace(/\n1,0,/, "\n1,1.5,")), /^line 2, island: got 1.5, allowed: whole numbers from 0 to 65,535$/);
  assert.match(plots.read_history_csv(text.trimEnd() + ",9\n"), /^line 2 has 21 cells, allowed: 20, as many as the heading$/);
  assert.match(plots.read_history_csv(text.split("\n")[0]), /^there is no row after the heading in line 1; allowed: /);
  assert.match(plots.read_history_csv(""), /^the file contains no table; allowed: /);
});

// ---- the motion of bodies ----

test("a motion of the same tick replaces the last, an earlier one begins again", () => {
  const history = new plots.MotionHistory();
  for (const tick of [1, 2, 2]) {
    history.add({ tick, body_count: 10 * tick, momentum_x: 3, momentum_y: 4 });
  }
  const [, momentum] = plots.measures.map((measure) => plots.motion_figure(measure, history.motions));
  assert.deepEqual([momentum.series[0].x, momentum.series[0].y], [[1, 2], [5, 5]]);
  history.add({ body_count: 1 });
  assert.deepEqual(history.motions, [{ body_count: 1 }]);
  Array.from({ length: 400 }, (_, i) => history.add({ tick: i + 1 }));
  assert.deepEqual([history.motions.length, history.motions[0].tick], [300, 101]);
});

test("a tick is judged by the bodies that move too far", () => {
  const motion = { tick_s: 0.1, body_count: 100, generation_tick: 10, fastest_step_share: 1, fastest_px_s: 80 };
  const judged = (too_fast_count, more = {}) => plots.judge_tick({ ...motion, too_fast_count, ...more });
  assert.deepEqual(judged(undefined), { level: "good", sentence: "The tick is short enough: the fastest body moves 1 of its radius in a tick." });
  assert.match(judged(29).sentence, /^The tick is short enough: only on average 2.9 of 100 bodies move further /);
  assert.equal(judged(30).level, "nearly too long");
  assert.equal(judged(100).level, "too long");
  assert.match(judged(100).sentence, /Set tick_s to 0.05 or less, or max_speed_px_s to 40\.$/);
  assert.match(judged(100, { fastest_step_share: 0.4 }).sentence, /Halve tick_s, to 0.05, or lower max_speed_px_s\.$/);
});
