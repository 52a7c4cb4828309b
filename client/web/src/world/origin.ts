// Origin: where the generations before a fork are: in the run of which the shown world is a fork. The server has them
// only in the world with that run.
import {origin_texts} from "../texts/origin";

import {Refusal} from "./server";

import type {Server} from "./server";

/** The id of the run of which a world is a fork, if a request was refused because that run has what was asked for. */
export function origin_run_of(error: unknown): string {
  const violations = error instanceof Refusal ? error.violations : [];
  return violations.find(({field, allowed}) => field.endsWith(".world") && /^[0-9a-f]{32}$/.test(allowed))?.allowed ??
    "";
}

/** Name of the live world with this run; empty: the server has none. */
export function world_with_run(server: Server, run_id: string): string {
  return server.worlds.all.find((world) => !world.replay && world.run_id === run_id)?.name ?? "";
}

/** A sentence about a generation that bred before a fork began. world: of its origin; empty: the server has none. */
export function origin_text(world: string, generation: number): string {
  return world === "" ? origin_texts.no_world(generation) : origin_texts.bred_in(generation, world);
}
