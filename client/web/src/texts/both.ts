// The button that runs both worlds.

export const both_texts = {
  run: "Run both",
  pause: "Pause both",
  run_help: "Runs both worlds, or pauses both.",
  replay_of: (world: string) => `the replay of ${world}`,
  refused: (world: string, why: string) => `${world}: ${why}`,
};
