// The pure parts of the page's renderer: colours and styles equal to those of evoview, the camera, interpolation, picking,
// densities, labels, trails and flashes. Each is what client/viewer does.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import path from "node:path";
import { test } from "node:test";
import { fileURLToPath } from "node:url";
import { bundle } from "./bundle.mjs";

const root = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../../..");
const render = await bundle("render");

// ---- colours ---------------------------------------------------------------------------------------------------

const palette_h = readFileSync(path.join(root, "client/viewer/drawing/palette.h"), "utf8").replace(/\/\/.*$/gm, "");
const palette_cpp = readFileSync(path.join(root, "client/viewer/drawing/palette.cpp"), "utf8").replace(/\/\/.*$/gm, "");
const styles_cpp = readFileSync(path.join(root, "client/viewer/island/styles.cpp"), "utf8").replace(/\/\/.*$/gm, "");

function numbers(text) {
  const found = text.match(/\d+/g).map(Number);
  return found.length === 3 ? [...found, 255] : found;
}

/** Constants of palette.h: name -> colour, and arrays: name -> list of colours or names. */
const constants = new Map();
for (const [, name, value] of palette_h.matchAll(/constexpr Colour (\w+)\{([^}]*)\};/g)) {
  constants.set(name, numbers(value));
}
for (const [, name, body] of palette_h.matchAll(/constexpr std::array<Colour, \d+> (\w+)\{\{(.*?)\}\};/gs)) {
  constants.set(name, [...body.matchAll(/\{([^}]*)\}|(kinds\[\d\])/g)].map(([, value, other]) => (other ? resolve(other) : numbers(value))));
}
for (const [, name, other] of palette_h.matchAll(/constexpr Colour (\w+) = (kinds\[\d\]);/g)) {
  constants.set(name, resolve(other));
}

function resolve(name) {
  const [, of, index] = name.match(/^(\w+)(?:\[(\d)\])?$/);
  const value = constants.get(of);
  assert.ok(value, `${name} is not in palette.h`);
  return index === undefined ? value : value[Number(index)];
}

test("the colours of an island are those of evoview", () => {
  for (const [name, ours] of Object.entries(render.island_colours)) {
    const body = palette_cpp.match(new RegExp(`constexpr IslandColours ${name}\\{(.*?)\\};`, "s"))[1];
    const theirs = Object.fromEntries([...body.matchAll(/\.(\w+) = (\{[^}]*\}|[\w[\]]+)/g)].map(
      ([, field, value]) => [field, value.startsWith("{") ? numbers(value) : resolve(value)]));
    assert.deepEqual(ours, theirs, name);
  }
});

test("kinds and the unknown have evoview's colours", () => {
  assert.deepEqual(render.kinds, constants.get("kinds"));
  assert.deepEqual(render.unknown, constants.get("unknown"));
});

test("the colour ramps are those of evoview", () => {
  for (const [name, ours] of Object.entries(render.ramps)) {
    const body = palette_cpp.match(new RegExp(`constexpr std::array<Colour, \\d+> ${name}\\{\\{(.*?)\\}\\};`, "s"))[1];
    assert.deepEqual(ours, [...body.matchAll(/\{([^{}]*)\}/g)].map(([, stop]) => stop.match(/\d+/g).map(Number)), name);
  }
  assert.deepEqual(render.ramp_at("viridis", 0), [68, 1, 84, 255]);
  assert.deepEqual(render.ramp_at("viridis", 2), [253, 231, 37, 255]);
  assert.deepEqual(render.ramp_at("violet", 0.5), [136, 111, 236, 255]);
  assert.deepEqual(render.ramp_at("violet", NaN), render.unknown);
});

