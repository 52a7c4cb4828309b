// lesson_words: texts of lessons as elements, and predictions as words.
import type {Prediction, Question} from "../lesson/lesson_file";
import {blocks_of, type Span} from "../lesson/text";
import {shown_number, with_unit} from "../texts/numbers";
import {h} from "../widgets/dom";

function inline(spans: readonly Span[]): (Node|string)[] {
  return spans.map(({mark, text}) => (mark === "" ? text : h(mark, {}, text)));
}

/** The paragraphs and lists of a text. */
export function text_elements(text: string): HTMLElement[] {
  return blocks_of(text).map(
    (block) =>
      (block.kind === "paragraph" ? h("p", {}, ...inline(block.spans)) :
                                    h("ul", {}, ...block.items.map((item) => h("li", {}, ...inline(item))))));
}

/** A prediction as one line: "12 generations", "size 2", "b, a, c". */
export function prediction_words(question: Question, value: Prediction): string {
  switch (question.kind) {
    case "number":
      return with_unit(value as number, question.unit ?? "");
    case "choice":
      return question.options[value as number] ?? "";
    case "order":
      return (value as number[]).map((i) => question.options[i] ?? "").join(", ");
    case "curve":
      return ends_words(value as [number, number][]);
    case "sentence":
      return value as string;
  }
}

function ends_words(points: readonly(readonly[number, number])[]): string {
  const [first, last] = [points[0], points.at(-1)];
  return first && last ? `${shown_number(first[1])} … ${shown_number(last[1])}` : "";
}
