// SecondWorld: the list from which the user chooses what is shown next to the present world: another world, the past of
// this one, or a new fork. The present world keeps the focus.
import {capitalised, number_in} from "../texts/numbers";
import {second_world_texts as texts} from "../texts/second_world";
import {state_word} from "../texts/states";
import {Dialog, guarded_button, set_allowed, set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";

import type {PanelContext} from "../world/panel_context";
import type {ViewedWorld} from "../world/world";

export interface SecondWorldContext extends PanelContext {
  /** Shows a second world without moving the focus. */
  show_second(world: string, island?: number): ViewedWorld;
}

interface Choice {
  label: string;
  hint: string;
  why_not?: string;
  act(): void;
}

export class SecondWorld {
  readonly #context: SecondWorldContext;
  readonly #dialog = new Dialog(texts.title, "second-world");
  readonly #generation = h("input", {class: "field time-generation", inputmode: "numeric", autocomplete: "off"});
  readonly #wrong = h("p", {class: "error", role: "alert"});

  constructor(context: SecondWorldContext) {
    this.#context = context;
  }

  open(): void {
    const world = this.#context.world(), {server} = world;
    const others = server.worlds.names.filter((name) => name !== world.name);
    const choices: Choice[] = others.map((name) => {
      const info = server.worlds.find(name);
      const hint =
        info === null ? texts.damaged : texts.world_hint(info.generation, state_word(info.state, info.storage));
      return {label: name, hint, act: () => void this.#context.show_second(name)};
    });
    choices.sort((one, other) => Number(other.label === world.past.forked) - Number(one.label === world.past.forked));
    if (world.past.is_own_replay) {
      const show_live = (): unknown => this.#context.show_second(world.name, world.island);
      choices.unshift({label: texts.live(world.name), hint: texts.live_hint, act: () => void show_live()});
    }
    const fork: Choice = {
      label: texts.fork(world.name),
      hint: texts.fork_hint,
      why_not: server.access.why_not("fork_world", world.shown),
      act: () => void this.#context.fork(),
    };
    set_text(this.#wrong, "");
    this.#generation.value = "1";
    this.#dialog.body.replaceChildren(
      h("div", {class: "second-worlds"}, ...choices.map((choice) => this.#button(choice)), this.#past(),
        this.#button(fork)));
    this.#dialog.open();
    this.#dialog.body.querySelector("button")?.focus();
  }

  #button({label, hint, why_not = "", act}: Choice): HTMLElement {
    const button = guarded_button("", this.#context.notify, () => {
      this.#dialog.close();
      act();
    }, "button second-choice");
    button.append(h("strong", {}, label), h("span", {class: "hint"}, why_not || hint));
    set_allowed(button, why_not);
    return button;
  }

  /** A generation of the present world; the user may type another number. */
  #past(): HTMLElement {
    const world = this.#context.world(), {problem} = world.past, label = h("strong", {}, texts.past(1, world.name));
    const last = world.past.range?.last_generation ?? 1;
    set_attribute(this.#generation, "aria-label", texts.generation);
    this.#generation.oninput = () => {
      const typed = this.#typed(last);
      set_text(this.#wrong, typeof typed === "string" ? capitalised(typed) : "");
      set_text(label, texts.past(typeof typed === "number" ? typed : 1, world.name));
    };
    const show = guarded_button("", this.#context.notify, () => {
      const generation = this.#typed(last);
      if (typeof generation === "number") {
        this.#dialog.close();
        const past = this.#context.show_second(world.name, world.island);
        void this.#context.attempt(() => past.past.show_nearest({generation}));
      }
    }, "button second-choice grow");
    show.append(label, h("span", {class: "hint"}, problem || texts.past_hint));
    set_allowed(show, problem);
    this.#generation.onkeydown = (event) => {
      if (event.key === "Enter") {
        event.preventDefault();
        show.click();
      }
    };
    this.#generation.disabled = problem !== "";
    return h("div", {}, h("div", {class: "row second-past"}, show, this.#generation), this.#wrong);
  }

  #typed(last: number): number|string {
    return number_in(texts.generation, this.#generation.value, 1, last);
  }
}
