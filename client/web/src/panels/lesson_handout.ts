// lesson_handout: prints a lesson: its texts, with space to write the predictions.
import type {Lesson, Question} from "../lesson/lesson_file";
import {handout_texts, lesson_texts as texts} from "../texts/lesson";
import {h} from "../widgets/dom";
import {later_style} from "../widgets/later_style";

import {CurvePlot} from "./lesson_plot";
import {text_elements} from "./lesson_words";

function space(question: Question): Node[] {
  switch (question.kind) {
    case "number": {
      const {min, max, unit = ""} = question;
      return [h("p", {}, h("span", {class: "handout-line"}), ` ${unit} (${texts.from(min, max, unit)})`)];
    }
    case "choice":
    case "order":
      return question.options.map((option) => h("p", {}, h("span", {class: "handout-box"}), " ", option));
    case "curve":
      return [new CurvePlot(question, question.ask).element];
    case "sentence":
      return [1, 2, 3].map(() => h("div", {class: "handout-write"}));
  }
}

/** The handout as an element. */
export function handout_of(lesson: Lesson): HTMLElement {
  const line = (name: string): HTMLElement => h("span", {}, `${name}: `, h("span", {class: "handout-line"}));
  const steps = lesson.steps.map(
    ({title, text, predict, do: action}, i) =>
      h("section", {}, h("h2", {}, `${i + 1}. ${title}`), ...text_elements(text),
        predict && h("div", {class: "handout-question"}, h("p", {}, h("strong", {}, predict.ask)), ...space(predict)),
        action?.run !== undefined && h("p", {}, `☐ ${handout_texts.run(action.run)}`),
        action?.run !== undefined && predict !== undefined && h("p", {}, line(handout_texts.observed)),
        action?.run !== undefined && predict !== undefined && h("p", {}, line(handout_texts.explanation))));
  return h(
    "div", {class: "lesson-handout"}, h("p", {}, line(handout_texts.name), " ", line(handout_texts.date)),
    h("h1", {}, lesson.title), h("p", {}, texts.minutes(lesson.minutes)), h("h2", {}, texts.goals),
    h("ul", {}, ...lesson.goals.map((goal) => h("li", {}, goal))),
    h("p", {}, h("strong", {}, `${texts.needs}: `), lesson.needs), ...steps);
}

/** Makes the handout and opens the browser's dialog for printing. */
export async function print_handout(lesson: Lesson): Promise<void> {
  await later_style("lesson.css");
  const handout = handout_of(lesson);
  document.body.append(handout);
  addEventListener("afterprint", () => handout.remove(), {once: true});
  print();
}
