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

/** Places everything or, if the server refuses, nothing. Undo removes what is left of it; redo places it again. */
export async function place(world: ViewedWorld, what: Omit<Place, "world"|"island">): Promise<void> {
  const {server, shown, island} = world, run_id = world.info?.run_id;
  const send = (): Promise<Placed> => server.request("place", {world: shown, island, ...what});
  let placed = await send();
  const count = (kind: Kind): number => placed[kind]?.length ?? 0;
  const is_same_run = (): boolean => world.shown === shown && world.info?.run_id === run_id;
  world.undo.add({
    name: undo_texts.placed(count("food"), count("poison"), count("organisms")),
    // Everything that was placed ends with its generation.
    can_undo: () => is_same_run() && (world.snapshot?.generation ?? 0) <= (placed.generation ?? 0),
    can_redo: is_same_run,
    undo: () => remove_what_is_left(world, shown, island, placed),
    redo: async () => {
      placed = await send();
      return true;
    },
  });
}

/** Returns whether anything was removed. Each thing has its own request, because a request with one invalid id is
 *  refused as a whole. */
async function remove_what_is_left(world: ViewedWorld, name: string, island: number, placed: Placed): Promise<boolean> {
  const {generation} = placed, removals = kinds.flatMap((kind) => (placed[kind] ?? []).map((id) => ({[kind]: [id]})));
  const results = await Promise.allSettled(
    removals.map((removal) => world.server.request("remove", {world: name, island, generation, ...removal})));
  for (const result of results) {
    if (result.status === "rejected" && !(result.reason instanceof Refusal && gone.has(result.reason.reason))) {
      throw result.reason;
    }
  }
  return results.some(({status}) => status === "fulfilled");
}
