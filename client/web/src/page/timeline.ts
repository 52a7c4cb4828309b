// Timeline: the strip below an island: the generations of the run from the first to the present. The user drags along
// the line to show the past in a replay, plays the replay, and returns to the live world. Marks show changes of
// parameters and extinctions.
//
// Owner    PaneArea; one per pane.
import {timeline_buttons as texts, timeline_texts} from "../texts/timeline";
import {guarded_button, set_allowed, set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import type {Notify} from "../widgets/notices";
import type {Moment} from "../world/time_scale";
import type {ViewedWorld} from "../world/world";
import {GenerationField} from "./generation_field";
import {Seeker} from "./seeker";
import {TimeSlider} from "./time_slider";

const zoom_factor = 2;

export interface TimelineContext {
  notify: Notify;
  attempt(what: () => Promise<unknown>): Promise<boolean>;
  copy_link(world: ViewedWorld): void;
}

export class Timeline {
  readonly element: HTMLElement;

  readonly #world: ViewedWorld;
  readonly #slider: TimeSlider;
  readonly #field: GenerationField;
  readonly #problem = h("p", {class: "hint grow"});
  readonly #place = h("span", {class: "time-place hint"});
  readonly #first: HTMLButtonElement;
  readonly #previous: HTMLButtonElement;
  readonly #play: HTMLButtonElement;
  readonly #next: HTMLButtonElement;
  readonly #last: HTMLButtonElement;
  readonly #live: HTMLButtonElement;
  readonly #zoom: readonly HTMLButtonElement[]; // out, in, all
  readonly #buttons: HTMLElement;
  readonly #end: () => void;

  constructor(world: ViewedWorld, context: TimelineContext) {
    this.#world = world;
    const seeker = new Seeker(world, context.attempt, () => this.#slider.seek_ended());
    this.#slider = new TimeSlider(world, seeker);
    this.#field = new GenerationField(world, seeker);
    const button = (of: {label: string; name?: string}, act: () => unknown, classes = ""): HTMLButtonElement => {
      const made = guarded_button(of.label, context.notify, () => void act(), `button ${classes}`);
      set_attribute(made, "aria-label", of.name ?? null);
      return made;
    };
    const attempt = (what: () => Promise<unknown>) => (): unknown => context.attempt(what);
    this.#first = button(texts.first, () => seeker.go_to_first(), "square time-end");
    this.#previous = button(texts.previous, attempt(() => world.past.move_generations(-1)), "square");
    this.#play = button(texts.play, attempt(() => world.control.pause_or_resume()), "time-play");
    this.#next = button(texts.next, attempt(() => world.past.move_generations(1)), "square");
    this.#last = button(texts.last, () => seeker.go({}), "square time-end");
    this.#live = button(texts.live, attempt(() => world.past.back_to_live()), "time-live");
    this.#zoom = [
      button(texts.zoom_out, () => this.#slider.zoom(1 / zoom_factor), "square"),
      button(texts.zoom_in, () => this.#slider.zoom(zoom_factor), "square"),
      button(texts.show_all, () => this.#slider.show_all(), "time-all")
    ];
    this.#zoom.forEach((one) => one.addEventListener("click", () => this.#refresh()));
    const copy =
      h("button",
        {type: "button", class: "button time-copy", title: texts.copy.help, onclick: () => context.copy_link(world)},
        texts.copy.label);
    this.#buttons =
      h("div", {class: "time-buttons"}, this.#first, this.#previous, this.#play, this.#next, this.#last,
        this.#field.element, this.#place);
    this.element = h(
      "div", {class: "timeline", role: "group", "aria-label": timeline_texts.name}, this.#buttons, this.#slider.element,
      h("div", {class: "time-buttons time-zoom", role: "group", "aria-label": timeline_texts.zoom}, ...this.#zoom),
      this.#problem, h("div", {class: "time-buttons time-right"}, this.#live, copy), this.#field.wrong);
    this.#end = world.changes.listen(() => this.#refresh());
    this.#refresh();
  }

  close(): void {
    this.#end();
    this.#slider.close();
  }

  #refresh(): void {
    const world = this.#world, {past: {range}, snapshot} = world;
    this.element.hidden = !world.name;
    set_attribute(this.element, "data-past", String(world.is_replay));
    const problem = world.past.is_own_replay || !range ? "" : world.past.problem;
    set_text(this.#problem, problem);
    this.#slider.element.hidden = this.#buttons.hidden = this.#live.hidden = problem !== "";
    this.#refresh_buttons(problem);
    if (snapshot && range) {
      const ticks = world.past.ticks_of(snapshot.generation), count = ticks ? ticks.last - ticks.first : 0;
      const tick = world.is_replay && count >= snapshot.generation_tick ?
        timeline_texts.tick_of(snapshot.generation_tick, count) :
        timeline_texts.tick(snapshot.generation_tick);
      set_text(this.#place, world.past.target ? timeline_texts.going_to(moment_text(world.past.target)) : tick);
    }
    this.#field.refresh();
    this.#slider.refresh();
  }

  #refresh_buttons(problem: string): void {
    const world = this.#world, {snapshot, past: {range}} = world, generation = snapshot?.generation ?? 1;
    const is_running = world.is_replay && world.control.state === "RUN_STATE_RUNNING";
    const why = !world.is_replay ? timeline_texts.is_live_help :
      world.past.is_own_replay   ? "" :
                                   world.server.access.why_not("seek", world.shown);
    const is_first = range !== null && generation <= range.first_generation && snapshot?.generation_tick === 0;
    const is_last = range !== null && generation >= range.last_generation;
    set_text(this.#play, is_running ? texts.pause.label : texts.play.label);
    set_allowed(this.#play, why || (world.control.at_end ? timeline_texts.is_end : ""), texts.play.help);
    set_allowed(this.#first, problem || (range ? "" : timeline_texts.no_world), texts.first.help);
    set_allowed(this.#previous, problem || (is_first ? timeline_texts.is_first : ""), texts.previous.help);
    set_allowed(this.#next, why || (is_last ? timeline_texts.is_last : ""), texts.next.help);
    set_allowed(this.#last, why, texts.last.help);
    const [out, closer, all] = this.#zoom, is_whole = this.#slider.is_zoomed ? "" : texts.is_whole;
    set_allowed(out!, is_whole, texts.zoom_out.help);
    set_allowed(closer!, range ? "" : timeline_texts.no_world, texts.zoom_in.help);
    set_allowed(all!, is_whole, texts.show_all.help);
    set_allowed(this.#live, world.past.is_own_replay ? "" : timeline_texts.is_live, texts.live.help);
  }
}

function moment_text({generation, tick}: Moment): string {
  return generation !== undefined ? timeline_texts.generation(generation) :
    tick !== undefined            ? timeline_texts.tick(tick) :
                                    timeline_texts.last_tick;
}
