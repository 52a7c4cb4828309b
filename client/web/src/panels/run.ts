// RunPanel: the state of the world in words; steps of ticks and generations; reset.
import {common_texts} from "../texts/common";
import {number_in} from "../texts/numbers";
import {panels_texts} from "../texts/panels";
import {run_texts as texts} from "../texts/run";
import {outcome_words, state_word} from "../texts/states";
import {guarded_button, set_allowed, set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {hint, Question, row} from "../widgets/form";

import type {Panel, PanelContext} from "../world/panel_context";

const count_max = 1e12; // ticks or generations per command
const seed_max = (1n << 64n) - 1n;

export class RunPanel implements Panel {
  readonly name = "run";
  readonly title = panels_texts.run;
  readonly element: HTMLElement;

  #state = h("p", {});
  #waits = h("p", {class: "warning"});
  #where = h("p", {class: "hint"});
  #ticks = h("input", {class: "field count", inputmode: "numeric", value: "60", "aria-label": texts.ticks});
  #generations = h("input", {class: "field count", inputmode: "numeric", value: "10", "aria-label": texts.generations});
  #seed =
    h("input", {class: "field grow", inputmode: "numeric", placeholder: texts.seed_hint, "aria-label": texts.seed});
  #count_error = h("p", {class: "error", role: "alert"});
  #seed_error = h("p", {class: "error", role: "alert"});
  #one: HTMLButtonElement;
  #step: HTMLButtonElement;
  #run: HTMLButtonElement;
  #reset: HTMLButtonElement;
  #confirm: Question;
  #question = h("p", {});

  readonly #context: PanelContext;

  constructor(context: PanelContext) {
    this.#context = context;
    const {notify} = context;
    this.#one = guarded_button(texts.one_tick, notify, () => this.#attempt(() => context.world().control.step(1)));
    this.#step = guarded_button(
      texts.step, notify,
      () => this.#with_number(texts.of_ticks, this.#ticks, (ticks) => context.world().control.step(ticks)));
    this.#run = guarded_button(
      texts.run, notify,
      () => this.#with_number(texts.of_generations, this.#generations, (count) => context.world().control.run(count)));
    this.#reset = guarded_button(texts.reset, notify, () => this.#ask());
    this.#confirm = new Question({before: [this.#question]}, texts.do_reset, () => this.#do_reset(), () => this.#reset);
    this.element =
      h("div", {class: "panel panel-run"}, this.#state, this.#waits, this.#where, row(this.#one),
        row(this.#ticks, this.#step), row(this.#generations, this.#run), this.#count_error,
        h("h3", {}, texts.reset_title), hint(texts.reset_about), row(this.#seed, this.#reset), this.#seed_error,
        this.#confirm.element);
  }

  refresh(): void {
    const world = this.#context.world(), server = world.server, info = world.info;
    if (!info) {
      set_text(this.#state, common_texts.no_world_yet);
    } else {
      let state = world.control.at_end ?
        common_texts.end_of_replay :
        state_word(world.control.state, server.storage, info.awaited_fitness !== undefined);
      if (world.control.state === "RUN_STATE_TERMINATED") {
        state = texts.ended(state, outcome_words(info.outcome));
      } else if (info.run_until_generation !== undefined && world.control.state === "RUN_STATE_RUNNING") {
        state = texts.until(state, info.run_until_generation);
      }
      set_text(this.#state, texts.state(world.shown, state));
    }
    const awaited = info?.awaited_fitness;
    const islands = info?.island_count ?? 1, rated = islands - (awaited?.islands?.length ?? 0);
    set_text(this.#waits, awaited ? texts.waits(rated, islands) : "");
    const generation = world.snapshot?.generation ?? null;
    set_text(this.#where, info ? texts.where(generation, world.feed.tick, info.seed ?? 0) : "");
    const why_run = !info ? common_texts.no_world :
                            server.access.why_not("run", world.shown) || (world.control.is_over ? texts.has_ended : "");
    set_allowed(this.#one, why_run, texts.one_tick_help);
    set_allowed(this.#step, why_run, texts.step_help);
    set_allowed(this.#run, why_run, texts.run_help);
    const why_reset = !info ? common_texts.no_world :
      world.is_replay       ? common_texts.replay_cannot_change :
                              server.access.why_not("reset_world", world.shown);
    set_allowed(this.#reset, why_reset);
    this.#seed.disabled = why_reset !== "";
    if (why_reset) {
      this.#confirm.element.hidden = true;
    }
  }

  #attempt(what: () => Promise<unknown>): void {
    void this.#context.attempt(what);
  }

  #with_number(name: string, field: HTMLInputElement, act: (number: number) => Promise<void>): void {
    const number = number_in(name, field.value, 1, count_max), wrong = typeof number === "string";
    set_text(this.#count_error, wrong ? number : "");
    for (const one of [this.#ticks, this.#generations]) {
      set_attribute(one, "aria-invalid", wrong && one === field ? "true" : null);
    }
    if (!wrong) {
      this.#attempt(() => act(number));
    }
  }

  #ask(): void {
    const text = this.#seed.value.trim(), wrong = text !== "" && !(/^\d{1,20}$/.test(text) && BigInt(text) <= seed_max);
    set_text(this.#seed_error, wrong ? common_texts.wrong_seed(text, seed_max) : "");
    set_attribute(this.#seed, "aria-invalid", wrong ? "true" : null);
    if (!wrong) {
      set_text(this.#question, texts.ask_reset(this.#context.world().name, text));
      this.#confirm.open();
    }
  }

  #do_reset(): void {
    const world = this.#context.world(), seed = this.#seed.value.trim();
    this.#confirm.close();
    this.#attempt(
      () => world.server.request("reset_world", {world: world.name, ...(seed ? {seed: BigInt(seed)} : {})}));
  }
}
