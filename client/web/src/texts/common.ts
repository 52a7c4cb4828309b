// Texts that several parts of the page use.
import {with_separators} from "./numbers";

export const common_texts = {
  cancel: "Cancel",
  no_world: "No world is open.",
  no_world_yet: "No world is open yet.",
  replay_cannot_change: "The shown world is a replay and cannot be changed.",
  end_of_replay: "end of the replay",
  wrong_seed: (seed: string, most: bigint) =>
    `seed: got "${seed}", allowed whole numbers from 0 to ${with_separators(most)}`,
};
