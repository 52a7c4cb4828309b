// PaneView: which part of its island a pane shows. It posts the camera to the worker, which draws.
import type {Camera} from "../core/messages";
import {
  clamped,
  contains,
  fitted,
  is_whole_island_visible,
  minimap_place,
  panned,
  type Point,
  same_part,
  type Size,
  zoom_to_fit,
  zoomed
} from "../render/camera";
import type {ViewedWorld} from "../world/world";

const follow_zoom = 3; // the least zoom at which an organism is followed; 1 shows the whole island

export class PaneView {
  /** What is shown; null: the whole island. */
  camera: Camera|null = null;
  size: Size = {width: 1, height: 1}; // of the canvas, in CSS pixels
  island: Size|null = null; // null before the first snapshot
  /** All islands are shown, each as a whole. */
  shows_all = false;

  /** What was shown before an organism was followed; null: none is followed. */
  #before_follow: {camera: Camera|null}|null = null;
  readonly #world: ViewedWorld;
  readonly #on_move: (view: PaneView) => void;

  /** on_move: called after the user or a followed organism has moved the view. */
  constructor(world: ViewedWorld, on_move: (view: PaneView) => void) {
    this.#world = world;
    this.#on_move = on_move;
  }

  /** The camera that is shown; null before the first snapshot. */
  shown(): Camera|null {
    const {camera, size, island} = this;
    return island === null ? null : camera === null ? fitted(size, island) : clamped(camera, size, island);
  }

  /** Shows this part without moving a linked view. */
  set(camera: Camera|null): void {
    this.camera = camera;
    this.#world.server.post({kind: "camera", pane: this.#world.feed.pane, camera});
  }

  /** Shows the whole island. */
  fit(): void {
    if (!this.shows_all) {
      this.#leave_followed();
      this.#move(null);
    }
  }

  /** Moves the drawn island by this many pixels. */
  pan(by: Point): void {
    const shown = this.shown();
    if (shown !== null && !this.shows_all && (by.x !== 0 || by.y !== 0)) {
      this.#leave_followed();
      this.#move(panned(shown, this.size, this.island!, by));
    }
  }

  /** Multiplies the zoom; the point of the island at `at` stays. */
  zoom_at(at: Point, factor: number): void {
    const shown = this.shown();
    if (shown !== null && !this.shows_all) {
      this.#move(zoomed(shown, this.size, this.island!, at, factor));
    }
  }

  /** Multiplies the zoom; the middle stays. */
  zoom_by(factor: number): void {
    this.zoom_at({x: this.size.width / 2, y: this.size.height / 2}, factor);
  }

  look_at_minimap(at: Point): void {
    const shown = this.shown();
    if (shown !== null) {
      const {screen, zoom} = minimap_place(this.size, this.island!);
      this.#leave_followed();
      const there = {...shown, x_px: (at.x - screen.left) / zoom, y_px: (at.y - screen.top) / zoom};
      this.#move(panned(there, this.size, this.island!, {x: 0, y: 0}));
    }
  }

  is_on_minimap(at: Point): boolean {
    const shown = this.shown();
    return shown !== null && !this.shows_all && this.#world.look.minimap &&
      !is_whole_island_visible(shown, this.size, this.island!) &&
      contains(minimap_place(this.size, this.island!).screen, at);
  }

  /** Call it after the selection has changed. A view that begins to follow an organism shows it near enough to see it
   *  move. When the user ends that, the view shows what it showed before; when the organism is gone, the whole island.
   */
  follow_selection(): void {
    const {follow, at, is_lost} = this.#world.selection, before = this.#before_follow, shown = this.shown();
    if (follow && before === null && shown !== null) {
      this.#before_follow = {camera: this.camera};
      const zoom = Math.max(shown.zoom, follow_zoom * zoom_to_fit(this.size, this.island!));
      this.#move(clamped({...shown, ...(at && {x_px: at.x_px, y_px: at.y_px}), zoom}, this.size, this.island!));
    } else if (!follow && before !== null) {
      this.#before_follow = null;
      this.#move(is_lost ? null : before.camera);
    }
  }

  /** The worker has moved the view with a followed organism. */
  followed(camera: Camera): void {
    if (this.#before_follow === null) { // the worker was faster than the refresh of the pane
      this.follow_selection();
      return;
    }
    this.camera = camera;
    this.#on_move(this);
  }

  /** Shows the part of this island that `other` shows of its island. A view that follows an organism takes only the
   *  zoom. */
  show_same_part(other: PaneView): void {
    if (this.island === null || other.island === null) {
      return;
    }
    const wanted = other.camera && same_part(other.shown()!, other.island, this.island, this.size);
    const own = this.shown();
    if (!this.#world.selection.follow) {
      this.set(wanted);
    } else if (own !== null) {
      this.set({...own, zoom: (wanted ?? fitted(this.size, this.island)).zoom});
    }
  }

  /** A view that the user moves follows no organism, and stays where the user leaves it. */
  #leave_followed(): void {
    this.#before_follow = null;
    if (this.#world.selection.follow) {
      this.#world.selection.set_follow(false);
    }
  }

  #move(camera: Camera|null): void {
    this.set(camera);
    this.#on_move(this);
  }
}
