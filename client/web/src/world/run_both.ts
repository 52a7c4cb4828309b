// run_both: runs or pauses two worlds next to each other with one command. Roles and leases hold for each of them.
import {both_texts as texts} from "../texts/both";
import {common_texts} from "../texts/common";
import {key_texts} from "../texts/keys";

import type {PanelContext} from "./panel_context";
import type {ViewedWorld} from "./world";

/** What the button does now. */
export interface BothState {
  is_pause: boolean;
  /** Why neither world can be run or paused, as a sentence; empty if one can. */
  why_not: string;
}

/** null: only one world is shown. */
export function both_state(context: PanelContext): BothState|null {
  const worlds = both(context);
  if (worlds.length < 2) {
    return null;
  }
  const is_pause = worlds.some(runs), reasons = concerned(worlds, is_pause).map(why_not);
  return {is_pause, why_not: reasons.every((why) => why !== "") ? reasons[0] ?? "" : ""};
}

/** Pauses both worlds if one runs, else runs both. Says which of them could not. */
export async function run_or_pause_both(context: PanelContext): Promise<void> {
  const worlds = both(context), is_pause = worlds.some(runs);
  const refused = await Promise.all(concerned(worlds, is_pause).map(async (world) => {
    const why = why_not(world);
    if (why !== "") {
      return texts.refused(title_of(world), why);
    }
    try {
      await world.control.pause_or_resume();
      return "";
    } catch (error) {
      return texts.refused(title_of(world), error instanceof Error ? error.message : String(error));
    }
  }));
  refused.filter((text) => text !== "").forEach((text) => context.notify(text));
}

/** Why a world can be neither run nor paused now, as a sentence; empty if it can. */
export function why_not(world: ViewedWorld): string {
  return !world.shown ? common_texts.no_world :
                        world.server.access.why_not("pause", world.shown) ||
      (!world.control.is_over ? "" :
         world.is_replay      ? key_texts.end_of_replay :
                                key_texts.run_has_ended);
}

export function runs(world: ViewedWorld): boolean {
  return world.control.state === "RUN_STATE_RUNNING";
}

function both(context: PanelContext): ViewedWorld[] {
  const other = context.other();
  return other === null ? [context.world()] : [context.world(), other];
}

function concerned(worlds: readonly ViewedWorld[], is_pause: boolean): ViewedWorld[] {
  return worlds.filter((world) => runs(world) === is_pause);
}

function title_of(world: ViewedWorld): string {
  return world.past.is_own_replay ? texts.replay_of(world.name) : world.name;
}
