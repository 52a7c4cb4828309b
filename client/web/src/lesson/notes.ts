// notes: the notes of a lesson in the journal of a run, as docs/LESSONS.md describes them. Pure functions.
import type {Prediction} from "./lesson_file";

/** An observation: a number, a list of numbers, or null: no value. */
export type Observed = number|null|(number|null)[];

/** How a prediction compares with observations, or an observation with a law. */
export interface Answer {
  id: string; // of the prediction; without a prediction, the name of the observation
  predicted?: Prediction;
  observed?: Prediction|Observed;
  passed?: boolean;
  apart?: number;
  law?: number;
  error?: number;
}

export type Note = {
  lesson: string; step: number
}&({
  kind: "lesson_prediction";
  id: string;
  value: Prediction
}|{
  kind: "lesson_observation";
  id: string;
  value: Observed
}|({kind: "lesson_answer"}&Answer)); // step counts from 1

/** A note, and the run whose journal contains it. */
export interface KeptNote {
  note: Note;
  run: string; // id; empty: no run contains it yet
}

export const note_bytes_max = 4096;

/** The text of the note for AddNote. */
export function note_text(note: Note): string {
  const {kind, ...fields} = note;
  return JSON.stringify(fields);
}

/** Reads a row of the exported table of notes; null: it does not belong to the lesson. */
export function read_note(row: string, lesson: string): Note|null {
  try {
    const {kind, text} = JSON.parse(row) as {
      kind: string;
      text: string
    };
    if (!/^lesson_(prediction|observation|answer)$/.test(kind)) {
      return null;
    }
    const fields = JSON.parse(text) as {
      lesson?: unknown;
      id?: unknown;
      step?: unknown
    };
    return fields.lesson === lesson && typeof fields.id === "string" && typeof fields.step === "number" ?
      {kind, ...fields} as Note :
      null;
  } catch {
    return null; // another client has written it
  }
}

function same(one: Note, other: Note): boolean {
  return one.kind === other.kind && one.id === other.id && note_text(one) === note_text(other);
}

/** Unites the notes in the journal of a run with those that this tab remembers, without doubles. */
export function united(run: string, journaled: readonly Note[], remembered: readonly KeptNote[]): KeptNote[] {
  const kept = journaled.map((note) => ({note, run}));
  return [...kept, ...remembered.filter(({note}) => !journaled.some((one) => same(one, note)))];
}