/** The styles that a function of styles.cpp sets, in the form of look.ts. */
function styles_in(function_name, of, shadow) {
  const body = styles_cpp.match(new RegExp(`Styles ${function_name}\\([^)]*\\) \\{\n(.*?)\n\\}`, "s"))[1];
  const colour = (text) => text === "transparent" ? [0, 0, 0, 0] : text.startsWith("of.") ? of[text.slice(3)] : text.startsWith("palette::") ? resolve(text.slice(9))
    : numbers(text.replace("shadow", String(shadow)));
  const made = {};
  for (const [, name, fields, plain] of body.matchAll(/styles\.(\w+) = (?:\{(.*?)\}|([\w.]+));/gs)) {
    if (plain !== undefined) {
      made[name] = plain.startsWith("styles.") ? made[plain.slice(7)] : parseFloat(plain);
      continue;
    }
    const black = [0, 0, 0, 255];
    const style = { form: "circle", fill: black, edge: black, fill_low: black, edge_pixels: 0, half_pixels_min: 0, line_pixels: 1.5 };
    for (const [, field, value] of fields.matchAll(/\.(\w+) = (\{[^}]*\}?|[\w.:]+)/g)) {
      if (field === "form") {
        style.form = value.slice(6).replace(/(?<=[a-z])[A-Z]/, (letter) => "_" + letter).toLowerCase();
      } else {
        style[field] = field.endsWith("pixels") || field.endsWith("min") ? parseFloat(value) : colour(value);
      }
    }
    made[name] = style;
  }
  if (function_name === "common") {
    made.food_dot.fill = [...made.food_dot.fill.slice(0, 3), 140];
    made.poison_dot.fill = [...made.poison_dot.fill.slice(0, 3), 140];
  }
  return made;
}

test("the styles of both skins are those of evoview", () => {
  assert.match(styles_cpp, /food_dot\.fill\.alpha = styles\.poison_dot\.fill\.alpha = 140/);
  for (const [skin, background, name, shadow] of [["vivid", "dark", "dark", 110], ["vivid", "light", "light", 60], ["classic", "dark", "classic", 0]]) {
    const of = render.island_colours[name];
    assert.deepEqual(render.styles_of({ skin, background }), { ...styles_in("common", of, shadow), ...styles_in(skin, of, shadow) }, name);
  }
});

// ---- camera ----------------------------------------------------------------------------------------------------

const canvas = { width: 1000, height: 600 }, island = { width: 2000, height: 1000 };

test("the fitted camera leaves room for walls and a margin", () => {
  const camera = render.fitted(canvas, island);
  assert.deepEqual([camera.x_px, camera.y_px], [1000, 500]);
  const corner = render.to_screen(camera, canvas, { x: 0, y: 500 });
  assert.ok(Math.abs(corner.x - 14) < 1e-9, `${corner.x}`); // 6 of the wall and 8 around it
});

test("zooming holds the point under the cursor", () => {
  const camera = { x_px: 900, y_px: 500, zoom: 2 }, cursor = { x: 700, y: 250 };
  const held = render.to_world(camera, canvas, cursor);
  const moved = render.to_screen(render.zoomed(camera, canvas, island, cursor, 1.7), canvas, held);
  assert.ok(Math.hypot(moved.x - cursor.x, moved.y - cursor.y) < 1e-9);
});

test("zoom and centre stay in their ranges", () => {
  const fit = render.fitted(canvas, island);
  assert.equal(render.zoomed(fit, canvas, island, { x: 0, y: 0 }, 1e-9).zoom, fit.zoom / 2);
  assert.equal(render.zoomed(fit, canvas, island, { x: 0, y: 0 }, 1e9).zoom, 64);
  const whole = render.panned(fit, canvas, island, { x: -1e6, y: 1e6 });
  assert.deepEqual([whole.x_px, whole.y_px], [1000, 500]); // it is all visible
  const far = render.panned({ ...fit, zoom: 2 }, canvas, island, { x: -1e6, y: 1e6 });
  assert.deepEqual([far.x_px, far.y_px], [2000 + 7 - 250, 150 - 7]); // the walls and the margin are 7 px at this zoom
});

