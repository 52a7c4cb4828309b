// What the organisms of a world try to do.
import type {ParameterSet} from "../core/protocol";

/** Sentences of the server. */
export function experiment_text(set: ParameterSet): string {
  return set.summary ?? "";
}
