// StepView: one step of a lesson: its text, the prediction, what it does, and the answer.
import type {LessonPlayer} from "../lesson/player";
import {changed, set_parameters, type SetParameter} from "../lesson/settings";
import {lesson_texts as texts} from "../texts/lesson";
import {guarded_button, set_allowed, set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import type {Notify} from "../widgets/notices";
import {value_text} from "../world/parameter_values";
import {label_of} from "../world/parameters";
import type {ViewedWorld} from "../world/world";

import {answer_elements, summary_elements} from "./lesson_answer";
import {is_wrong, type QuestionField, question_field} from "./lesson_questions";
import {text_elements} from "./lesson_words";

const watched_generations_max = 3; // fewer are watched at the speed of the world

export class StepView {
  readonly element: HTMLElement;
  readonly heading: HTMLElement;
  readonly #player: LessonPlayer;
  readonly #step: number;
  readonly #field: QuestionField|null;
  readonly #wrong = h("p", {class: "error", role: "alert"});
  readonly #give: HTMLButtonElement;
  readonly #given = h("p", {class: "hint"});
  readonly #action = h("div", {class: "lesson-action"});
  readonly #changes = h("ul", {class: "lesson-changes"});
  readonly #fast = h("input", {type: "checkbox"});
  readonly #run: HTMLButtonElement;
  readonly #act: string; // what it does
  readonly #progress = h("div", {class: "lesson-progress", hidden: true});
  readonly #bar = h("progress", {max: 1});
  readonly #runs = h("p", {role: "status"});
  readonly #resume: HTMLButtonElement;
  readonly #problem = h("p", {class: "error", role: "alert"});
  readonly #answer = h("section", {class: "lesson-answer", role: "status", "aria-live": "polite"});
  #shown_answer = "";
  #is_locked = false;
  #is_shown = false; // refresh() has been called

  constructor(player: LessonPlayer, step: number, notify: Notify, drafts: Map<number, QuestionField>) {
    this.#player = player;
    this.#step = step;
    const {lesson} = player, {title, text, predict, do: action} = lesson.steps[step]!;
    this.heading = h("h3", {tabindex: -1}, title);
    this.#field = predict === undefined ? null : drafts.get(step) ?? question_field(predict);
    if (this.#field !== null) {
      drafts.set(step, this.#field);
    }
    this.#give = guarded_button(texts.give, notify, () => this.#predict(), "button button-primary");
    const {run} = action ?? {};
    this.#fast.checked = (run ?? 0) > watched_generations_max;
    this.#act = action === undefined ? texts.observe : run === undefined ? texts.apply : texts.run(run);
    this.#run = guarded_button(this.#act, notify, () => this.#perform(), "button button-primary");
    this.#resume = guarded_button(texts.resume, notify, () => void player.resume());
    this.#action.append(
      ...(action === undefined ? [] : [h("h4", {}, texts.changes), this.#changes]),
      h("div", {class: "row"}, this.#run,
        run === undefined ? null : h("label", {class: "check"}, this.#fast, texts.fast)));
    this.#progress.append(this.#bar, this.#runs, this.#resume);
    const asked =
      this.#field === null ? [] : [this.#field.element, this.#wrong, h("div", {class: "row"}, this.#give), this.#given];
    this.element =
      h("section", {class: "lesson-step"}, this.heading, ...text_elements(text), ...asked, this.#action, this.#progress,
        this.#problem, this.#answer);
  }

  /** world: whose parameters are compared, if it is the one of the lesson */
  refresh(world: ViewedWorld): void {
    const player = this.#player, {course, why_not} = player, step = this.#step, {predict} = player.lesson.steps[step]!;
    const is_begun = player.state === "begun", phase = is_begun ? course.phase(step) : "predict";
    const given = predict === undefined ? undefined : course.predictions.get(predict.id);
    const is_running = player.running?.step === step;
    if (given !== undefined && !this.#is_locked) {
      this.#field?.lock(given);
      this.#is_locked = true;
    }
    this.#give.hidden = given !== undefined || !is_begun;
    set_allowed(this.#give, why_not || (step > course.open ? texts.first_predict : ""));
    set_text(this.#given, given === undefined ? "" : player.has_unwritten ? texts.unwritten : texts.given);
    this.#action.hidden = !is_begun || is_running || phase !== "do";
    set_text(this.#run, player.has_performed(step) ? texts.observe : this.#act);
    set_allowed(this.#run, why_not || (player.is_busy ? texts.loading : ""));
    if (!this.#action.hidden) {
      this.#show_changes(world);
    }
    this.#show_progress(is_running);
    set_text(this.#problem, player.problem);
    this.#show_answer(is_begun && phase === "done");
    this.#is_shown = true;
    player.retry();
  }

  /** Performs the step, or only observes if its generations have run. */
  #perform(): void {
    const player = this.#player;
    void (player.has_performed(this.#step) ? player.observe() : player.perform(this.#fast.checked));
  }

  #predict(): void {
    const read = this.#field!.read();
    set_text(this.#wrong, is_wrong(read) ? read.wrong : "");
    if (!is_wrong(read)) {
      void this.#player.predict(read);
    }
  }

  #show_changes(world: ViewedWorld): void {
    const {lesson, server, world: of_lesson} = this.#player, action = lesson.steps[this.#step]!.do;
    const {set} = world.parameters;
    const parameters = set === null || world.shown !== of_lesson ?
      [] :
      changed(set_parameters(server.parameters, set, action?.set ?? {}));
    const lines = [...parameters.map(change_words), ...(action?.reset ? [texts.resets] : [])];
    const shown = [...this.#changes.children].map(({textContent}) => textContent);
    if (lines.join("\n") !== shown.join("\n")) {
      this.#changes.replaceChildren(...lines.map((line) => h("li", {}, line)));
    }
    const heading = this.#action.querySelector("h4");
    if (heading !== null) {
      heading.hidden = this.#changes.hidden = lines.length === 0;
    }
  }

  #show_progress(is_running: boolean): void {
    const player = this.#player, {running, info} = player;
    this.#progress.hidden = !is_running;
    if (!is_running || running === null) {
      return;
    }
    const is_paused = info?.state === "RUN_STATE_PAUSED" && running.run !== "";
    this.#bar.value = player.progress;
    set_attribute(this.#bar, "aria-label", texts.run(Math.max(running.until - running.first, 1)));
    set_text(
      this.#runs,
      running.run === "" ? texts.loading :
        info?.frozen     ? texts.frozen :
        is_paused        ? texts.paused :
                           texts.runs(Math.min(info?.generation ?? 1, running.until - 1), running.until - 1));
    this.#resume.hidden = !is_paused || info?.frozen === true;
    set_allowed(this.#resume, player.why_not);
  }

  #show_answer(is_done: boolean): void {
    const {lesson, course} = this.#player, step = this.#step;
    const shown = is_done ? JSON.stringify([course.answer(step), course.is_finished]) : "";
    if (shown === this.#shown_answer) {
      return;
    }
    const is_new = this.#shown_answer === "" && this.#is_shown;
    this.#shown_answer = shown;
    const is_last = is_done && step === lesson.steps.length - 1 && course.is_finished;
    this.#answer.replaceChildren(
      ...(is_done ? answer_elements(lesson, course, step) : []),
      ...(is_last ? [...summary_elements(lesson, course), h("p", {}, texts.finished)] : []));
    if (is_new) {
      this.#answer.scrollIntoView({block: "nearest"});
    }
  }
}

function change_words({about, before, after}: SetParameter): string {
  return `${label_of(about)}: ${texts.from_to(value_text(before), value_text(after))}`;
}

/** The button that leads on, and why it may not yet. */
export function why_not_next({state, course}: LessonPlayer, step: number): string {
  if (state !== "begun" || course.phase(step) === "done") {
    return "";
  }
  return course.phase(step) === "predict" ? texts.first_predict : texts.first_run;
}
