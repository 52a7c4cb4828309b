// GlassBoxTabs: the tabs of the glass box, "Step", "Theory" and "Why genes changed". A tab is drawn only when what it
// shows has changed.
import {caption} from "../breeding/caption";
import type {BreedingFeed} from "../breeding/feed";
import {progress_of} from "../breeding/progress";
import type {BreedingRecord} from "../breeding/record";
import {glass_box_texts} from "../texts/glass_box";
import {h, set_text} from "../widgets/dom";
import type {ViewedWorld} from "../world/world";
import type {BetControls} from "./glass_box_bets";
import {gene_parts, next_statistics} from "./glass_box_genes";
import {Stage} from "./glass_box_stage";
import type {StepControls} from "./glass_box_steps";
import {theory_parts} from "./glass_box_theory";

const tabs = ["step", "theory", "genes"] as const;
type Tab = typeof tabs[number];

export class GlassBoxTabs {
  readonly element: HTMLElement;
  #tab: Tab = "step";
  #drawn = ""; // what the open tab shows
  readonly #steps: StepControls;
  readonly #bets: BetControls;
  readonly #changed: () => void;

  readonly #buttons =
    tabs.map((tab) => h("button", {class: "button", onclick: () => this.open(tab)}, glass_box_texts.tabs[tab]));
  readonly #caption = h("p", {class: "glass-caption", "aria-live": "polite"});
  readonly #score = h("p", {class: "glass-score", role: "status"});
  readonly #stage = new Stage(
    (stage, index) => this.#steps.move(() => this.#steps.stepper.go_to(this.#steps.stepper.begin_of(stage) + index)));
  readonly #play_all = h("button", {class: "button button-primary", onclick: () => this.#play_picks()});
  readonly #theory = h("div", {class: "panel"});
  readonly #genes = h("div", {class: "panel"});

  constructor(steps: StepControls, bets: BetControls, changed: () => void) {
    this.#steps = steps;
    this.#bets = bets;
    this.#changed = changed;
    this.element =
      h("div", {class: "panel"},
        h("div", {class: "row glass-tabs", role: "group", "aria-label": glass_box_texts.tabs_label}, ...this.#buttons),
        this.#caption, this.#score, this.#stage.element, this.#theory, this.#genes);
  }

  open(tab: Tab): void {
    this.#tab = tab;
    this.#changed();
  }

  /** Draws the open tab at the next update, even if nothing has changed. */
  forget(): void {
    this.#drawn = "";
  }

  update(world: ViewedWorld, {comparison}: BreedingFeed, record: BreedingRecord, width: number): void {
    const progress = progress_of(record, this.#steps.stepper.moment);
    this.#buttons.forEach((button, i) => button.setAttribute("aria-pressed", String(tabs[i] === this.#tab)));
    this.#caption.hidden = this.#stage.element.hidden = this.#tab !== "step";
    this.#theory.hidden = this.#tab !== "theory";
    this.#genes.hidden = this.#tab !== "genes";
    set_text(
      this.#play_all, glass_box_texts.play_picks(record.pick_count, this.#bets.chosen.checked && this.#bets.any));
    set_text(this.#score, this.#bets.score_line(record, comparison, progress));
    this.#score.hidden = this.#tab === "genes" || this.#score.textContent === "";
    const next = next_statistics(world.history.generations, record.key);
    const drawn = [
      this.#tab, record.key.run_id, record.key.island, record.key.generation, this.#steps.stepper.position,
      record.contenders.length, record.picks.length, record.descendants.length, width, world.gene_names.length,
      this.#tab === "genes" && next !== null, this.#bets.closed
    ].join("/");
    if (drawn === this.#drawn) {
      return;
    }
    this.#drawn = drawn;
    switch (this.#tab) {
      case "step": {
        const {moment, playing} = this.#steps.stepper;
        const bets = this.#bets.chosen.checked && comparison ? this.#bets.parts(record, comparison) : [];
        set_text(this.#caption, caption(record, moment));
        this.#caption.setAttribute("aria-live", playing ? "off" : "polite");
        this.#stage.draw({record, comparison, moment, progress, width}, world, [...bets, this.#play_all]);
        break;
      }
      case "theory":
        this.#theory.replaceChildren(...theory_parts(record, comparison, progress, width));
        break;
      case "genes":
        this.#genes.replaceChildren(...gene_parts(record.key.generation, world.gene_names, next));
        break;
    }
  }

  #play_picks(): void {
    this.#steps.move(() => {
      this.#steps.stepper.step();
      this.#steps.stepper.play();
    });
    this.#stage.element.focus();
  }
}
