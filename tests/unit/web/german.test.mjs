// The German texts of the page: each English one has a German one, numbers, events, refusals, and names of parameters.
import assert from "node:assert/strict";
import { readdirSync, readFileSync } from "node:fs";
import { test } from "node:test";
import { bundle, german_bundle } from "./bundle.mjs";

const root = new URL("../../../", import.meta.url);
const read = (file) => readFileSync(new URL(file, root), "utf8");
const folder = (name) => readdirSync(new URL(name, root)).sort();
const modules = folder("client/web/src/texts").map((file) => file.replace(".ts", ""));
const page = await german_bundle(
  "texts/numbers", "texts/states", "texts/refusals", "texts/registry", "texts/experiment", "world/event_text", "world/parameters",
  "world/parameter_values");

test("each module of texts has a German one", () => {
  const neutral = ["numbers"];
  assert.deepEqual(folder("client/web/src/texts_de").map((file) => file.replace(".ts", "")), modules.filter((name) => !neutral.includes(name)));
});

// The compiler compares the keys of each export.
for (const name of modules) {
  test(`the module ${name} exports the same in both languages`, async () => {
    const english = await bundle(`texts/${name}`), german = await german_bundle(`texts/${name}`);
    assert.deepEqual(Object.keys(german).sort(), Object.keys(english).sort());
  });
}

test("the page uses each key of its texts", async () => {
  const sources = readdirSync(new URL("client/web/src/", root), { recursive: true, withFileTypes: true });
  const all = sources.filter((file) => file.isFile()).map((file) => `${file.parentPath ?? file.path}/${file.name}`)
    .filter((file) => !file.includes("/texts_de/"));
  for (const name of modules) {
    const places = all.filter((file) => !file.endsWith(`/texts/${name}.ts`)).map((file) => readFileSync(file, "utf8")).join("\n");
    const own = read(`client/web/src/texts/${name}.ts`);
    for (const [exported, texts] of Object.entries(await bundle(`texts/${name}`))) {
      assert.ok(places.includes(exported) || own.split(exported).length > 2, `${name}: ${exported}`);
      for (const key of typeof texts === "object" && !Array.isArray(texts) ? Object.keys(texts) : []) {
        const used = new RegExp(`[.{,"\\s]${key.replace(/\W/g, "\\$&")}\\b`);
        assert.ok(key === "" || used.test(places) || own.includes(`.${key}`), `${name}: ${exported}.${key}`);
      }
    }
  }
});

test("German numbers have a decimal comma", () => {
  for (const [number, text] of [[0, "0"], [1234.5, "1.234,5"], [0.0123, "0,0123"], [-7, "−7"], [1e6, "1.000.000"], [-1e-9, "−1e-09"], [NaN, "–"]]) {
    assert.equal(page.shown_number(number), text);
  }
  assert.equal(page.with_separators((1n << 64n) - 1n), "18.446.744.073.709.551.615");
  assert.equal(page.fitness_text(-1234.56), "−1.234,6");
  assert.equal(page.tenths(1234.56), "1.234,6");
  assert.equal(page.rounded(0.15), "0,15");
  assert.equal(page.duration(12.34), "12,3 s");
});

test("fields accept a comma and a point", () => {
  const real = { kind: "PARAMETER_KIND_REAL" }, count = { kind: "PARAMETER_KIND_COUNT" };
  for (const [about, text, number] of [[real, "0,25", 0.25], [real, "0.25", 0.25], [count, "1.000", 1000], [count, "1,000", 1000], [count, "1.5", null]]) {
    assert.equal(page.typed_number(about, text), number, text);
  }
});

