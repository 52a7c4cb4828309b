// What a snapshot says about a world and an island.
import type * as english from "../texts/snapshot";

import {duration, tenths, with_separators} from "./numbers";
import {speed_text} from "./states";

export const place_and_speed_text: typeof english.place_and_speed_text = (name, snapshot, speed, running) => name +
  (snapshot.island_count > 1 ? ` · Insel ${snapshot.island} von 0–${snapshot.island_count - 1}` : "") +
  ` · ${speed_text(speed)}` +
  (running && snapshot.ticks_per_s > 0 ? ` (${with_separators(snapshot.ticks_per_s)} Ticks/s)` : "");

export const statistics_texts: typeof english.statistics_texts = (snapshot, has_bodies, has_births, has_predators) => {
  const live = snapshot.live, predators = has_predators ? live?.predator_count ?? 0 : 0;
  return [
    ...(
      live && has_bodies ?
        [
          `${has_predators ? "Beute" : "am Leben"} ${with_separators((live.alive_count ?? 0) - predators)}` +
            (has_births || has_predators ? "" : ` von ${with_separators(live.organism_count ?? 0)}`),
          ...(has_predators ? [`Räuber ${with_separators(predators)}`] : []),
          ...(has_births ? [`geboren ${with_separators(live.born_count ?? 0)}`] : []),
          `mittlere Gesundheit ${tenths(live.health_mean ?? 0)}`,
          `Futter gefressen ${with_separators(live.food_eaten ?? 0)}`,
          `Gift gefressen ${with_separators(live.poison_eaten ?? 0)}`,
        ] :
        []),
    `Tick ${with_separators(snapshot.tick)} (${duration(snapshot.simulated_s)})`,
  ];
};
