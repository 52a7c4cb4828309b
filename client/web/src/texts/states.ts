// States of worlds and runs as words.
import texts from "../../../../proto/texts/events.json";
import type {Outcome, RunState, Speed, Storage} from "../core/protocol";

import {capitalised, shown_number} from "./numbers";

/** "2×", "1/8×", "max". */
export function speed_text(speed: Speed|undefined): string {
  if (speed?.max) {
    return "max";
  }
  const factor = speed?.real_time_factor ?? 0, inverse = factor > 0 ? 1 / factor : 0;
  return factor > 0 && factor < 1 && Number.isInteger(inverse) ? `1/${inverse}×` : `${shown_number(factor)}×`;
}

/** Why commands are refused or worlds wait; empty if the server can write its runs. */
export function storage_text(storage: Storage|null|undefined): string {
  return capitalised(storage?.text ?? "");
}

export function state_word(state: RunState|undefined, storage?: Storage|null, awaits_fitness = false): string {
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
    case "RUN_STATE_UNSPECIFIED":
    case undefined:
      return "…";
  }
}

export function outcome_words(outcome: Outcome|undefined): string {
  const words: {[outcome: string]: string} = texts.outcome;
  return words[outcome ?? ""] ?? "ended by a criterion";
}
