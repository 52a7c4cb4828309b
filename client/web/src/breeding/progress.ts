// Progress: how many picks of a breeding have been made at the moment that the glass box shows. No DOM.
import {type Comparison, copies_after} from "./comparison";
import type {BreedingRecord} from "./record";
import type {Moment} from "./stepper";

export interface Progress {
  made: number; // picks
  complete: boolean; // all were made
}

export function progress_of(record: BreedingRecord, moment: Moment): Progress {
  const all = record.head?.pick_count ?? 0;
  const made = moment.stage === "scaling" ? 0 : moment.stage === "picking" ? moment.index + 1 : all;
  return {made, complete: moment.stage !== "scaling" && made >= all};
}

/** The copies of each rank in the picks that were made. */
export function copies_so_far(record: BreedingRecord, comparison: Comparison, {made, complete}: Progress): number[] {
  return complete ? comparison.copies : copies_after(record, made);
}
