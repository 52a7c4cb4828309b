// course: where a user is in a lesson: what has been predicted and observed, and which step is open. Pure.
import type {Lesson, Prediction} from "./lesson_file";
import type {Answer, Note, Observed} from "./notes";

/** What a step waits for: a prediction, that its generations run, or nothing. */
export type Phase = "predict"|"do"|"done";

export class Course {
  readonly predictions = new Map<string, Prediction>(); // by id
  readonly observed = new Map<string, Observed>(); // by name
  readonly #answers = new Map<number, Answer>(); // by step, from 0
  readonly #last_noted: number; // the last step with a note, from 0; -1: none
  readonly #performed: ReadonlySet<number>;

  /** performed: the steps whose `do` has been performed, from 0; needed for steps without observations */
  constructor(readonly lesson: Lesson, notes: readonly Note[], performed: ReadonlySet<number> = new Set()) {
    for (const note of notes) {
      if (note.kind === "lesson_prediction") {
        this.predictions.set(note.id, note.value);
      } else if (note.kind === "lesson_observation") {
        this.observed.set(note.id, note.value);
      } else {
        const {kind, lesson: of, step, ...answer} = note;
        this.#answers.set(step - 1, answer);
      }
    }
    this.#performed = performed;
    this.#last_noted = Math.max(-1, ...notes.map(({step}) => step - 1));
  }

  phase(i: number): Phase {
    const {predict, do: action, observe = {}, check, law} = this.lesson.steps[i]!;
    if (predict !== undefined && !this.predictions.has(predict.id)) {
      return "predict";
    }
    const names = Object.keys(observe);
    const is_done = names.length > 0           ? names.every((name) => this.observed.has(name)) :
      check !== undefined || law !== undefined ? this.#answers.has(i) :
                                                 action === undefined || this.#performed.has(i) || i < this.#last_noted;
    return is_done ? "done" : "do";
  }

  answer(i: number): Answer|null {
    return this.#answers.get(i) ?? null;
  }

  /** The first step that waits for something; the last one if none does. */
  get open(): number {
    const {steps} = this.lesson, first = steps.findIndex((_, i) => this.phase(i) !== "done");
    return first === -1 ? steps.length - 1 : first;
  }

  /** Whether no step waits for anything. */
  get is_finished(): boolean {
    return this.phase(this.open) === "done";
  }
}