test("the minimap appears only while a part is out of sight", () => {
  const fit = render.fitted(canvas, island);
  assert.equal(render.is_whole_island_visible(fit, canvas, island), true);
  const close = render.zoomed(fit, canvas, island, { x: 500, y: 300 }, 4);
  assert.equal(render.is_whole_island_visible(close, canvas, island), false);
  const place = render.minimap_place(canvas, island);
  assert.deepEqual(place.screen, { left: 808, top: 498, width: 180, height: 90 });
  const frame = render.minimap_frame(place, close, canvas);
  assert.ok(Math.abs(frame.left + frame.width / 2 - 898) < 1e-9 && frame.width < 60);
});

// ---- interpolation ---------------------------------------------------------------------------------------------

function snapshot(changes = {}, organisms = [[0, 16, 32]], coarse = []) {
  const column = (i, Kind) => Kind.from(organisms, (row) => row[i]);
  const none = { id: new Uint32Array(0), x: new Int32Array(0), y: new Int32Array(0) };
  const boxes = { x: new Int32Array(0), y: new Int32Array(0), half_width: new Int32Array(0), half_height: new Int32Array(0) };
  return {
    info: { world: "a", run_id: "r", island: 0, generation: 1, tick: 0, simulated_s: 0, state: "RUN_STATE_RUNNING", width_px: 2000, height_px: 1000,
            item_radius_px: 5, tile_px: 0, counts: { organisms: organisms.length }, ...changes },
    organisms: { id: column(0, Uint32Array), x: column(1, Int32Array), y: column(2, Int32Array), radius: Int32Array.from(organisms, (row) => row[3] ?? 160),
                 health: Int32Array.from(organisms, (row) => row[4] ?? 1600), heading: null, species: changes.species ?? null },
    food: none, poison: none, crates: boxes, obstacles: boxes, coarse, ...(changes.items ?? {}),
  };
}

test("positions are interpolated over the interval of arrival", () => {
  const at = new render.Interpolator();
  at.add(snapshot({}, [[1, 0, 0], [2, 100, 0]]), 1000);
  assert.equal(at.blend_at(1000), 1);
  at.add(snapshot({ tick: 2, simulated_s: 0.033 }, [[2, 200, 40], [3, 7, 7]]), 1050);
  assert.equal(at.blend_at(1050), 0);
  assert.equal(at.blend_at(1075), 0.5);
  assert.equal(at.blend_at(2000), 1);
  assert.deepEqual([at.x_at(0, 0.5), at.y_at(0, 0.5)], [150, 20]);
  assert.deepEqual([at.x_at(1, 0.5), at.y_at(1, 0.5)], [7, 7]); // new: at its place
  assert.ok(Math.abs(at.shown_s(0.5) - 0.0165) < 1e-12);
});

test("an interpolation lasts a quarter of a second at most", () => {
  const at = new render.Interpolator();
  at.add(snapshot(), 0);
  at.add(snapshot({ tick: 1 }), 60_000);
  assert.equal(at.blend_at(60_125), 0.5);
});

test("nothing is interpolated across runs, generations or jumps", () => {
  for (const change of [{ run_id: "s" }, { generation: 2 }, { island: 1 }, { world: "b" }, { tick: 4 }, { simulated_s: 2.1 }]) {
    const at = new render.Interpolator();
    at.add(snapshot({ tick: 5 }), 0);
    at.add(snapshot({ tick: 6, ...change }, [[0, 999, 0]]), 50);
    assert.equal(at.blend_at(60), 1, JSON.stringify(change));
    assert.equal(at.x_at(0, 1), 999);
  }
});

test("a paused world is drawn at its exact positions", () => {
  const at = new render.Interpolator();
  at.add(snapshot(), 0);
  at.add(snapshot({ tick: 1, state: "RUN_STATE_PAUSED" }, [[0, 17, 33]]), 50);
  assert.equal(at.blend_at(51), 1);
  assert.deepEqual([at.x_at(0, 1), at.y_at(0, 1)], [17, 33]);
});

test("a snapshot of the same tick replaces the latest", () => {
  const at = new render.Interpolator();
  at.add(snapshot(), 0);
  at.add(snapshot({ tick: 1 }, [[0, 100, 0]]), 50);
  at.add(snapshot({ tick: 1 }, [[0, 100, 0], [9, 5, 5]]), 60);
  assert.equal(at.previous.info.tick, 0);
  assert.equal(at.latest.count, 2);
  assert.equal(at.blend_at(75), 0.5); // of the interpolation that began at 50
});

