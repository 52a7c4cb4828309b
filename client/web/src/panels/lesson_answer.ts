// lesson_answer: what was predicted, what was observed, what theory expects, and how far apart they are.
import type {Course} from "../lesson/course";
import {
  type Lesson,
  places_of,
  type Point,
  type Prediction,
  type Question,
  question_of,
  type Step
} from "../lesson/lesson_file";
import type {Answer} from "../lesson/notes";
import {lesson_texts as texts} from "../texts/lesson";
import {rounded, significant, with_unit} from "../texts/numbers";
import {h} from "../widgets/dom";

import {CurvePlot, type Kind, legend, number_line} from "./lesson_plot";
import {prediction_words} from "./lesson_words";

/** The elements that show the answer of a step; none if it compares nothing. */
export function answer_elements(lesson: Lesson, course: Course, step: number): Element[] {
  const answer = course.answer(step), of = lesson.steps[step]!;
  if (answer === null) {
    return [];
  }
  const question = question_of(lesson, answer.id);
  const compared = question === undefined || of.check === undefined ? [] :
    answer.observed === undefined && question.kind !== "sentence"   ? [h("p", {}, texts.no_comparison)] :
                                                                      comparison(lesson, course, of, question, answer);
  return [h("h4", {}, texts.answer), ...compared, ...law_elements(of, course, answer, question)];
}

function unit_of(question: Question|undefined): string {
  return question?.kind === "number" ? question.unit ?? "" : "";
}

function comparison(lesson: Lesson, course: Course, step: Step, question: Question, answer: Answer): Element[] {
  switch (question.kind) {
    case "number":
      return number_elements(question, answer, step);
    case "choice":
      return choice_elements(question.options, course, step, answer);
    case "order":
      return order_elements(question.options, course, step, answer);
    case "curve": {
      const places = step.check !== undefined && "curve" in step.check ? places_of(lesson, step.check.curve) : [];
      const observed = (answer.observed as number[]).map((y, i): Point => [places[i]!, y]);
      const words = [texts.curve_apart(answer.apart ?? 0), closeness(answer)].join(" ");
      const plot = new CurvePlot(question, words);
      plot.show([{kind: "predicted", points: answer.predicted as Point[]}, {kind: "observed", points: observed}]);
      return [legend(["predicted", "observed"]), plot.element, h("p", {}, words)];
    }
    case "sentence":
      return [];
  }
}

function facts(rows: readonly(readonly[string, string])[]): HTMLElement {
  return h("dl", {class: "lesson-facts"}, ...rows.flatMap(([name, value]) => [h("dt", {}, name), h("dd", {}, value)]));
}

/** What follows the words about the distance. */
function closeness({passed, apart}: Answer): string {
  return apart === 0 ? "" : passed ? texts.close : texts.far;
}

function number_elements(question: Question&{kind: "number"}, answer: Answer, step: Step): Element[] {
  const {unit = ""} = question, predicted = answer.predicted as number, observed = answer.observed as number;
  const shows_law =
    answer.law !== undefined && step.check !== undefined && "near" in step.check && step.law?.of === step.check.near;
  const words = [texts.apart(answer.apart ?? 0, observed, unit), closeness(answer)].join(" ");
  const theory = shows_law ? [{kind: "theory" as Kind, value: answer.law!, error: answer.error ?? 0}] : [];
  const numbers =
    [...theory, {kind: "predicted" as Kind, value: predicted}, {kind: "observed" as Kind, value: observed}];
  const shown = Number(observed.toPrecision(4));
  return [
    facts([[texts.predicted, with_unit(predicted, unit)], [texts.observed, with_unit(shown, unit)]]), h("p", {}, words),
    number_line(question, numbers, words),
    legend(numbers.map(({kind}) => kind).sort((a, b) => kinds.indexOf(a) - kinds.indexOf(b)))
  ];
}
const kinds: readonly Kind[] = ["predicted", "observed", "theory"];

