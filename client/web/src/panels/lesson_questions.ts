// lesson_questions: the fields in which a user predicts: a number, a choice, an order, a curve, a sentence.
import {DrawnCurve, field_count} from "../lesson/curve";
import type {
  ChoiceQuestion, CurveQuestion, NumberQuestion, OrderQuestion, Point, Prediction, Question, SentenceQuestion} from
  "../lesson/lesson_file";
import {lesson_texts as texts} from "../texts/lesson";
import {rounded} from "../texts/numbers";
import {set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {button, symbol_button} from "../widgets/form";
import {typed_number} from "../world/parameter_values";

import {CurvePlot} from "./lesson_plot";

const sentence_characters_max = 1000;

/** A question with its field. */
export interface QuestionField {
  readonly element: HTMLElement;
  /** The prediction; {wrong}: what is missing, as a sentence. */
  read(): Prediction|{wrong: string};
  /** Shows a prediction that has been given. It cannot be changed any more. */
  lock(given: Prediction): void;
}

export function is_wrong(read: Prediction|{wrong: string}): read is {wrong: string} {
  return typeof read === "object" && "wrong" in read;
}

export function question_field(question: Question): QuestionField {
  switch (question.kind) {
    case "number":
      return number_field(question);
    case "choice":
      return choice_field(question);
    case "order":
      return new OrderField(question);
    case "curve":
      return new CurveField(question);
    case "sentence":
      return sentence_field(question);
  }
}

/** Reads a real number as the language writes it. */
function typed(text: string): number|null {
  return typed_number({kind: "PARAMETER_KIND_REAL"}, text);
}

function fieldset(question: Question, ...children: (Node|string|null)[]): HTMLFieldSetElement {
  return h("fieldset", {class: `lesson-question lesson-${question.kind}`}, h("legend", {}, question.ask), ...children);
}

function number_field(question: NumberQuestion): QuestionField {
  const {min, max, unit = ""} = question, range = texts.from(min, max, unit), id = `lesson-${question.id}-range`;
  const input = h("input", {
    class: "field lesson-number-field",
    inputmode: "decimal",
    autocomplete: "off",
    "aria-label": question.ask,
    "aria-describedby": id
  });
  const element = fieldset(question, h("div", {class: "row"}, input, unit, h("span", {class: "hint", id}, range)));
  return {
    element,
    read: () => {
      const value = typed(input.value), is_right = value !== null && value >= min && value <= max;
      set_attribute(input, "aria-invalid", is_right ? null : "true");
      return is_right ? value : {wrong: texts.wrong_number(input.value, min, max)};
    },
    lock: (given) => {
      input.value = rounded(given as number);
      element.disabled = true;
    },
  };
}

function choice_field(question: ChoiceQuestion): QuestionField {
  const inputs = question.options.map((_, i) => h("input", {type: "radio", name: `lesson-${question.id}`, value: i}));
  const labels = question.options.map((option, i) => h("label", {class: "check"}, inputs[i], option));
  const element = fieldset(question, ...labels);
  return {
    element,
    read: () => {
      const chosen = inputs.findIndex((input) => input.checked);
      return chosen === -1 ? {wrong: texts.no_choice} : chosen;
    },
    lock: (given) => {
      inputs.forEach((input, i) => (input.checked = i === given));
      element.disabled = true;
    },
  };
}

function sentence_field(question: SentenceQuestion): QuestionField {
  const count = h("span", {class: "hint"}),
        show = (): void => set_text(count, texts.characters(input.value.length, sentence_characters_max));
  const input =
    h("textarea",
      {class: "field", rows: 4, maxlength: sentence_characters_max, "aria-label": question.ask, oninput: () => show()});
  const element = fieldset(question, input, count);
  show();
  return {
    element,
    read: () => (input.value.trim() === "" ? {wrong: texts.no_sentence} : input.value.trim()),
    lock: (given) => {
      input.value = given as string;
      element.disabled = true;
      show();
    },
  };
}

/** A list that the user brings into an order: by buttons, or by dragging a line. */
class OrderField implements QuestionField {
  readonly element: HTMLFieldSetElement;
  readonly #list = h("ol", {class: "lesson-order-list"});
  readonly #said = h("p", {class: "visually-hidden", role: "status", "aria-live": "polite"});
  readonly #items: HTMLLIElement[]; // by option

  constructor(readonly question: OrderQuestion) {
    this.#items = question.options.map((option, i) => this.#item(option, i));
    this.#list.append(...this.#items);
    this.element = fieldset(question, h("p", {class: "hint"}, texts.order_help), this.#list, this.#said);
  }

  read(): number[] {
    return [...this.#list.children].map((item) => this.#items.indexOf(item as HTMLLIElement));
  }

  lock(given: Prediction): void {
    this.#list.append(...(given as number[]).map((i) => this.#items[i]!));
    this.element.disabled = true;
  }

  #item(option: string, i: number): HTMLLIElement {
    const up = symbol_button("▲", texts.up(option), () => this.#move(i, -1), "button square");
    const down = symbol_button("▼", texts.down(option), () => this.#move(i, 1), "button square");
    const handle = h("span", {class: "lesson-handle", title: texts.drag, "aria-hidden": "true"}, "⠿");
    const item = h("li", {}, handle, h("span", {class: "grow"}, option), up, down);
    item.addEventListener("pointerdown", (event) => this.#drag(item, event));
    return item;
  }

  #move(i: number, by: number): void {
    const item = this.#items[i]!, focused = document.activeElement;
    const other = by < 0 ? item.previousElementSibling : item.nextElementSibling;
    if (other === null) {
      return;
    }
    this.#list.insertBefore(item, by < 0 ? other : other.nextElementSibling);
    if (focused instanceof HTMLElement) {
      focused.focus(); // moving an element takes the focus away
    }
    set_text(this.#said, texts.moved(this.question.options[i]!, this.read().indexOf(i) + 1, this.#items.length));
  }

  #drag(item: HTMLLIElement, begin: PointerEvent): void {
    const on_button = (begin.target as Element).closest("button") !== null;
    const by_finger = begin.pointerType === "touch" && (begin.target as Element).closest(".lesson-handle") === null;
    if (on_button || by_finger || this.element.disabled || begin.button !== 0) {
      return; // a finger on the text scrolls
    }
    begin.preventDefault();
    const end = new AbortController(), {signal} = end;
    item.setPointerCapture(begin.pointerId);
    item.dataset.dragged = "";
    item.addEventListener("pointermove", ({clientY}) => {
      const before = this.#items.filter((one) => one !== item)
                       .filter((one) => {
                         const {top, height} = one.getBoundingClientRect();
                         return top + height / 2 < clientY;
                       })
                       .length;
      const others = [...this.#list.children].filter((one) => one !== item), next = others[before] ?? null;
      if (item.nextElementSibling !== next) {
        this.#list.insertBefore(item, next);
      }
    }, {signal});
    const stop = (): void => {
      delete item.dataset.dragged;
      end.abort();
    };
    item.addEventListener("lostpointercapture", stop, {signal});
    item.addEventListener("pointerup", stop, {signal});
  }
}

/** Axes on which the user draws a curve, and fields for its values. */
class CurveField implements QuestionField {
  readonly element: HTMLFieldSetElement;
  readonly #curve: DrawnCurve;
  readonly #plot: CurvePlot;
  readonly #fields: HTMLInputElement[];

  constructor(readonly question: CurveQuestion) {
    this.#curve = new DrawnCurve(question);
    this.#plot = new CurvePlot(question, question.ask);
    this.#plot.element.classList.add("lesson-drawable");
    this.#fields = Array.from({length: field_count}, (_, i) => {
      const name = texts.value_at(question.x.label, this.#curve.field(i).x);
      return h("input", {
        class: "field",
        inputmode: "decimal",
        autocomplete: "off",
        "aria-label": `${question.y.label}, ${name}`,
        onchange: () => this.#type(i)
      });
    });
    const heads = this.#fields.map((_, i) => h("th", {scope: "col"}, rounded(this.#curve.field(i).x, 3)));
    const table =
      h("table", {class: "lesson-values"}, h("caption", {class: "visually-hidden"}, texts.values),
        h("tr", {}, h("th", {scope: "row"}, question.x.label), ...heads),
        h("tr", {}, h("th", {scope: "row"}, question.y.label), ...this.#fields.map((field) => h("td", {}, field))));
    this.element = fieldset(
      question, h("p", {class: "hint"}, texts.draw_help), this.#plot.element, table,
      h("div", {class: "row"}, button(texts.clear, () => this.#clear())));
    this.#listen();
  }

  read(): Point[]|{wrong: string} {
    const {points} = this.#curve;
    return points.length < 2 ? {wrong: texts.no_curve} : points;
  }

  lock(given: Prediction): void {
    this.#curve.show(given as Point[]);
    this.#show();
    this.#plot.show([{kind: "predicted", points: given as Point[]}]);
    this.element.disabled = true;
    this.#plot.element.classList.remove("lesson-drawable");
  }

  #listen(): void {
    const area = this.#plot.element;
    const draw = (event: PointerEvent, begins: boolean): void => {
      this.#curve.draw(...this.#plot.at(event.clientX, event.clientY), begins);
      this.#show();
    };
    area.addEventListener("pointerdown", (event) => {
      if (event.button === 0 && !this.element.disabled) {
        event.preventDefault();
        area.setPointerCapture(event.pointerId);
        draw(event, true);
      }
    });
    area.addEventListener("pointermove", (event) => {
      if (area.hasPointerCapture(event.pointerId)) {
        draw(event, false);
      }
    });
  }

  #type(i: number): void {
    const field = this.#fields[i]!, value = typed(field.value), {min, max} = this.question.y;
    const is_right = field.value.trim() === "" || (value !== null && value >= min && value <= max);
    set_attribute(field, "aria-invalid", is_right ? null : "true");
    field.title = is_right ? "" : texts.wrong_number(field.value, min, max);
    if (is_right) {
      this.#curve.set_field(i, value);
      this.#show();
    }
  }

  #clear(): void {
    this.#curve.clear();
    this.#show();
  }

  #show(): void {
    this.#plot.show([{kind: "predicted", points: this.#curve.points}]);
    this.#fields.forEach((field, i) => {
      const {y} = this.#curve.field(i);
      field.value = y === null ? "" : rounded(y, 4);
      set_attribute(field, "aria-invalid", null);
    });
  }
}
