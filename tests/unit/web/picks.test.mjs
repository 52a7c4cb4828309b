// What is at a point of a pane: a click before the first frame waits for it.
import assert from "node:assert/strict";
import { test } from "node:test";
import { bundle } from "./bundle.mjs";

globalThis.location = { hostname: "localhost" };
const { IslandView, WorkerPane, default_settings } = await bundle("worker/pane", "render/island_view");

test("a click before the canvas has arrived is not answered yet", () => {
  const posted = [], pane = new WorkerPane(0, {}, (message) => posted.push(message));
  pane.take({ kind: "pick", pane: 0, id: 1, x: 10, y: 10, radius: 12 });
  assert.deepEqual(posted, []);
});

test("a view is drawn when a frame has shown the island where it is now", () => {
  const place = { x: 0, y: 0, width: 100, height: 100, frame: { left: 0, top: 0, right: 0, bottom: 0 }, is_tile: false };
  const view = new IslandView(default_settings(place), { draw: () => undefined });
  view.draw(0); // an empty one: no snapshot has arrived
  assert.equal(view.is_drawn, false);
});
