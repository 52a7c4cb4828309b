// HoldControl: the choice "hold the world" of the glass box. See breeding/generation_hold.ts.
import {GenerationHold} from "../breeding/generation_hold";
import {glass_box_texts} from "../texts/glass_box";
import {h} from "../widgets/dom";
import {check} from "../widgets/form";
import type {PanelContext} from "../world/panel_context";
import type {ViewedWorld} from "../world/world";

export class HoldControl {
  readonly element: HTMLElement;
  readonly #held: HTMLInputElement;
  readonly #holder = new GenerationHold();
  readonly #context: PanelContext;

  constructor(context: PanelContext, changed: () => void) {
    this.#context = context;
    this.#held = h("input", {
      type: "checkbox",
      onchange: () => {
        if (this.#held.checked) {
          this.#holder.hold(run_of(context.world()));
        } else {
          this.#holder.release();
        }
        changed();
      }
    });
    this.element = check(this.#held, glass_box_texts.hold, glass_box_texts.hold_help);
  }

  /** Sends the command that the hold needs now. */
  update(world: ViewedWorld): void {
    const {access} = world.server;
    const may = !world.is_replay && access.why_not("run", world.shown) === "" &&
      access.why_not("run_until_tick", world.shown) === "";
    if (!may) {
      this.#holder.release();
    }
    this.element.hidden = !may;
    const action =
      this.#holder.update(run_of(world), world.info?.state ?? "", world.info?.run_until_tick !== undefined);
    this.#held.checked = this.#holder.on;
    if (action !== "none") {
      void this.#context.attempt(() => action === "step one tick" ? world.control.step(1) : world.control.run(1));
    }
  }
}

/** Identifies the held run. A replay has the same run id as the run that it shows, but its own world name. */
function run_of(world: ViewedWorld): string {
  return `${world.shown} ${world.snapshot?.run_id ?? ""}`;
}