test("a decoder may reuse the columns of a snapshot", () => {
  const at = new render.Interpolator(), reused = snapshot();
  at.add(reused, 0);
  reused.organisms.x[0] = 12345;
  assert.equal(at.x_at(0, 1), 16);
});

// ---- picking, labels -------------------------------------------------------------------------------------------

function pick(x, y, circles, pixel = 1) {
  return render.circle_at(x, y, circles.length, (i) => circles[i][0], (i) => circles[i][1], (i) => circles[i][2], pixel, 12);
}

test("predators are known as long as snapshots say so", () => {
  const at = new render.Interpolator();
  at.add(snapshot({ species: Uint8Array.of(0, 1) }, [[1, 0, 0], [2, 100, 0]]), 0);
  assert.deepEqual([at.latest.is_predator(0), at.latest.is_predator(1)], [false, true]);
  at.add(snapshot({ tick: 1 }, [[1, 0, 0], [2, 100, 0]]), 50);
  assert.deepEqual([at.latest.is_predator(1), at.previous.is_predator(1)], [false, true]);
});

test("small organisms have a target of 12 pixels", () => {
  assert.equal(pick(12, 0, [[0, 0, 2]]), 0);
  assert.equal(pick(12.1, 0, [[0, 0, 2]]), -1);
  assert.equal(pick(40, 0, [[0, 0, 2]], 4), 0); // zoomed out: 12 pixels are 48 px
});

test("large organisms are hit inside and 3 pixels around", () => {
  assert.equal(pick(33, 0, [[0, 0, 30]]), 0);
  assert.equal(pick(33.1, 0, [[0, 0, 30]]), -1);
});

test("of several organisms the nearest centre is hit", () => {
  assert.equal(pick(6, 0, [[0, 0, 10], [10, 0, 10]]), 1);
  assert.equal(pick(8, 0, [[0, 0, 2], [30, 0, 25]]), 1); // inside counts before near
});

test("the healthiest are ranked by health, then by id", () => {
  const at = new render.Interpolator();
  at.add(snapshot({}, [[1, 0, 0, 160, 50], [2, 0, 0, 160, 90], [5, 0, 0, 160, 90], [6, 0, 0, 160, 10], [7, 0, 0, 160, 60]]), 0);
  assert.deepEqual(render.healthiest(at.latest, 3).map((row) => at.latest.id[row]), [2, 5, 7]);
  assert.deepEqual(render.healthiest(at.latest, 9).length, 5);
});

test("shown health is rounded up, and 0 only for the dead", () => {
  assert.deepEqual([0, 1, 16, 17].map(render.shown_health), [0, 1, 1, 2]);
});

test("labels avoid walls and each other", () => {
  const label = (x, y) => ({ text: "1", x, y, radius: 5, width: 20, left: 0, top: 0 });
  const labels = [label(100, 100), label(105, 100), label(100, 8), label(3, 200)];
  render.place_labels(labels, 10, { left: 0, top: 0, width: 400, height: 400 });
  assert.deepEqual(labels.map(({ left, top }) => [left, top]), [[90, 84], [95, 106], [90, 14], [1, 184]]);
  const crowded = Array.from({ length: 6 }, () => label(100, 100)); // above, below, right, left, and no place for two
  assert.deepEqual(render.place_labels(crowded, 10, { left: 0, top: 0, width: 400, height: 400 }), crowded.slice(0, 4));
});

