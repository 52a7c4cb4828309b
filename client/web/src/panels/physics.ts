// Physics panel: energy, momentum, contacts, overlaps and speeds of the bodies of the shown island over the ticks, and
// whether the tick is short enough for them.
//
// Polling  while the panel is visible, GetMotion is sent after changes of the world, at most 4 times per second.
import {LinkedX} from "../plots/linked_x";
import {judge_tick, measures, motion_figure, MotionHistory} from "../plots/motion";
import type {TickVerdict} from "../plots/motion";
import {Plot} from "../plots/plot";
import {physics_texts as texts} from "../texts/physics";
import {h, set_text} from "../widgets/dom";
import {hint} from "../widgets/form";
import type {Panel, PanelContext} from "../world/panel_context";

const poll_ms = 250, retry_ms = 5000; // after a refused request
const plot_height = 124; // CSS pixels

const verdict_classes: {readonly[level in TickVerdict["level"]]: string} = {
  "good": "good",
  "nearly too long": "warning",
  "too long": "error"
};

export class PhysicsPanel implements Panel {
  readonly name = "physics";
  readonly title = texts.title;
  readonly element: HTMLElement;
  readonly #context: PanelContext;
  readonly #history = new MotionHistory();
  readonly #verdict = h("p", {});
  readonly #bodies = h("p", {});
  readonly #details = h("p", {class: "hint"});
  readonly #problem = h("p", {class: "error", role: "alert"});
  readonly #link = new LinkedX();
  readonly #plots = measures.map((measure) => ({measure, plot: new Plot({height: plot_height, link: this.#link})}));
  #place = ""; // world, run and island of the history
  #pending = false; // a GetMotion is on its way
  #next_poll_ms = 0;
  #timer = 0;

  constructor(context: PanelContext) {
    this.#context = context;
    this.element =
      h("div", {class: "panel physics"}, this.#problem, this.#verdict, this.#bodies,
        ...this.#plots.map(({plot}) => plot.element), this.#details, hint(texts.integrators));
    this.#show();
  }

  refresh(): void {
    const world = this.#context.world(), place = JSON.stringify([world.shown, world.info?.run_id, world.island]);
    if (place !== this.#place) {
      this.#place = place;
      this.#history.clear();
      this.#link.fit();
      this.#show();
    }
    const wait_ms = this.#next_poll_ms - performance.now();
    if (world.shown === "" || this.#pending) {
      return;
    }
    if (wait_ms <= 0) {
      void this.#poll();
    } else if (this.#timer === 0) {
      this.#timer = window.setTimeout(() => {
        this.#timer = 0;
        if (this.element.getClientRects().length > 0) { // else another panel is shown
          this.refresh();
        }
      }, wait_ms);
    }
  }

  async #poll(): Promise<void> {
    const world = this.#context.world(), place = this.#place;
    this.#pending = true;
    this.#next_poll_ms = performance.now() + poll_ms;
    try {
      const motion = await world.server.request("get_motion", {world: world.shown, island: world.island});
      if (place === this.#place) {
        this.#history.add(motion);
        set_text(this.#problem, "");
        this.#show();
      }
    } catch (error) {
      this.#next_poll_ms = performance.now() + retry_ms;
      if (place === this.#place) {
        set_text(this.#problem, (error as Error).message);
      }
    } finally {
      this.#pending = false;
    }
  }

  #show(): void {
    const {motions} = this.#history, now = motions[motions.length - 1];
    for (const {measure, plot} of this.#plots) {
      plot.set_content(motion_figure(measure, motions));
    }
    const verdict = now === undefined ? null : judge_tick(now);
    this.#verdict.className = verdict === null ? "hint" : verdict_classes[verdict.level];
    set_text(this.#verdict, verdict?.sentence ?? texts.waiting);
    const tick_s = now?.tick_s ?? 0;
    set_text(this.#bodies, now === undefined ? "" : texts.bodies(now.body_count ?? 0, now.touching_count ?? 0, tick_s));
    set_text(
      this.#details,
      now === undefined ?
        "" :
        `${texts.details((now.fastest_px_s ?? 0) * tick_s, now.cell_px ?? 0, now.deepest_overlap_share ?? 0)} ${
          texts.counts(now.too_fast_count ?? 0, now.speed_limit_count ?? 0)}`);
  }
}