test("each template of an event has the same fields in German", () => {
  const fields = (text) => [...text.matchAll(/\{([\w.]+)/g), ...text.matchAll(/; ([\w.]+):/g)].map(([, field]) => field).sort();
  const english = JSON.parse(read("proto/texts/events.json")), german = JSON.parse(read("proto/texts/de/events.json"));
  for (const [name, template] of Object.entries(english)) {
    if (typeof template === "string") {
      assert.deepEqual(fields(german[name] ?? ""), fields(template), name);
    } else {
      assert.deepEqual(Object.keys(german[name] ?? {}), Object.keys(template), name);
    }
  }
  assert.deepEqual(Object.keys(JSON.parse(read("proto/texts/de/viewers.json"))), Object.keys(JSON.parse(read("proto/texts/viewers.json"))));
});

test("events are German sentences", () => { // except for reasons, which the server sends
  const texts = JSON.parse(read("proto/vectors/events.json")).map(({ event }) => page.event_text(event)[0]);
  for (const text of texts) {
    assert.doesNotMatch(text.replace(/lesson.evod is damaged|the disk is \w+/, ""), /undefined|[{}[\]]|\b(the|of|was|is|by)\b/, text);
  }
  assert.ok(texts.includes("Generation 1.234 ist zu Ende: beste Fitness 55,2, Mittelwert 20,8, am Leben 15 von 100, verhungert 1.000, vergiftet 7"));
  const changed = { parameters_changed: { by: { user: "anna" }, revision: 4, changed: [
    { name: "selection", value: { choice: "tournament" } }, { name: "respawn", value: { flag: false } }, { name: "mutation_chance", value: { real: 0.15 } }] } };
  assert.equal(page.event_text(changed)[0], "Anna hat geändert: Selektion auf Turnier, Nachwachsen auf aus, Mutationsrate auf 0,15, Revision 4");
});

test("a refusal is a German sentence", () => {
  assert.equal(page.refusal_text({ reason: "REASON_RUN_ENDED", message: "the run has ended" }), "Der Lauf ist zu Ende; Zurücksetzen der Welt beginnt ihn neu");
  const violations = [{ field: "set_parameters.mutation_chance", got: "1.5", allowed: "0 to 1" }, { field: "set_parameters.food_count", got: "x", allowed: "a whole number, 0 to 20000000" }];
  assert.equal(page.refusal_text({ reason: "REASON_FIELD_INVALID", violations }),
               "Mutationsrate: 1,5 ist nicht möglich, erlaubt: 0 bis 1; Futtermenge: x ist nicht möglich, erlaubt: eine ganze Zahl, 0 bis 20000000");
  assert.equal(page.refusal_text({ reason: "REASON_NEW", message: "something new" }), "Something new");
});

test("what a refusal allows is German if it is a range", () => {
  for (const [english, german] of [["0.01 to 1e+06", "0,01 bis 1e+06"], ["at least impulse_min (30)", "mindestens 30 (Impuls, kleinster Wert)"],
                                   ["true or false", "ein oder aus"], ["roulette, tournament", "Glücksrad, Turnier"], ["something new", "something new"]]) {
    assert.equal(page.allowed_words(english), german);
  }
});

/** The rows of the tables of docs/PARAMETERS.md, which `evod parameters` prints, without code marks. */
const rows = read("docs/PARAMETERS.md").split("\n").filter((line) => line.startsWith("| `"))
  .map((line) => line.split("|").slice(1, -1).map((cell) => cell.trim().replaceAll("`", "")));
const parameters = rows.filter((row) => row.length === 6), choices = rows.filter((row) => row.length === 3);

test("each parameter has a German name and help", () => {
  const names = parameters.map(([name]) => name).sort();
  assert.ok(names.length > 100);
  assert.deepEqual(Object.keys(page.parameter_labels).sort(), names);
  assert.deepEqual(Object.keys(page.parameter_helps).sort(), names);
  assert.equal(new Set(Object.values(page.parameter_labels)).size, names.length);
});

test("each unit, topic and choice of parameters is German", () => {
  const units = new Set(parameters.map(([, , , unit]) => unit).filter((unit) => unit !== ""));
  assert.deepEqual(Object.keys(page.unit_words).sort(), [...units].sort());
  const topics = [...read("docs/PARAMETERS.md").matchAll(/^## (.*)$/gm)].map(([, topic]) => topic.toLowerCase().replaceAll(" ", "_"));
  assert.deepEqual(Object.keys(page.topic_titles).sort(), topics.filter((topic) => topic !== "choices").sort());
  assert.deepEqual(Object.keys(page.choice_labels).sort(), [...new Set(choices.map(([, choice]) => choice))].sort());
  assert.deepEqual(Object.keys(page.choice_helps).sort(), choices.map(([name, choice]) => `${name} ${choice}`).sort());
});

test("units have a singular", () => {
  const about = { kind: "PARAMETER_KIND_COUNT", unit: "Organismen" };
  assert.equal(page.unit_text(about, 1), "Organismus");
  assert.equal(page.unit_text(about, 2), "Organismen");
});

test("the summary of a world is German", () => {
  const set = { summary: "50 organisms seek food.", parameters: [
    { name: "fitness", value: { choice: "life" } }, { name: "population_size", value: { count: 50 } }, { name: "food_health", value: { real: 25 } },
    { name: "poison_count", value: { count: 40 } }, { name: "poison_harm", value: { real: 40.5 } }, { name: "health_loss_per_s", value: { real: 6 } },
    { name: "fitness_per_second", value: { real: 1 } }, { name: "fitness_per_poison", value: { real: -2 } }, { name: "island_count", value: { count: 1 } },
    { name: "selection", value: { choice: "roulette" } }], schedule: [{ name: "food_count", generation: 5 }, { name: "food_count", generation: 9 }] };
  assert.equal(page.experiment_text(set),
               "50 Organismen suchen Futter (+25 Gesundheit) und meiden Gift (−40,5). Jeder verliert 6 Gesundheit pro Sekunde und stirbt bei 0. " +
               "Die Fitness ist die gelebte Zeit minus 2 × das gefressene Gift. Im Mittel haben fittere Organismen mehr Nachkommen. " +
               "Parameter ändern sich in Generation 5 und 9.");
});

test("the summary of a colony is German", () => {
  const value = { reproduction: { choice: "births" }, births: { choice: "sexual" }, fitness: { choice: "life" }, birth_health: { real: 120 }, predator_count: { count: 20 },
                  predator_from: { count: 10 }, health_loss_per_s: { real: 6 } };
  const set = { summary: "…", parameters: Object.entries(value).map(([name, value]) => ({ name, value })) };
  const text = page.experiment_text(set);
  assert.match(text, /stirbt bei 0\. Ab Intervall 10 jagen sie 20 Räuber\. Die Fitness ist die Zahl der Kinder\. /);
  assert.match(text, /Es gibt keine Generationen: zwei Organismen mit mindestens 120 Gesundheit bekommen ein Kind und bezahlen es mit Gesundheit\.$/);
});
