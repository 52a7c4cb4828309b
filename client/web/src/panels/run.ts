// RunPanel: the state of the world in words; steps of ticks and generations; reset.
import {number_in, with_separators} from "../texts/numbers";
import {outcome_words, state_word} from "../texts/texts";
import {guarded_button, set_allowed, set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";

import type {Panel, PanelContext} from "../world/panel_context";

const count_max = 1e12; // ticks or generations per command
const seed_max = (1n << 64n) - 1n;

export class RunPanel implements Panel {
  readonly name = "run";
  readonly title = "Run";
  readonly element: HTMLElement;

  #state = h("p", {});
  #waits = h("p", {class: "warning"});
  #where = h("p", {class: "hint"});
  #ticks = h("input", {class: "field count", inputmode: "numeric", value: "60", "aria-label": "Ticks"});
  #generations = h("input", {class: "field count", inputmode: "numeric", value: "10", "aria-label": "Generations"});
  #seed =
    h("input", {class: "field grow", inputmode: "numeric", placeholder: "empty: the same seed", "aria-label": "Seed"});
  #count_error = h("p", {class: "error", role: "alert"});
  #seed_error = h("p", {class: "error", role: "alert"});
  #one: HTMLButtonElement;
  #step: HTMLButtonElement;
  #run: HTMLButtonElement;
  #reset: HTMLButtonElement;
  #confirm: HTMLElement;
  #question = h("p", {});

  readonly #context: PanelContext;

  constructor(context: PanelContext) {
    this.#context = context;
    const {notify} = context;
    this.#one = guarded_button("One tick", notify, () => this.#attempt(() => context.world().control.step(1)));
    this.#step = guarded_button(
      "Step ticks", notify,
      () => this.#with_number("ticks", this.#ticks, (ticks) => context.world().control.step(ticks)));
    this.#run = guarded_button(
      "Run generations", notify,
      () => this.#with_number("generations", this.#generations, (count) => context.world().control.run(count)));
    this.#reset = guarded_button("Reset …", notify, () => this.#ask());
    this.#confirm =
      h("div", {class: "confirm", hidden: true}, this.#question,
        h("div", {class: "row"},
          h("button", {type: "button", class: "button button-danger", onclick: () => this.#do_reset()},
            "Reset the world"),
          h("button", {type: "button", class: "button", onclick: () => this.#close()}, "Cancel")));
    this.element =
      h("div", {class: "panel panel-run"}, this.#state, this.#waits, this.#where, h("div", {class: "row"}, this.#one),
        h("div", {class: "row"}, this.#ticks, this.#step), h("div", {class: "row"}, this.#generations, this.#run),
        this.#count_error, h("h3", {}, "Reset"),
        h("p", {class: "hint"}, "Starts a new run at generation 1 with the current parameter settings."),
        h("div", {class: "row"}, this.#seed, this.#reset), this.#seed_error, this.#confirm);
  }

  refresh(): void {
    const world = this.#context.world(), server = world.server, info = world.info;
    if (!info) {
      set_text(this.#state, "No world is open yet.");
    } else {
      let state = world.control.at_end ?
        "end of the replay" :
        state_word(world.control.state, server.storage, info.awaited_fitness !== undefined);
      if (world.control.state === "RUN_STATE_TERMINATED") {
        state += `: ${outcome_words(info.outcome)}`;
      } else if (info.run_until_generation !== undefined && world.control.state === "RUN_STATE_RUNNING") {
        state += ` until generation ${with_separators(info.run_until_generation)}`;
      }
      set_text(this.#state, `${world.shown}: ${state}`);
    }
    const awaited = info?.awaited_fitness;
    const islands: number = info?.island_count ?? 1, rated = islands - (awaited?.islands?.length ?? 0);
    set_text(
      this.#waits,
      awaited ?
        `Waits for fitness from a client; ${rated} of ${islands} ${islands === 1 ? "island" : "islands"} rated` :
        "");
    const generation = world.snapshot ? `generation ${with_separators(world.snapshot.generation)}, ` : "";
    set_text(
      this.#where, info ? `${generation}tick ${with_separators(world.feed.tick)}, seed ${String(info.seed ?? 0)}` : "");
    const why_run = !info ? "No world is open." :
                            server.why_not("run", world.shown) || (world.control.is_over ? "The run has ended." : "");
    set_allowed(this.#one, why_run, "Runs one tick, then pauses (.).");
    set_allowed(this.#step, why_run, "Runs this many ticks, then pauses.");
    set_allowed(this.#run, why_run, "Runs this many generations to their end, then waits.");
    const why_reset = !info ? "No world is open." :
      world.is_replay       ? "This world is a replay and cannot be changed." :
                              server.why_not("reset_world", world.shown);
    set_allowed(this.#reset, why_reset);
    this.#seed.disabled = why_reset !== "";
    if (why_reset) {
      this.#confirm.hidden = true;
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
    set_text(
      this.#seed_error,
      wrong ? `seed: got "${text}", allowed whole numbers from 0 to ${with_separators(seed_max)}` : "");
    set_attribute(this.#seed, "aria-invalid", wrong ? "true" : null);
    if (!wrong) {
      set_text(
        this.#question,
        `Restart ${this.#context.world().name} at generation 1 ${text ? `with seed ${text}` : "with the same seed"}?`);
      this.#confirm.hidden = false;
      this.#confirm.querySelector("button")!.focus();
    }
  }

  #close(): void {
    this.#confirm.hidden = true;
    this.#reset.focus();
  }

  #do_reset(): void {
    const world = this.#context.world(), seed = this.#seed.value.trim();
    this.#close();
    this.#attempt(
      () => world.server.request("reset_world", {world: world.name, ...(seed ? {seed: BigInt(seed)} : {})}));
  }
}
