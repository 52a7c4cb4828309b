// texts: sentences about worlds, in the words of the other programs of evod.
import texts from "../../../../proto/texts/events.json";

import {duration, shown_number, with_separators} from "./numbers";

import type {Message} from "../core/messages";
import type {SnapshotInfo} from "../core/snapshot";

export function capitalised(text: string): string {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

/** "fork_world.name" → "name". */
function last_field_name(field: string): string {
  return field.slice(field.lastIndexOf(".") + 1);
}

/** The message of a Status on one line, with the names of fields in place of their paths. */
export function refusal_text(status: Message): string {
  const violations: Message[] = status.violations ?? [];
  return capitalised(
    violations
      .reduce(
        (text: string, {field = ""}) => text.replace(`${field}: `, `${last_field_name(field)}: `), status.message ?? "")
      .replace("\n  ", ": ")
      .replaceAll("\n  ", "; "));
}

/** "2×", "1/8×", "max". */
export function speed_text(speed: Message|undefined): string {
  if (speed?.max) {
    return "max";
  }
  const factor: number = speed?.real_time_factor ?? 0;
  const inverse = factor > 0 ? 1 / factor : 0;
  return factor > 0 && factor < 1 && Number.isInteger(inverse) ? `1/${inverse}×` : `${shown_number(factor)}×`;
}

/** Why commands are refused or worlds wait; empty if the server can write its runs. */
export function storage_text(storage: Message|null|undefined): string {
  return capitalised(storage?.text ?? "");
}

export function state_word(state: string, storage?: Message|null, awaits_fitness = false): string {
  switch (state) {
    case "RUN_STATE_WAITING":
      return "waiting";
    case "RUN_STATE_RUNNING":
      return storage?.state === "STORAGE_STATE_STALLED" || storage?.state === "STORAGE_STATE_BEHIND" ?
        "waits for the disk" :
        awaits_fitness ? "waits for fitness" :
                         "running";
    case "RUN_STATE_PAUSED":
      return "paused";
    case "RUN_STATE_TERMINATED":
      return "ended";
    default:
      return "…";
  }
}

export function outcome_words(outcome: string|undefined): string {
  return (texts.outcome as {[outcome: string]: string})[outcome ?? ""] ?? "ended by a criterion";
}

/** "default · island 1 of 0–3 · 2× (120 ticks/s)". */
export function place_and_speed_text(
  name: string, snapshot: SnapshotInfo, speed: Message|undefined, running: boolean): string {
  return name + (snapshot.island_count > 1 ? ` · island ${snapshot.island} of 0–${snapshot.island_count - 1}` : "") +
    ` · ${speed_text(speed)}` +
    (running && snapshot.ticks_per_s > 0 ? ` (${with_separators(snapshot.ticks_per_s)} ticks/s)` : "");
}

/** "alive 50 of 50", "mean health 131.3", … */
export function statistics_texts(snapshot: SnapshotInfo): string[] {
  const live = snapshot.live;
  return [
    ...(
      live ?
        [
          `alive ${with_separators(live.alive_count ?? 0)} of ${with_separators(live.organism_count ?? 0)}`,
          `mean health ${(live.health_mean ?? 0).toFixed(1)}`,
          `food eaten ${with_separators(live.food_eaten ?? 0)}`,
          `poison eaten ${with_separators(live.poison_eaten ?? 0)}`,
        ] :
        []),
    `tick ${with_separators(snapshot.tick)} (${duration(snapshot.simulated_s)})`,
  ];
}

/** "anna: evoview 127.0.0.1:51234": who changed something. */
export function actor_text(by: Message|undefined): string {
  switch (by?.kind) {
    case "ACTOR_KIND_SCHEDULE":
      return "the schedule";
    case "ACTOR_KIND_GOAL":
      return "a goal";
    case "ACTOR_KIND_SERVER":
      return "evod";
    default: {
      const named = [by?.user, by?.client].filter(Boolean).join(": ");
      return named + (by?.address ? ` ${by.address}` : "") || "a local client";
    }
  }
}

/** The user and the role of a session: "vera (viewer)".
 *
 *  welcome  session.proto Welcome */
export function session_text(welcome: Message|null): string {
  const user: string = welcome?.user || "no token", role: string = welcome?.role ?? "ROLE_VIEWER";
  return `${user} (${role.replace("ROLE_", "").toLowerCase()})`;
}
