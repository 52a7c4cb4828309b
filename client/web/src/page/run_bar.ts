// RunBar: the controls of the shown world that are always in reach: run and pause, one generation, replay, fork, speed.
import {both_texts} from "../texts/both";
import {run_bar_texts as texts} from "../texts/run_bar";
import {speed_text} from "../texts/states";
import {guarded_button, set_allowed, set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {both_state, run_or_pause_both} from "../world/run_both";
import {speed_max} from "../world/run_control";

import type {ViewedWorld} from "../world/world";
import type {PanelContext} from "../world/panel_context";

const slider_min = 0.1; // times real time; + and − reach the whole range of the server
const slider_steps = 100; // 1, 10 and 100 times real time are steps

export class RunBar {
  readonly element: HTMLElement;

  #run: HTMLButtonElement;
  #both: HTMLButtonElement; // if two worlds are shown
  #generation: HTMLButtonElement;
  #replay: HTMLButtonElement;
  #fork: HTMLButtonElement;
#new : HTMLButtonElement;
  #slower: HTMLButtonElement;
  #faster: HTMLButtonElement;
  #slider: HTMLInputElement;
  #value = h("output", {class: "speed-value"});
  #max: HTMLButtonElement;
  #speed: HTMLElement;
  #slowed = h("p", {class: "hint"});
  #dragged = false;
  #sent_at = 0;

  readonly #context: PanelContext;

  constructor(context: PanelContext) {
    this.#context = context;
    const button = (label: string, act: (world: ViewedWorld) => void, classes?: string): HTMLButtonElement =>
      guarded_button(label, context.notify, () => act(context.world()), classes);
    this.#run =
      button(texts.run, (world) => this.#attempt(() => world.control.pause_or_resume()), "button button-primary run");
    this.#both = button(both_texts.run, () => void run_or_pause_both(context), "button both");
    this.#generation = button(texts.generation(false), (world) => this.#attempt(() => world.control.run(1)));
    this.#replay = button(texts.replay, (world) => toggle_replay(context, world));
    this.#fork = button(texts.fork, () => void context.fork());
    this.#new = button(texts.create, () => context.open("worlds", {create: true}), "button new");
    this.#slower = button("−", (world) => this.#attempt(() => world.control.multiply_speed(0.5)), "button square");
    this.#faster = button("+", (world) => this.#attempt(() => world.control.multiply_speed(2)), "button square");
    this.#max = button(texts.max, (world) => this.#attempt(() => world.control.toggle_max_speed()));
    this.#slower.setAttribute("aria-label", texts.slower);
    this.#faster.setAttribute("aria-label", texts.faster);
    this.#slider = h("input", {
      type: "range",
      class: "grow",
      min: 0,
      max: slider_steps,
      step: 1,
      "aria-label": texts.slider,
      oninput: () => this.#drag(),
      onchange: () => this.#drop(),
    });
    this.#speed =
      h("div", {class: "row speed"}, h("span", {}, texts.speed), this.#slower, this.#slider, this.#faster, this.#value,
        this.#max);
    this.element =
      h("div", {class: "run-bar"},
        h("div", {class: "row"}, this.#run, this.#both, this.#generation, this.#replay, this.#fork, this.#new),
        this.#speed, this.#slowed);
  }

  refresh(): void {
    const world = this.#context.world(), server = world.server, info = world.info;
    const why_control =
      !world.shown || !(world.snapshot || info) ? texts.no_world : server.access.why_not("pause", world.shown);
    const why_run = why_control ||
      (world.control.state === "RUN_STATE_TERMINATED" ? texts.has_ended :
         world.control.at_end                         ? texts.end_of_replay :
                                                        "");
    set_text(
      this.#run,
      world.control.state === "RUN_STATE_RUNNING"  ? texts.pause :
        world.control.state === "RUN_STATE_PAUSED" ? texts.resume :
                                                     texts.run);
    set_allowed(this.#run, why_run, texts.run_help);
    const both = both_state(this.#context);
    this.#both.hidden = both === null;
    set_text(this.#both, both?.is_pause ? both_texts.pause : both_texts.run);
    set_allowed(this.#both, both?.why_not ?? "", both_texts.run_help);
    set_text(this.#generation, texts.generation(world.has_births));
    set_allowed(this.#generation, why_run, texts.generation_help(world.has_births));
    set_text(this.#replay, world.past.is_own_replay ? texts.live : texts.replay);
    set_allowed(
      this.#replay, world.past.is_own_replay ? "" : world.past.problem,
      world.past.is_own_replay ? texts.live_help : texts.replay_help);
    const why_create = server.access.why_not("create_world");
    const {membership} = server.access;
    set_text(this.#fork, membership ? texts.what_if : texts.fork);
    set_allowed(this.#fork, !info ? texts.no_world : server.access.why_not("fork_world", world.shown), texts.fork_help);
    this.#new.hidden = membership !== null;
    set_allowed(this.#new, why_create, texts.create_help);
    const why_speed = why_control && (server.access.why_not("set_speed", world.shown) || why_control),
          max = world.control.speed?.max === true;
    set_attribute(this.#speed, "data-allowed", String(why_speed === "")); // without permission, it takes room in vain
    set_allowed(this.#slower, why_speed, texts.slower_help);
    set_allowed(this.#faster, why_speed || (max ? texts.is_fastest : ""), texts.faster_help);
    set_allowed(this.#max, why_speed, texts.max_help);
    set_attribute(this.#max, "aria-pressed", String(max));
    this.#slider.disabled = why_speed !== "" || max;
    this.#slider.title = why_speed;
    if (!this.#dragged && performance.now() > this.#sent_at + 400) {
      this.#slider.value = String(position_of(world.control.factor));
      this.#say(max ? "max" : speed_text({real_time_factor: world.control.factor}));
    }
    set_text(this.#slowed, world.snapshot?.slowed ? texts.slowed : "");
  }

  #say(text: string): void {
    set_text(this.#value, text);
    set_attribute(
      this.#slider, "aria-valuetext", text === "max" ? texts.max_value : texts.value(text.replace("×", "")));
  }

  #drag(): void {
    this.#dragged = true;
    this.#say(speed_text({real_time_factor: factor_at(Number(this.#slider.value))}));
  }

  #drop(): void {
    this.#dragged = false;
    this.#sent_at = performance.now();
    const world = this.#context.world(), factor = factor_at(Number(this.#slider.value));
    this.#attempt(() => world.control.set_speed({real_time_factor: factor}));
  }

  #attempt(what: () => Promise<unknown>): void {
    void this.#context.attempt(what);
  }
}

/** Opens a replay at the beginning of the shown generation, or returns to the live world. */
export function toggle_replay(context: PanelContext, world: ViewedWorld): void {
  void context.attempt(
    () => (world.past.is_own_replay ? world.past.back_to_live() : world.past.show(world.snapshot?.generation ?? 1)));
}

/** The speed at a position of the slider, in two significant digits, so that 1 and 10 are easy to hit. */
function factor_at(position: number): number {
  const exact = slider_min * Math.pow(speed_max / slider_min, position / slider_steps);
  return Number(exact.toPrecision(exact < 0.95 ? 1 : 2));
}

function position_of(factor: number): number {
  const share = Math.log(Math.max(factor, slider_min) / slider_min) / Math.log(speed_max / slider_min);
  return Math.round(slider_steps * Math.min(1, share));
}