test("a reading is of one snapshot and ends with its generation", () => {
  const streamed = new render.StreamedIsland(), look = render.default_look("vivid", "dark");
  const read = (now_ms, info, health) => {
    const shown = snapshot({ state: "RUN_STATE_RUNNING", ...info }, [[0, 0, 0], [1, 0, 0]]);
    shown.organisms.health.set(health.map((one) => 16 * one));
    streamed.add(shown, now_ms, null, canvas, look);
    const { info: { tick }, healthiest } = streamed.read(shown.info, now_ms);
    return [tick, ...healthiest.map(({ id, health }) => `${id}: ${health}`)];
  };
  assert.deepEqual(read(0, { tick: 1 }, [5, 9]), [1, "1: 9", "0: 5"]);
  assert.deepEqual(read(100, { tick: 2 }, [7, 3]), [1, "1: 9", "0: 5"]); // too early for another one
  assert.deepEqual(read(500, { tick: 3 }, [7, 3]), [3, "0: 7", "1: 3"]);
  assert.deepEqual(read(510, { tick: 4, generation: 2 }, [1, 2]), [4, "1: 2", "0: 1"]);
  assert.deepEqual(read(520, { tick: 5, generation: 2, state: "RUN_STATE_PAUSED" }, [4, 2]), [5, "0: 4", "1: 2"]);
});

// ---- marks, density, traces ------------------------------------------------------------------------------------

test("items are thinned by their place alone", () => {
  const places = Array.from({ length: 20_000 }, (_, i) => [(i * 7919) % 3000 + 1 / 16, (i * 104729) % 2000]);
  const kept = (share) => places.filter(([x, y]) => render.is_kept(x, y, share)).map(String);
  const tenth = kept(0.1), half = new Set(kept(0.5));
  assert.ok(Math.abs(tenth.length / places.length - 0.1) < 0.01, `${tenth.length}`);
  assert.ok(tenth.every((place) => half.has(place)));
  assert.equal(kept(1).length, places.length);
});

test("a density counts each organism once", () => {
  const at = new render.Interpolator(), grid = new render.DensityGrid();
  at.add(snapshot({}, [[0, 0, 0], [1, 16 * 63, 16 * 10], [2, 16 * 64, 0], [3, 16 * 1999, 16 * 999]]), 0);
  assert.equal(render.density_cell_px(0.1), 64);
  render.count_organisms(grid, at, 1, { left: -500, top: -500, width: 4000, height: 3000 }, island, 0.1);
  assert.deepEqual([grid.columns, grid.rows, grid.counts[0], grid.counts[1], grid.counts[511]], [32, 16, 2, 1, 1]);
  assert.equal(grid.most(), 2);
});

test("tiles of densities are put together", () => {
  const grid = new render.DensityGrid();
  const tile = (left_px, width_px, organisms) => ({ left_px, top_px: 0, width_px, height_px: 100, cells: 2, organisms: Int32Array.from(organisms) });
  render.join_tiles(grid, [tile(0, 128, [1, 2, 3, 0]), tile(128, 72, [4, 0, 0, 5])], 128);
  assert.deepEqual([grid.cell_px, grid.columns, grid.rows], [64, 4, 2]);
  assert.deepEqual([...grid.counts.subarray(0, 8)], [1, 2, 4, 0, 3, 0, 0, 5]);
});

test("too many organisms become densities", () => {
  const info = { width_px: 2000, height_px: 1000 }, whole = render.fitted(canvas, island);
  assert.equal(render.too_many_for_dots(whole, canvas, info, 30_000), false);
  assert.equal(render.too_many_for_dots(whole, canvas, info, 30_001), true);
  assert.equal(render.too_many_for_dots({ x_px: 500, y_px: 500, zoom: 1 }, canvas, info, 60_000), false); // 18,000 are visible
});

test("scales end at round numbers", () => {
  assert.deepEqual([0, 1, 3, 11, 50, 51].map(render.nice_step), [1, 1, 5, 20, 50, 100]);
  assert.equal(render.health_scale_max(Int32Array.from([16 * 301]), 1), 400);
  assert.equal(render.health_scale_max(new Int32Array(0), 0), 100);
});

test("a family keeps its colour while it is among the largest", () => {
  const colours = new render.FamilyColours();
  colours.update(new render.Families(Uint32Array.from([3, 3, 8, 8, 8])));
  assert.deepEqual([colours.of(0), colours.of(1)], [render.lineages[0], render.lineages[1]]); // 8, then 3
  const later = new render.Families(Uint32Array.from([3, 3, 3, 8, 0xffffffff]));
  colours.update(later);
  assert.deepEqual([colours.of(later.of(0)), colours.of(later.of(3)), colours.of(later.of(4))], [render.lineages[1], render.lineages[0], render.unknown]);
  assert.deepEqual([later.count, later.size], [2, 4]);
});

