// Seeker: shows moments of the past one after the other. While a seek runs, only the newest moment that the user asks
// for is kept.
import type {Moment} from "../world/time_scale";
import type {ViewedWorld} from "../world/world";

export class Seeker {
  #waiting: Moment|null = null;
  #is_seeking = false;
  readonly #world: ViewedWorld;
  readonly #attempt: (what: () => Promise<unknown>) => Promise<boolean>;
  readonly #on_end: () => void;

  /** attempt: shows the sentence of a refusal; on_end: called when no seek runs any more. */
  constructor(world: ViewedWorld, attempt: Seeker["attempt"], on_end: () => void) {
    this.#world = world;
    this.#attempt = attempt;
    this.#on_end = on_end;
  }

  get is_seeking(): boolean {
    return this.#is_seeking;
  }

  /** Runs a request of the user. Returns whether it succeeded. */
  attempt(what: () => Promise<unknown>): Promise<boolean> {
    return this.#attempt(what);
  }

  /** Shows a moment, after the running seek if there is one. */
  go(moment: Moment): void {
    this.#waiting = moment;
    if (!this.#is_seeking) {
      void this.#seek();
    }
  }

  go_to_first(): void {
    const {range} = this.#world.past;
    if (range) {
      this.go({generation: range.first_generation});
    }
  }

  async #seek(): Promise<void> {
    this.#is_seeking = true;
    while (this.#waiting) {
      const moment = this.#waiting;
      this.#waiting = null;
      if (!(await this.#attempt(() => this.#world.past.show_nearest(moment)))) {
        this.#waiting = null;
      }
    }
    this.#is_seeking = false;
    this.#on_end();
  }
}
