// EvolutionButton: the button that shows generation 1 next to the present. What it does is loaded when it is first
// pressed.
import type {Evolution, EvolutionContext} from "../panels/evolution";
import {evolution_button_texts as texts} from "../texts/evolution_button";
import {guarded_button, set_allowed} from "../widgets/controls";
import {set_text} from "../widgets/dom";
import type {Banner} from "../widgets/notices";

export class EvolutionButton {
  readonly element: HTMLButtonElement;
  #loaded: Evolution|null = null;
  readonly #context: EvolutionContext;
  readonly #on_change: () => void;

  /** on_change: called after banners() has changed. */
  constructor(context: EvolutionContext, on_change: () => void) {
    this.#context = context;
    this.#on_change = on_change;
    this.element = guarded_button(texts.show, context.notify, () => this.toggle(), "button show-evolution");
  }

  /** Shows generation 1 next to the present, or only the present again. */
  toggle(): void {
    const problem = this.#context.world().past.problem;
    if (problem !== "" && !this.#is_shown) {
      this.#context.notify(problem);
      return;
    }
    void this.#context.attempt(async () => {
      const {Evolution: Loaded} = await import("../panels/loaded_later");
      this.#loaded ??= new Loaded(this.#context, this.#on_change);
      this.#loaded.toggle();
    });
  }

  banners(): Banner[] {
    return this.#loaded?.banners() ?? [];
  }

  /** Shows the present state. */
  refresh(): void {
    this.#loaded?.refresh();
    const is_shown = this.#is_shown;
    set_text(this.element, is_shown ? texts.end : texts.show);
    const problem = is_shown ? "" : this.#context.world().past.problem;
    set_allowed(this.element, problem, is_shown ? texts.end_help : texts.show_help);
  }

  get #is_shown(): boolean {
    return this.#loaded?.is_shown ?? false;
  }
}