test("trails keep three simulated seconds", () => {
  const trails = new render.Trails();
  for (let tick = 0; tick <= 600; tick += 3) {
    const { info, organisms } = snapshot({ tick, simulated_s: tick / 60 }, [[0, tick, 0]]);
    trails.add(info, organisms);
  }
  assert.equal(trails.segments.length, 12);
  assert.ok(Math.abs(trails.segments[0].from_s - 7) < 1e-9);
  assert.deepEqual([...trails.segments[11].lines.subarray(0, 4)], [585, 0, 600, 0]);
  trails.add(snapshot({ generation: 2 }).info, snapshot().organisms);
  assert.equal(trails.segments.length, 0);
});

test("trails are shorter at a high speed", () => {
  const share = (real_time_factor) => render.trail_share({ speed: { real_time_factor }, ticks_per_s: 0, simulated_s: 1, tick: 60 });
  assert.deepEqual([0.5, 1, 4, 16, 1000].map(share), [1, 1, 0.5, 0.25, 0.15]);
  assert.equal(render.trail_share({ speed: { max: true }, ticks_per_s: 240, simulated_s: 1, tick: 60 }), 0.5);
});

/** A renderer that draws into `scenes`. */
function renderer_of(scenes) {
  const painter = { measure: () => 10, draw: (scene) => scenes.push(scene), close() {} };
  const renderer = new render.Renderer({}, { painter: () => painter, fill() {}, close() {} });
  renderer.resize(100, 100, 1);
  return renderer;
}

test("large islands have traces where the camera is near", () => {
  const scenes = [], renderer = renderer_of(scenes), side = 100, count = side * side; // an organism every 10 px
  const food = (ids) => ({ id: Uint32Array.from(ids), x: Int32Array.from(ids, () => 8000), y: Int32Array.from(ids, () => 8000) });
  const show = (tick, info) => {
    const rows = Array.from({ length: count }, (_, i) => [i, 160 * (i % side) + 80 + tick, 160 * Math.floor(i / side) + 80]);
    renderer.add(snapshot({ tick, simulated_s: tick / 60, width_px: 1000, ...info, items: { food: food(tick < 30 ? [1, 2] : [2]) } }, rows), tick);
    renderer.draw(tick);
    const { trails, flashes } = scenes.at(-1);
    return { lines: trails.segments.reduce((sum, segment) => sum + segment.count, 0), flashes: flashes.length };
  };
  renderer.change({ camera: { x_px: 500, y_px: 500, zoom: 1 } });
  show(0); // the camera is limited to the island, whose size is not known before
  show(15);
  assert.deepEqual(show(30), { lines: 20 * 20, flashes: 1 }); // the region of 200 px around the visible 100 px
  renderer.change({ camera: { x_px: 500, y_px: 500, zoom: 0.1 } });
  assert.deepEqual(show(45), { lines: 0, flashes: 0 });
  renderer.change({ camera: { x_px: 500, y_px: 500, zoom: 1 } });
  show(60);
  assert.deepEqual(show(75, { tile_px: 512 }), { lines: 0, flashes: 0 }); // a view would not contain so many
});

test("meals and deaths flash where they happened", () => {
  const items = (rows) => ({ id: Uint32Array.from(rows, (row) => row[0]), x: Int32Array.from(rows, (row) => row[1]), y: Int32Array.from(rows, (row) => row[2]) });
  const before = new render.KeptSnapshot(), flashes = new render.Flashes(), everywhere = { left: 0, top: 0, width: 2000, height: 1000 };
  before.set(snapshot({ items: { food: items([[0, 160, 160], [1, 320, 320]]) } }, [[0, 16, 16], [4, 32, 48]]));
  flashes.add(before, snapshot({ tick: 1, simulated_s: 0.1, items: { food: items([[0, 160, 160], [1, 480, 320]]) } }, [[0, 16, 16]]), everywhere);
  assert.deepEqual(flashes.all.map(({ kind, x_px, y_px }) => [kind, x_px, y_px]), [["death", 2, 3], ["food", 20, 20]]);
});

