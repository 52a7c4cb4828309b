// place: places items and organisms in the shown island, so that the user can undo it.
import type {Place, Placed} from "../core/protocol";
import {undo_texts} from "../texts/undo";

import {Refusal} from "./server";
import type {ViewedWorld} from "./world";

/** The refusals after which nothing of what was placed can be removed any more: it was eaten or removed, or its
 *  generation has ended. */
const gone: ReadonlySet<string> = new Set([
  "REASON_FIELD_INVALID", "REASON_GENERATION_CHANGED", "REASON_GENERATION_OVER", "REASON_ORGANISM_NOT_FOUND",
  "REASON_ISLAND_NOT_FOUND"
]);

type Kind = "food"|"poison"|"organisms";
const kinds: readonly Kind[] = ["food", "poison", "organisms"];

type What = Omit<Place, "world"|"island">;

/** Places everything or, if the server refuses, nothing. Undo removes what is left of it; redo places it again. */
export async function place(world: ViewedWorld, what: What): Promise<void> {
  const placing = new Placing(world);
  await placing.place(what);
  placing.end();
}

/** Several requests that place something, and that undo and redo treat as one change. */
export class Placing {
  #placed: {what: What; answer: Placed}[] = [];
  readonly #world: ViewedWorld;
  readonly #shown: string;
  readonly #island: number;
  readonly #run_id: string|undefined;

  constructor(world: ViewedWorld) {
    this.#world = world;
    this.#shown = world.shown;
    this.#island = world.island;
    this.#run_id = world.snapshot?.run_id;
  }

  /** Places everything or, if the server refuses, nothing. */
  async place(what: What): Promise<void> {
    const answer = await this.#world.server.request("place", {world: this.#shown, island: this.#island, ...what});
    this.#placed.push({what, answer});
  }

  /** Adds what was placed to the changes that can be undone. Undo removes what is left of it; redo places it again. */
  end(): void {
    if (this.#placed.length === 0) {
      return;
    }
    const world = this.#world,
          is_same_run = (): boolean => world.shown === this.#shown && world.snapshot?.run_id === this.#run_id;
    const count = (kind: Kind): number => this.#placed.reduce((sum, {answer}) => sum + (answer[kind]?.length ?? 0), 0);
    world.undo.add({
      name: undo_texts.placed(count("food"), count("poison"), count("organisms")),
      // Everything that was placed ends with its generation.
      can_undo: () => is_same_run() && (world.snapshot?.generation ?? 0) <= this.#generation(),
      can_redo: is_same_run,
      undo: () => this.#remove_what_is_left(),
      redo: () => this.#place_again(),
    });
  }

  #generation(): number {
    return Math.max(...this.#placed.map(({answer}) => answer.generation ?? 0));
  }

  /** Returns whether anything was removed. Each thing has its own request, because a request with one invalid id is
   *  refused as a whole. */
  async #remove_what_is_left(): Promise<boolean> {
    const removals = this.#placed.flatMap(
      ({answer}) =>
        kinds.flatMap((kind) => (answer[kind] ?? []).map((id) => ({generation: answer.generation, [kind]: [id]}))));
    const results = await Promise.allSettled(removals.map(
      (removal) => this.#world.server.request("remove", {world: this.#shown, island: this.#island, ...removal})));
    for (const result of results) {
      if (result.status === "rejected" && !(result.reason instanceof Refusal && gone.has(result.reason.reason))) {
        throw result.reason;
      }
    }
    return results.some(({status}) => status === "fulfilled");
  }

  /** Places again what has room now. Rejects if nothing has. */
  async #place_again(): Promise<boolean> {
    const before = this.#placed;
    this.#placed = [];
    let problem: unknown = null;
    for (const {what} of before) {
      await this.place(what).catch((error: unknown) => (problem = error));
    }
    if (this.#placed.length === 0) {
      this.#placed = before;
      throw problem;
    }
    return true;
  }
}
