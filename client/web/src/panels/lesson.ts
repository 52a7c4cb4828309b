// LessonPanel: the list of lessons, and the chosen one: its beginning and its steps.
import {type Lesson, type ListedLesson, load_lesson, load_list} from "../lesson/lesson_file";
import {LessonPlayer} from "../lesson/player";
import {column_texts} from "../texts/column";
import {lesson_texts as texts} from "../texts/lesson";
import {panels_texts} from "../texts/panels";
import {guarded_button, set_allowed, set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {button, hint, Question, row} from "../widgets/form";
import {later_style} from "../widgets/later_style";
import {chosen_lesson, choose_lesson} from "../world/lesson_link";
import type {Panel, PanelContext} from "../world/panel_context";

import {print_handout} from "./lesson_handout";
import type {QuestionField} from "./lesson_questions";
import {StepView, why_not_next} from "./lesson_step";

export class LessonPanel implements Panel {
  readonly name = "lesson";
  readonly title = panels_texts.lesson;
  readonly element = h("div", {class: "panel panel-lesson"});
  readonly #context: PanelContext;
  readonly #list = h("div", {class: "panel"}, hint(texts.loading));
  #listed: Promise<ListedLesson[]>|null = null;
  #shown: LessonView|null = null;
  #loading = ""; // name of the lesson that is being loaded

  constructor(context: PanelContext) {
    this.#context = context;
    void later_style("lesson.css");
    this.element.append(this.#list);
    const chosen = chosen_lesson();
    if (chosen === "") {
      void this.#show_list();
    } else {
      void this.#open(chosen);
    }
  }

  refresh(): void {
    this.#shown?.refresh();
  }

  /** subject.lesson: the name of a lesson */
  show({lesson}: {[key: string]: unknown}): void {
    if (typeof lesson === "string" && lesson !== this.#loading && lesson !== this.#shown?.name) {
      void this.#open(lesson);
    }
  }

  async #show_list(problem = ""): Promise<void> {
    choose_lesson("");
    this.#close();
    this.element.replaceChildren(this.#list);
    try {
      this.#listed ??= load_list();
      const lessons = await this.#listed;
      const items = lessons.map(
        ({name, minutes, title}) =>
          h("li", {}, button(title[texts.language], () => void this.#open(name), {class: "link lesson-link"}),
            h("span", {class: "hint"}, texts.minutes(minutes))));
      const list =
        items.length === 0 ? hint(texts.none) : h("ul", {class: "lesson-list", "aria-label": texts.list}, ...items);
      this.#list.replaceChildren(hint(texts.about), h("p", {class: "error", role: "alert"}, problem), list);
    } catch (error) {
      this.#listed = null;
      this.#list.replaceChildren(h("p", {class: "error", role: "alert"}, texts.not_loaded((error as Error).message)));
    }
  }

  async #open(name: string): Promise<void> {
    this.#loading = name;
    try {
      const lesson = await load_lesson(name);
      if (this.#loading === name) {
        this.#close();
        choose_lesson(name);
        this.#shown = new LessonView(this.#context, name, lesson, () => void this.#show_list());
        this.element.replaceChildren(this.#shown.element);
        this.#shown.refresh();
      }
    } catch {
      await this.#show_list(texts.unknown(name));
    }
  }

  #close(): void {
    this.#loading = "";
    this.#shown?.close();
    this.#shown = null;
  }
}

/** The chosen lesson. */
class LessonView {
  readonly element: HTMLElement;
  readonly #context: PanelContext;
  readonly #lesson: Lesson;
  readonly #elsewhere = h("p", {class: "lesson-elsewhere"});
  readonly #why = h("p", {class: "warning", role: "status"});
  readonly #take_part: HTMLButtonElement;
  readonly #nav = h("nav", {class: "lesson-nav", "aria-label": texts.steps});
  readonly #where = h("p", {class: "hint"});
  readonly #intro: HTMLElement;
  readonly #begin: HTMLButtonElement;
  readonly #begin_about = h("p", {class: "hint"});
  readonly #problem = h("p", {class: "error", role: "alert"});
  readonly #body = h("div", {});
  readonly #back: HTMLButtonElement;
  readonly #next: HTMLButtonElement;
  readonly #again: HTMLButtonElement;
  readonly #ask_again: Question;
  readonly #question = h("p", {});
  #player: LessonPlayer|null = null;
  #step: {number: number; view: StepView}|null = null;
  #drafts = new Map<number, QuestionField>();

  constructor(context: PanelContext, readonly name: string, lesson: Lesson, to_list: () => void) {
    this.#context = context;
    this.#lesson = lesson;
    const {notify, server} = context;
    this.#take_part = button(column_texts.take_part, () => server.access.set_taking_part(true));
    this.#begin = guarded_button(texts.begin, notify, () => void this.#restart(), "button button-primary");
    this.#back = button(texts.back, () => this.#go(-1));
    this.#next = guarded_button(texts.next, notify, () => this.#go(1), "button button-primary");
    this.#again = guarded_button(texts.begin_again, notify, () => this.#ask());
    this.#ask_again = new Question({before: [this.#question]}, texts.do_begin_again, () => {
      this.#ask_again.close();
      void this.#restart();
    }, () => this.#again);
    const handout = button(texts.handout, () => void print_handout(lesson), {title: texts.handout_help});
    this.#intro =
      h("section", {class: "lesson-step"}, h("h4", {}, texts.goals),
        h("ul", {}, ...lesson.goals.map((goal) => h("li", {}, goal))), h("h4", {}, texts.needs),
        h("p", {}, lesson.needs), this.#begin_about, row(this.#begin), this.#problem);
    this.element = h(
      "div", {class: "panel"}, row(button(texts.all, to_list, {class: "link"}), h("span", {class: "grow"}), handout),
      h("h2", {}, lesson.title), row(this.#why, this.#take_part), this.#elsewhere, this.#nav, this.#where, this.#intro,
      this.#body, h("div", {class: "row lesson-turn"}, this.#back, h("span", {class: "grow"}), this.#next),
      row(this.#again), this.#ask_again.element);
    this.#make_nav();
  }

  close(): void {
    this.#player?.close();
  }

  refresh(): void {
    const {server} = this.#context, world = this.#context.world(), player = this.#player;
    if (player === null || (player.state === "not begun" && player.world !== world.name)) {
      this.#play_in(world.name);
      return;
    }
    const why = player.info === null ? texts.no_world : player.why_not, frozen = player.info?.frozen === true;
    const is_begun = player.state === "begun";
    set_text(this.#why, why === "" ? "" : frozen ? why : texts.read_only(why));
    this.#take_part.hidden = why === "" || server.access.taking_part || !server.access.may_take_part;
    this.#show_elsewhere(player, world.name);
    if (!is_begun && why === "") {
      this.#step = null; // the user reads no longer, but can begin
    }
    const is_intro = !is_begun && this.#step === null;
    this.#intro.hidden = !is_intro;
    this.#body.hidden = is_intro;
    set_text(this.#begin_about, why === "" ? texts.begin_about(player.world) : "");
    set_allowed(this.#begin, why || (player.is_busy || player.state === "reading" ? texts.loading : ""));
    set_text(this.#problem, player.problem);
    if (is_begun && this.#step?.number !== player.step) {
      this.#show_step(player.step);
    }
    this.#step?.view.refresh(world);
    this.#show_turn(player, is_intro);
    this.#again.hidden = !is_begun;
    set_allowed(this.#again, why || (player.is_busy ? texts.loading : ""));
  }

  // ---- parts ----

  #play_in(world: string): void {
    if (world !== "" || this.#player === null) {
      this.#player?.close();
      this.#step = null;
      this.#drafts.clear();
      this.#player = new LessonPlayer(this.#context.server, world, this.name, this.#lesson, () => this.refresh());
      this.refresh();
    }
  }

  #show_elsewhere(player: LessonPlayer, shown: string): void {
    this.#elsewhere.hidden = player.world === shown || player.info === null;
    if (!this.#elsewhere.hidden && this.#elsewhere.childElementCount === 0) {
      this.#elsewhere.append(
        texts.elsewhere(player.world), " ",
        button(texts.show_world, () => this.#context.world().show(player.world), {class: "link"}));
    }
  }

  #make_nav(): void {
    this.#nav.append(
      ...this.#lesson.steps.map(({title}, i) => button(String(i + 1), () => this.#to(i), {
                                  class: "button lesson-number",
                                  title,
                                  "aria-label": `${texts.step_of(i + 1, this.#lesson.steps.length)}: ${title}`
                                })));
  }

  #show_turn(player: LessonPlayer, is_intro: boolean): void {
    const {steps} = this.#lesson, shown = this.#step?.number ?? -1, is_begun = player.state === "begun";
    const why = is_intro ? "" : why_not_next(player, shown);
    this.#back.hidden = shown < 0 || (shown === 0 && is_begun);
    this.#next.hidden = shown === steps.length - 1 || (is_intro && player.why_not === "");
    set_allowed(this.#next, why);
    set_text(this.#where, shown < 0 ? "" : texts.step_of(shown + 1, steps.length));
    [...this.#nav.children].forEach((number, i) => {
      set_attribute(number, "aria-current", i === shown ? "step" : null);
      set_attribute(
        number, "data-done", is_begun && player.course.phase(i) === "done" && i < player.course.open ? "" : null);
      (number as HTMLButtonElement).disabled = is_begun ? i > player.course.open : is_intro && player.why_not === "";
    });
  }

  #show_step(number: number): void {
    const had_focus = this.element.contains(document.activeElement);
    this.#step = {number, view: new StepView(this.#player!, number, this.#context.notify, this.#drafts)};
    this.#body.replaceChildren(this.#step.view.element);
    if (had_focus) {
      this.#step.view.heading.focus({preventScroll: true});
      this.element.scrollIntoView({block: "start"});
    }
  }

  // ---- what the user does ----

  #go(by: number): void {
    this.#to((this.#step?.number ?? -1) + by);
  }

  #to(number: number): void {
    const player = this.#player!;
    if (player.state === "begun") {
      player.show(number);
    } else if (number < 0) {
      this.#step = null;
      this.refresh();
    } else {
      this.#show_step(number);
      this.refresh();
    }
  }

  async #restart(): Promise<void> {
    const player = this.#player!;
    await player.begin();
    if (player.problem === "") {
      this.#step = null;
      this.#drafts.clear();
      this.refresh();
    }
  }

  #ask(): void {
    set_text(this.#question, texts.ask_begin_again(this.#player!.world));
    this.#ask_again.open();
  }
}
