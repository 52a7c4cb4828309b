// States of worlds and runs as words.
import texts from "../../../../proto/texts/de/events.json";
import type * as english from "../texts/states";

import {capitalised, shown_number} from "./numbers";

export const speed_text: typeof english.speed_text = (speed) => {
  if (speed?.max) {
    return "max";
  }
  const factor = speed?.real_time_factor ?? 0, inverse = factor > 0 ? 1 / factor : 0;
  return factor > 0 && factor < 1 && Number.isInteger(inverse) ? `1/${inverse}×` : `${shown_number(factor)}×`;
};

export const storage_text: typeof english.storage_text = (storage) => {
  const states: {readonly [state: string]: string|undefined} = texts.storage_state;
  const state = states[storage?.state ?? ""];
  return state === undefined ? capitalised(storage?.text ?? "") :
                               `${state}${storage?.reason ? `: ${storage.reason}` : ""}`;
};

export const state_word: typeof english.state_word = (state, storage, awaits_fitness = false) => {
  switch (state) {
    case "RUN_STATE_WAITING":
      return "wartet";
    case "RUN_STATE_RUNNING":
      return storage?.state === "STORAGE_STATE_STALLED" || storage?.state === "STORAGE_STATE_BEHIND" ?
        "wartet auf den Datenträger" :
        awaits_fitness ? "wartet auf die Fitness" :
                         "läuft";
    case "RUN_STATE_PAUSED":
      return "angehalten";
    case "RUN_STATE_TERMINATED":
      return "zu Ende";
    case "RUN_STATE_UNSPECIFIED":
    case undefined:
      return "…";
  }
};

export const outcome_words: typeof english.outcome_words = (outcome) => {
  const words: {readonly [outcome: string]: string|undefined} = texts.outcome;
  return words[outcome ?? ""] ?? "ein Abbruchkriterium ist erfüllt";
};