test("the streamed region is kept during small movements", () => {
  const region = new render.StreamedRegion(), camera = { x_px: 1000, y_px: 500, zoom: 2 };
  assert.deepEqual(region.update(camera, canvas, "DETAIL_FULL", 0).region, { left_px: 500, top_px: 200, width_px: 1000, height_px: 600 });
  assert.equal(region.update({ ...camera, x_px: 1200 }, canvas, "DETAIL_FULL", 1000), null);
  assert.notEqual(region.update({ ...camera, x_px: 1300 }, canvas, "DETAIL_FULL", 1000), null);
  assert.equal(region.update({ ...camera, x_px: 100 }, canvas, "DETAIL_FULL", 1100), null); // at most every 200 ms
  assert.notEqual(region.update({ ...camera, x_px: 100 }, canvas, "DETAIL_DOTS", 1300), null);
});

test("a linked view shows the same part of its island", () => {
  const camera = { x_px: 500, y_px: 250, zoom: 2 };
  assert.deepEqual(render.same_part(camera, island, island, canvas), camera);
  const larger = { width: 2 * island.width, height: 2 * island.height };
  assert.deepEqual(render.same_part(camera, island, larger, canvas), { x_px: 1000, y_px: 500, zoom: 1 });
  const back = render.same_part(render.same_part(camera, island, larger, canvas), larger, island, canvas);
  assert.deepEqual(back, camera);
});

test("tiles are as large as the canvas allows", () => {
  const size = { width: 900, height: 600 };
  for (const count of [2, 3, 16, 64, 256]) {
    const places = render.tile_places(size, count, 1.6);
    assert.equal(places.length, count);
    for (const [i, { left, top, width, height }] of places.entries()) {
      assert.ok(left >= 0 && top >= 0 && left + width <= size.width && top + height <= size.height, `${count}: ${i}`);
      for (const other of places.slice(0, i)) { // no two overlap
        assert.ok(left >= other.left + other.width || other.left >= left + width || top >= other.top + other.height);
      }
    }
  }
  assert.deepEqual(render.tile_places(size, 2, 2).map(({ top }) => top), [6, 303]); // wide islands are below each other
  assert.deepEqual(render.tile_places(size, 2, 0.5).map(({ top }) => top), [6, 6]);
  assert.deepEqual([1, 16, 64].map((count) => render.tile_rate_hz(30, count)), [30, 30, 7.5]);
});

test("each tile draws its own island", () => {
  const scenes = [], renderer = renderer_of(scenes);
  const show = (island_index, info) => renderer.add(snapshot({ island: island_index, island_count: 4, ...info }, [[island_index, 160, 160]]), 0);
  const drawn = () => {
    scenes.length = 0;
    renderer.draw(0);
    return scenes.map(({ at, place }) => [at.latest.info?.island ?? null, place.left, place.is_tile]);
  };
  show(2);
  assert.deepEqual(drawn(), [[2, 0, false]]);
  renderer.change({ selected: 2, camera: { x_px: 5, y_px: 5, zoom: 8 } });
  renderer.show_islands(4, 2);
  for (const index of [0, 1, 3]) {
    show(index);
  }
  const lefts = drawn().map(([, left]) => left);
  assert.deepEqual(drawn().map(([index]) => index), [0, 1, 2, 3]);
  assert.equal(new Set(scenes.map(({ place }) => `${place.left} ${place.top}`)).size, 4);
  assert.deepEqual(scenes.map(({ selected }) => selected), [-1, -1, 0, -1]);
  assert.ok(lefts.every((left) => left > 0));
  renderer.choose(3);
  assert.equal(renderer.view.island.at.latest.info.island, 3);
  renderer.show_islands(0, 3);
  assert.deepEqual(drawn(), [[3, 0, false]]); // its snapshot stays
});