/** The names of the observations of the options. */
function names_of(step: Step): string[] {
  const {check} = step;
  return check === undefined ? [] :
    "argmax" in check        ? check.argmax :
    "argmin" in check        ? check.argmin :
    "order" in check         ? check.order :
                               [];
}

function value_words(course: Course, name: string|undefined): string {
  const value = course.observed.get(name ?? "");
  return typeof value === "number" ? significant(value) : "–";
}

function choice_elements(options: readonly string[], course: Course, step: Step, answer: Answer): Element[] {
  const names = names_of(step);
  const mark = (i: number):
    string => [i === answer.predicted ? `◆ ${texts.predicted}` : "", i === answer.observed ? `● ${texts.observed}` : ""]
                .filter(Boolean)
                .join("  ");
  const rows = options.map(
    (option, i) => h(
      "tr", {}, h("td", {}, option), h("td", {class: "number"}, value_words(course, names[i])), h("td", {}, mark(i))));
  return [
    h("table", {class: "table"},
      h("tr", {}, ...[texts.option, texts.value, ""].map((head) => h("th", {scope: "col"}, head))), ...rows),
    h("p", {}, answer.passed ? texts.agrees : texts.differs)
  ];
}

function order_elements(options: readonly string[], course: Course, step: Step, answer: Answer): Element[] {
  const names = names_of(step), predicted = answer.predicted as number[], observed = answer.observed as number[];
  const rows = observed.map(
    (option, place) =>
      h("tr", {}, h("td", {}, `${place + 1}. ${options[predicted[place] ?? -1] ?? ""}`),
        h("td", {}, `${options[option] ?? ""}: ${value_words(course, names[option])}`)));
  const words = [texts.pairs(answer.apart ?? 0), answer.passed ? texts.agrees : texts.differs].join(" ");
  return [
    h("table", {class: "table"},
      h("tr", {}, ...[texts.your_order, texts.run_order].map((head) => h("th", {scope: "col"}, head))), ...rows),
    h("p", {}, words)
  ];
}

function law_elements(step: Step, course: Course, {law, error}: Answer, question: Question|undefined): Element[] {
  if (step.law === undefined) {
    return [];
  }
  const observed = course.observed.get(step.law.of), unit = unit_of(question);
  const is_number = typeof observed === "number";
  const rows: [string, string][] = [];
  if (step.check === undefined) {
    rows.push([texts.observed, is_number ? with_unit(Number(observed.toPrecision(4)), unit) : texts.no_value]);
  }
  rows.push([texts.theory, law === undefined ? texts.no_value : texts.law(law, error, unit)]);
  const apart =
    law !== undefined && error !== undefined && error > 0 && is_number ? texts.law_apart((observed - law) / error) : "";
  return [facts(rows), h("p", {class: "lesson-law"}, step.law.text), h("p", {}, apart)];
}

/** A table of all predictions, and what was observed. */
export function summary_elements(lesson: Lesson, course: Course): Element[] {
  const answers = lesson.steps.map((_, i) => course.answer(i));
  const rows = lesson.steps.flatMap(({predict}) => {
    const given = predict && course.predictions.get(predict.id);
    if (predict === undefined || given === undefined) {
      return [];
    }
    const answer = answers.find((one) => one?.id === predict.id);
    const observed = answer?.observed === undefined ? "–" : observed_words(predict, answer.observed as Prediction);
    return [h(
      "tr", {}, h("td", {}, predict.ask), h("td", {}, prediction_words(predict, given)), h("td", {}, observed))];
  });
  return rows.length === 0 ? [] : [
    h("h4", {}, texts.summary),
    h("table", {class: "table lesson-summary"},
      h("tr", {}, ...texts.summary_headings.map((head) => h("th", {scope: "col"}, head))), ...rows)
  ];
}

function observed_words(question: Question, observed: Prediction): string {
  if (question.kind === "curve") {
    const values = observed as number[];
    return `${rounded(values[0] ?? 0, 4)} … ${rounded(values.at(-1) ?? 0, 4)}`;
  }
  return prediction_words(
    question, question.kind === "number" ? Number((observed as number).toPrecision(4)) : observed);
}
