// LinkedViews: whether two worlds next to each other move and zoom together. Until the user decides, they do if their
// islands have the same size. Of islands with different sizes, both views show the same part.
import type {Camera} from "../core/messages";
import type {PaneView} from "./pane_view";

export class LinkedViews {
  #choice: boolean|null = null; // of the user
  /** What the other view showed before the user linked both; null: both have moved since. */
  #before: {view: PaneView; camera: Camera | null}|null = null;
  readonly #views: () => readonly PaneView[];

  /** views: of the shown panes. */
  constructor(views: () => readonly PaneView[]) {
    this.#views = views;
  }

  get is_on(): boolean {
    const [one, other] = this.#views();
    return one !== undefined && other !== undefined && (this.#choice ?? have_same_size(one, other));
  }

  /** Links the views, and shows in the other one what `leader` shows; or unlinks them. If no view has moved since they
   *  were linked, the other one shows again what it showed before. */
  toggle(leader: PaneView): void {
    const before = this.#before, other = this.#views().find((view) => view !== leader);
    this.#choice = !this.is_on;
    const camera = other?.camera ?? null;
    this.moved(leader);
    if (!this.#choice) {
      before?.view.set(before.camera);
    } else if (other) {
      this.#before = {view: other, camera};
    }
  }

  /** Moves the other view after `leader` has moved. */
  moved(leader: PaneView): void {
    this.#before = null;
    if (this.is_on) {
      this.#views().filter((view) => view !== leader).forEach((view) => view.show_same_part(leader));
    }
  }

  /** Forgets the choice, because only one world is shown. */
  forget(): void {
    this.#choice = this.#before = null;
  }
}

function have_same_size({island: one}: PaneView, {island: other}: PaneView): boolean {
  return one !== null && other !== null && one.width === other.width && one.height === other.height;
}
