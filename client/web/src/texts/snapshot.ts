// What a snapshot says about a world and an island.
import type {Speed} from "../core/protocol";
import type {SnapshotInfo} from "../core/snapshot";

import {duration, with_separators} from "./numbers";
import {speed_text} from "./states";

/** "default · island 1 of 0–3 · 2× (120 ticks/s)". */
export function place_and_speed_text(
  name: string, snapshot: SnapshotInfo, speed: Speed|undefined, running: boolean): string {
  return name + (snapshot.island_count > 1 ? ` · island ${snapshot.island} of 0–${snapshot.island_count - 1}` : "") +
    ` · ${speed_text(speed)}` +
    (running && snapshot.ticks_per_s > 0 ? ` (${with_separators(snapshot.ticks_per_s)} ticks/s)` : "");
}

/** "alive 50 of 50", "mean health 131.3", …; of organisms without bodies only the tick. */
export function statistics_texts(
  snapshot: SnapshotInfo, has_bodies: boolean, has_births = false, has_predators = false): string[] {
  const live = snapshot.live, predators = has_predators ? live?.predator_count ?? 0 : 0;
  return [
    ...(
      live && has_bodies ?
        [
          `${has_predators ? "prey" : "alive"} ${with_separators((live.alive_count ?? 0) - predators)}` +
            (has_births || has_predators ? "" : ` of ${with_separators(live.organism_count ?? 0)}`),
          ...(has_predators ? [`predators ${with_separators(predators)}`] : []),
          ...(has_births ? [`born ${with_separators(live.born_count ?? 0)}`] : []),
          `mean health ${(live.health_mean ?? 0).toFixed(1)}`,
          `food eaten ${with_separators(live.food_eaten ?? 0)}`,
          `poison eaten ${with_separators(live.poison_eaten ?? 0)}`,
        ] :
        []),
    `tick ${with_separators(snapshot.tick)} (${duration(snapshot.simulated_s)})`,
  ];
}
