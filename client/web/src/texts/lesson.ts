// Texts of the panel "Lesson".
import {significant, with_separators, with_unit} from "./numbers";

const generations = (count: number): string => `${with_separators(count)} generation${count === 1 ? "" : "s"}`;

export const lesson_texts = {
  language: "en" as "en" | "de", // of the titles in the list of lessons

  // ---- the list ----
  about:
    "A lesson explains, asks for your prediction, runs the world, and compares. What you predict and observe is kept " +
    "in the run file.",
  list: "Lessons",
  minutes: (count: number) => `${count} minutes`,
  none: "This server has no lessons.",
  loading: "Loading …",
  not_loaded: (why: string) => `The lessons cannot be loaded: ${why}.`,
  unknown: (name: string) => `This server has no lesson ${name}.`,
  all: "‹ All lessons",
  handout: "Print handout",
  handout_help: "Opens the dialog for printing: the texts, with space for predictions.",

  // ---- the beginning ----
  goals: "Goals",
  needs: "What you need",
  begin: "Begin the lesson",
  begin_again: "Begin again …",
  ask_begin_again: (world: string) =>
    `Begin again? Your predictions stay in the present run of ${world}, which ends. The lesson begins without them.`,
  do_begin_again: "Begin again",
  begin_about: (world: string) =>
    `The lesson resets the world ${world}: its present run ends. All parameters get the values of the lesson.`,
  read_only: (why: string) => `You can read this lesson, but not run it here. ${why}`,
  elsewhere: (world: string) => `This lesson runs in the world ${world}.`,
  show_world: "Show it",
  no_world: "There is no world in which the lesson can run.",

  // ---- steps ----
  steps: "Steps of the lesson",
  step_of: (step: number, count: number) => `Step ${step} of ${count}`,
  back: "‹ Back",
  next: "Next ›",
  first_predict: "First give your prediction.",
  first_run: "First run the world.",
  changes: "Parameters of this step",
  from_to: (from: string, to: string) => `${from} → ${to}`,
  resets: "The world is reset: it begins again in generation 1.",
  run: (count: number) => `Run ${generations(count)}`,
  apply: "Apply",
  observe: "Observe",
  fast: "at full speed",
  runs: (generation: number, last: number) => `Generation ${with_separators(generation)} of ${with_separators(last)} …`,
  frozen: "The class is frozen. The run goes on when your teacher lets it go on.",
  paused: "The world is paused.",
  resume: "Go on",
  unwritten: "Not stored yet. The page tries again.",
  finished: "You have finished the lesson. Your predictions and observations are in the run file.",

  // ---- predictions ----
  prediction: "Your prediction",
  give: "That is my prediction",
  given: "Your prediction is stored.",
  from: (min: number, max: number, unit: string) => `from ${with_unit(min, "")} to ${with_unit(max, unit)}`,
  wrong_number: (text: string, min: number, max: number) =>
    `got "${text}", allowed numbers from ${with_unit(min, "")} to ${with_unit(max, "")}`,
  no_choice: "Choose one of the answers.",
  no_curve: "Draw a curve, or type at least two values.",
  no_sentence: "Write a sentence.",
  up: (option: string) => `Move up: ${option}`,
  down: (option: string) => `Move down: ${option}`,
  moved: (option: string, place: number, count: number) => `${option}: now ${place} of ${count}`,
  drag: "Drag to move",
  order_help: "Drag the lines, or use the arrows. The largest comes first.",
  draw_help: "Draw the curve with the mouse or a finger, or type its values.",
  clear: "Clear",
  values: "Values of the curve",
  value_at: (label: string, x: number) => `${label} ${with_unit(x, "")}`,
  characters: (used: number, most: number) => `${with_separators(used)} of ${with_separators(most)} characters`,

  // ---- answers ----
  answer: "What happened",
  predicted: "You predicted",
  observed: "Observed",
  theory: "Theory",
  no_value: "This run has no such value.",
  no_comparison: "The run does not give all values that are needed to compare.",
  apart: (apart: number, observed: number, unit: string) => {
    const percent = observed === 0 ? "" : ` (${significant(Math.abs(apart / observed) * 100)}\u00a0%)`;
    return apart === 0 ? "Your prediction is exact." :
                         `Your prediction is ${with_unit(Number(Math.abs(apart).toPrecision(3)), unit)} ${
                           apart > 0 ? "too high" : "too low"}${percent}.`;
  },
  close: "That is close.",
  far: "What did you not think of?",
  agrees: "The run agrees with you.",
  differs: "The run went another way. What could be the reason?",
  pairs: (count: number) => count === 0 ? "All are in the order of the run." :
                                          `${count} ${count === 1 ? "pair is" : "pairs are"} in the other order.`,
  curve_apart: (apart: number) => `On average, your curve is ${significant(apart)} away from the observed one.`,
  law: (value: number, error: number|undefined, unit: string) =>
    `${with_unit(Number(value.toPrecision(4)), error === undefined ? unit : "")}${
      error === undefined ? "" : ` ± ${with_unit(Number(error.toPrecision(2)), unit)}`}`,
  law_apart: (errors: number) => `The observation is ${significant(Math.abs(errors))} times this uncertainty ${
    errors >= 0 ? "above" : "below"} the theory.`,
  option: "Answer",
  value: "Value",
  your_order: "Your order",
  run_order: "Order in the run",
  summary: "Your results",
  summary_headings: ["Question", "You predicted", "Observed"],
  generations,
};

/** Words of the printed handout. */
export const handout_texts = {
  name: "Name",
  date: "Date",
  run: (count: number) => `Run ${generations(count)}.`,
  observed: "Observed",
  explanation: "Why?",
};
