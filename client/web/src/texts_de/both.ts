// The button that runs both worlds.
import type * as english from "../texts/both";

export const both_texts: typeof english.both_texts = {
  run: "Beide starten",
  pause: "Beide anhalten",
  run_help: "Startet beide Welten oder hält beide an.",
  replay_of: (world) => `die Wiedergabe von ${world}`,
  refused: (world, why) => `${world}: ${why}`,
};
