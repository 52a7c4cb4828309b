// Glass box panel: shows step by step how a generation was bred, next to the law of its selection method, and why the
// means of the genes changed. While it is visible, it requests the breeding of each new generation, or of the
// generation that the user chose.
import {breeding_summary} from "../breeding/caption";
import {BreedingFeed} from "../breeding/feed";
import {glass_box_texts} from "../texts/glass_box";
import {h, set_text} from "../widgets/dom";
import {button, check, row} from "../widgets/form";
import type {Panel, PanelContext} from "../world/panel_context";
import type {ViewedWorld} from "../world/world";
import {BetControls} from "./glass_box_bets";
import {HoldControl} from "./glass_box_hold";
import {StepControls} from "./glass_box_steps";
import {GlassBoxTabs} from "./glass_box_tabs";
import {OriginNote} from "./origin_note";
import {Width} from "./width";

export class GlassBoxPanel implements Panel {
  readonly name = "glass box";
  readonly title = glass_box_texts.title;
  readonly element: HTMLElement;

  readonly #steps = new StepControls(() => this.refresh());
  readonly #bets = new BetControls((chosen) => {
    if (chosen) {
      this.#tabs.forget();
    }
    this.refresh();
  });
  readonly #tabs = new GlassBoxTabs(this.#steps, this.#bets, () => this.refresh());
  readonly #feed: BreedingFeed;
  readonly #hold: HoldControl;

  // ---- elements ----
  readonly #generation: HTMLInputElement = h("input", {
    class: "field glass-generation",
    type: "number",
    min: 1,
    step: 1,
    "aria-label": glass_box_texts.generation_label,
    onchange: () => this.#choose(Number(this.#generation.value), null)
  });
  readonly #follow: HTMLInputElement = h("input", {type: "checkbox", checked: true, onchange: () => this.refresh()});
  readonly #play_each: HTMLInputElement = h("input", {type: "checkbox"});
  readonly #birth = button(glass_box_texts.birth, () => this.#go_to_birth());
  readonly #choices: HTMLElement;
  readonly #messages: Messages;
  readonly #body: HTMLElement;
  readonly #width: Width;
  readonly #context: PanelContext;

  constructor(context: PanelContext) {
    this.#context = context;
    this.#feed = new BreedingFeed(this.#steps.stepper, {
      changed: () => this.refresh(),
      begun: (at_end) => this.#begin(at_end),
      not_picked: (organism, generation) => context.notify(glass_box_texts.not_picked(organism, generation)),
    });
    const try_again = (): void => {
      this.#feed.try_again();
      this.refresh();
    };
    this.#messages = new Messages(context, try_again, (generation) => this.show({generation}));
    this.#hold = new HoldControl(context, () => this.refresh());
    this.#body = h("div", {class: "panel"}, this.#steps.element, this.#tabs.element);
    this.#choices =
      row(
        h("span", {}, glass_box_texts.generation), this.#generation,
        check(this.#follow, glass_box_texts.follow, glass_box_texts.follow_help),
        check(this.#bets.chosen, glass_box_texts.bet, glass_box_texts.bet_help),
        check(this.#play_each, glass_box_texts.play_each, glass_box_texts.play_each_help), this.#hold.element,
        this.#birth);
    this.element =
      h("div", {
        class: "panel glass-box",
        onkeydown: (event: KeyboardEvent) => this.#feed.shown && this.#steps.press(event),
      },
        this.#choices, this.#messages.element, this.#body);
    this.#width = new Width(this.element, () => this.refresh());
  }

  /** subject  {generation, organism}: shows the first pick of this organism when its generation bred. */
  show(subject: {[key: string]: unknown}): void {
    if (typeof subject.generation === "number") {
      this.#tabs.open("step");
      this.#choose(subject.generation, typeof subject.organism === "number" ? subject.organism : null);
    }
    this.refresh();
  }

  refresh(): void {
    const world = this.#context.world(), {stepper} = this.#steps;
    this.#feed.update(world, this.#follow.checked && !this.#bets.are_open);
    this.#bets.closed ||= stepper.moment.stage !== "scaling";
    this.#hold.update(world);
    this.#draw(world);
    this.#steps.animate(this.element, () => {
      const {moment} = stepper, record = this.#feed.shown;
      return moment.stage === "picking" ? record?.picks[moment.index] !== undefined :
        moment.stage === "breeding"     ? record?.descendants[moment.index] !== undefined :
                                          record !== null;
    });
  }

  #choose(generation: number, organism: number|null): void {
    this.#follow.checked = false;
    this.#feed.choose(generation, organism);
    this.refresh();
  }

  /** The steps of another breeding begin. */
  #begin(at_end: boolean): void {
    this.#bets.begin();
    if (this.#bets.chosen.checked) {
      return; // the bets come first
    }
    if (this.#play_each.checked) {
      this.#steps.stepper.play();
    } else if (at_end) {
      this.#steps.stepper.go_to(this.#steps.stepper.last_position); // the user skipped the steps of the last breeding
    }
  }

  #go_to_birth(): void {
    const selected = this.#context.world().selection.id, {stepper} = this.#steps;
    if (this.#feed.shown && selected !== null) {
      this.#tabs.open("step");
      this.#steps.move(() => stepper.go_to(stepper.begin_of("breeding") + selected));
    }
  }

  #draw(world: ViewedWorld): void {
    const {shown, chosen, last, newest} = this.#feed;
    if (document.activeElement !== this.#generation) {
      this.#generation.value = String(chosen || "");
    }
    this.#choices.hidden = world.has_births;
    this.#generation.max = String(last || "");
    this.#generation.disabled = last === 0;
    this.#birth.hidden = !shown || world.selection.id === null || shown.key.generation !== newest ||
      world.selection.id >= shown.descendant_count;
    this.#messages.show(world, this.#feed);
    this.#body.hidden = shown === null;
    if (!shown) {
      this.#tabs.forget();
      return;
    }
    this.#steps.update();
    this.#tabs.update(world, this.#feed, shown, this.#width.within(560));
  }
}

/** Which breeding is shown, and why none is. */
class Messages {
  readonly element: HTMLElement;
  readonly #summary = h("p", {class: "hint"});
  readonly #error = h("p", {class: "error", role: "status"});
  readonly #retry: HTMLButtonElement;
  readonly #waiting = h("p", {});

  readonly #origin: OriginNote;

  constructor(context: PanelContext, try_again: () => void, on_open: (generation: number) => void) {
    this.#origin = new OriginNote(context, on_open);
    this.#retry = button(glass_box_texts.retry, try_again);
    this.element =
      h("div", {class: "panel"}, this.#summary, this.#error, this.#origin.element, this.#retry, this.#waiting);
  }

  show(world: ViewedWorld, {shown, problem, last, origin_run, chosen}: BreedingFeed): void {
    set_text(this.#error, problem && origin_run === "" ? glass_box_texts.problem(problem) : "");
    this.#retry.hidden = problem === "" || origin_run !== "";
    this.#origin.update(origin_run, chosen);
    set_text(
      this.#summary, shown ? glass_box_texts.summary(world.name, shown.key.generation, breeding_summary(shown)) : "");
    set_text(
      this.#waiting,
      shown               ? "" :
        !world.snapshot   ? glass_box_texts.no_snapshot :
        world.has_births  ? glass_box_texts.births :
        last === 0        ? glass_box_texts.nothing_bred :
        problem           ? "" :
                            glass_box_texts.loading);
    this.#waiting.hidden = shown !== null;
  }
}
