// The view of a pane: which part of its island it shows after any actions of the user, and what it shows again after an
// organism was followed.
import assert from "node:assert/strict";
import { test } from "node:test";
import { bundle } from "./bundle.mjs";

const { LinkedViews, PaneView, pane_frame, visible_part } = await bundle("page/pane_view", "page/linked_views", "render/camera");

/** Numbers from 0 to 1, the same ones for each seed. */
function random(seed) {
  let state = seed;
  return () => (state = (state * 1103515245 + 12345) % 2 ** 31) / 2 ** 31;
}

function new_view(moved = () => undefined) {
  const selection = {
    id: null, follow: false, at: null, is_lost: false,
    set_follow(follow) {
      this.follow = follow && this.id !== null;
      this.is_lost = false;
    },
    lose() {
      this.is_lost ||= this.follow;
      this.follow = false;
      this.id = null;
    },
  };
  const posted = [], world = { selection, look: { minimap: true }, feed: { pane: 0 }, server: { post: (message) => posted.push(message) } };
  const view = new PaneView(world, moved);
  view.size = { width: 800, height: 500 };
  view.island = { width: 1600, height: 900 };
  return { view, selection, posted };
}

/** What is wrong with the visible part along one side: empty if it is within the island and what surrounds it. */
function wrong_side(from, length, size, around) {
  const slack = 1e-6 * Math.max(size, length);
  return length >= size + 2 * around - slack ? Math.abs(from + length / 2 - size / 2) > slack
    : from < -around - slack || from + length > size + around + slack;
}

function assert_on_island(view, what) {
  const camera = view.shown(), { left, top, width, height } = visible_part(camera, view.size);
  const around = (pane_frame.walls + pane_frame.margin) / camera.zoom, { island } = view;
  assert.ok(!wrong_side(left, width, island.width, around) && !wrong_side(top, height, island.height, around),
            `${what}: shows ${JSON.stringify({ left, top, width, height })} of ${JSON.stringify(island)}`);
}

/** What users, organisms and the window do to a view. `at`: any point of the canvas, also outside of it. */
const actions = {
  drag: ({ view }, draw) => view.pan({ x: (draw() - 0.5) * 3000, y: (draw() - 0.5) * 3000 }),
  wheel: ({ view }, draw) => view.zoom_at({ x: draw() * view.size.width, y: draw() * view.size.height }, 8 ** (draw() * 2 - 1)),
  key_zoom: ({ view }, draw) => view.zoom_by(draw() < 0.5 ? 1.25 : 0.8),
  fit: ({ view }) => view.fit(),
  minimap: ({ view }, draw) => view.look_at_minimap({ x: draw() * view.size.width, y: draw() * view.size.height }),
  resize: ({ view }, draw) => (view.size = { width: 60 + draw() * 2000, height: 60 + draw() * 1200 }),
  island: ({ view }, draw) => (view.island = { width: 100 + draw() * 9000, height: 100 + draw() * 9000 }),
  follow: ({ view, selection }, draw) => {
    selection.id = 7;
    selection.at = { x_px: draw() * view.island.width, y_px: draw() * view.island.height, health: 1 };
    selection.set_follow(true);
  },
  moved_organism: ({ view, selection }, draw) =>
    selection.follow && view.followed({ ...view.shown(), x_px: draw() * view.island.width, y_px: draw() * view.island.height }),
  end_follow: ({ selection }) => selection.set_follow(false),
  lose: ({ selection }) => selection.lose(),
  link: ({ view }, draw) => {
    const other = new_view().view;
    other.island = { width: 100 + draw() * 3000, height: 100 + draw() * 3000 };
    other.zoom_at({ x: draw() * 800, y: draw() * 500 }, 1 + draw() * 9);
    view.show_same_part(other);
  },
};

test("no actions move the view off the island", () => {
  for (let seed = 1; seed <= 200; ++seed) {
    const draw = random(seed), of = new_view(), names = Object.keys(actions), done = [];
    for (let i = 0; i < 40; ++i) {
      const name = names[Math.floor(draw() * names.length)];
      done.push(name);
      actions[name](of, draw);
      of.view.follow_selection();
      assert_on_island(of.view, `seed ${seed}, ${done.slice(-6).join(", ")}`);
    }
  }
});

function follow(of) {
  of.selection.id = 7;
  of.selection.at = { x_px: 5, y_px: 895, health: 1 }; // in a corner
  of.selection.set_follow(true);
  of.view.follow_selection();
}

test("a followed organism is shown near enough", () => {
  const of = new_view(), whole = of.view.shown();
  follow(of);
  assert.ok(of.view.shown().zoom >= 3 * whole.zoom);
  assert_on_island(of.view, "at a corner");
});

test("the end of following restores the view", () => {
  for (const zoom of [1, 2, 9]) {
    const of = new_view();
    of.view.zoom_by(zoom);
    const before = of.view.camera;
    follow(of);
    of.view.zoom_by(2);
    of.selection.set_follow(false);
    of.view.follow_selection();
    assert.deepEqual(of.view.camera, before);
    assert.deepEqual(of.posted.at(-1), { kind: "camera", pane: 0, camera: before });
  }
});

test("a fast worker does not replace the view to restore", () => {
  const of = new_view();
  of.view.zoom_by(2);
  const before = of.view.camera;
  of.selection.id = 7;
  of.selection.set_follow(true);
  of.view.followed({ ...of.view.shown(), x_px: 1 }); // before the pane has refreshed
  of.view.follow_selection();
  of.selection.set_follow(false);
  of.view.follow_selection();
  assert.deepEqual(of.view.camera, before);
});

test("a lost organism leaves the whole island", () => {
  const of = new_view();
  of.view.zoom_by(4);
  follow(of);
  of.selection.lose();
  of.view.follow_selection();
  assert.equal(of.view.camera, null);
});

test("a view that the user moves stays there", () => {
  for (const move of [(view) => view.pan({ x: 40, y: 0 }), (view) => view.look_at_minimap({ x: 700, y: 420 }), (view) => view.fit()]) {
    const of = new_view();
    follow(of);
    move(of.view);
    assert.equal(of.selection.follow, false);
    const { camera } = of.view;
    of.view.follow_selection();
    assert.deepEqual(of.view.camera, camera);
  }
});

test("linking twice restores the other view, unless a view moves", () => {
  const views = [], linked = new LinkedViews(() => views);
  views.push(new_view((view) => linked.moved(view)).view, new_view((view) => linked.moved(view)).view);
  const [leader, other] = views;
  linked.toggle(leader); // they have the same size, so they were linked
  leader.zoom_by(4);
  other.zoom_by(2);
  const before = other.camera;
  linked.toggle(leader);
  assert.deepEqual(other.camera, leader.camera);
  linked.toggle(leader);
  assert.deepEqual(other.camera, before);

  linked.toggle(leader);
  leader.pan({ x: 30, y: 0 });
  linked.toggle(leader);
  assert.deepEqual(other.camera, leader.camera);
});
