// QuantityTabs and IslandAndMeanChoice: which quantity the plots show; for which island, and smoothed over how many
// generations.
import {colony_quantities, quantities} from "../plots/figures";
import type {Quantity} from "../plots/figures";
import type {Island} from "../plots/history_table";
import {plot_texts} from "../texts/plot";
import {plots_panel_texts as texts, quantity_texts} from "../texts/plots_panel";
import {set_options} from "../widgets/controls";
import {h} from "../widgets/dom";
import {row} from "../widgets/form";

const windows = [1, 5, 10, 20, 50, 100]; // generations of a running mean; 1: none
const window_default = 10;

export class QuantityTabs {
  readonly #content: HTMLElement;
  readonly #on_change: () => void;
  readonly #tabs = quantities.map(
    (quantity) =>
      h("button", {
        class: "plots-tab",
        type: "button",
        role: "tab",
        id: `plot-tab-${quantity}`,
        "aria-controls": "plot-tab-content",
        onclick: () => this.choose(quantity),
        onkeydown: (event: KeyboardEvent) => this.#move(event),
      },
        quantity_texts[quantity]));
  readonly element = h("div", {class: "plots-tabs", role: "tablist", "aria-label": texts.quantity}, ...this.#tabs);
  #chosen: Quantity = "fitness";

  /** content    the element that the tabs control
   *  on_change  called after each choice */
  constructor(content: HTMLElement, on_change: () => void) {
    this.#content = content;
    this.#content.id = "plot-tab-content";
    this.#content.setAttribute("role", "tabpanel");
    this.#on_change = on_change;
    this.#show();
  }

  get chosen(): Quantity {
    return this.#chosen;
  }

  choose(quantity: Quantity): void {
    this.#chosen = quantity;
    this.#show();
    this.#on_change();
  }

  /** Offers the plots that only colonies have. */
  offer(offered: readonly Quantity[]): void {
    this.#tabs.forEach((tab, i) => {
      const quantity = quantities[i]!;
      tab.hidden = colony_quantities.includes(quantity) && !offered.includes(quantity);
    });
    if (this.#tabs[quantities.indexOf(this.#chosen)]!.hidden) {
      this.choose("fitness");
    }
  }

  #show(): void {
    this.#tabs.forEach((tab, i) => {
      const chosen = quantities[i] === this.#chosen;
      tab.setAttribute("aria-selected", String(chosen));
      tab.tabIndex = chosen ? 0 : -1;
    });
    this.#content.setAttribute("aria-labelledby", `plot-tab-${this.#chosen}`);
  }

  #move(event: KeyboardEvent): void {
    const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    if (by !== 0) {
      event.preventDefault();
      event.stopPropagation();
      const offered = quantities.filter((_, i) => !this.#tabs[i]!.hidden);
      const next = offered[(offered.indexOf(this.#chosen) + by + offered.length) % offered.length]!;
      this.choose(next);
      this.#tabs[quantities.indexOf(next)]!.focus();
    }
  }
}

export class IslandAndMeanChoice {
  readonly #smooth: HTMLSelectElement;
  readonly #island: HTMLSelectElement;
  readonly #species: HTMLSelectElement;
  readonly element: HTMLElement;

  constructor(on_change: () => void) {
    this.#smooth = h(
      "select", {class: "field", "aria-label": texts.running_mean, title: texts.running_mean_help, onchange: on_change},
      ...windows.map(
        (window) =>
          h("option", {value: window, selected: window === window_default},
            window === 1 ? texts.each_generation : plot_texts.mean_of(window))));
    this.#island = h("select", {class: "field", "aria-label": texts.island, hidden: true, onchange: on_change});
    this.#species =
      h("select", {class: "field", "aria-label": texts.species, hidden: true, onchange: on_change},
        h("option", {value: "prey"}, texts.prey), h("option", {value: "predators"}, texts.predators));
    this.element = row(this.#smooth, this.#island, this.#species);
  }

  /** Generations of the running mean; 1: none. */
  get window(): number {
    return Number(this.#smooth.value);
  }

  get island(): Island {
    return this.#island.value === "" ? null : Number(this.#island.value);
  }

  /** Whether the plots are about the predators. */
  get of_predators(): boolean {
    return !this.#species.hidden && this.#species.value === "predators";
  }

  /** of_colony: the plot shows both species, and no running mean. */
  update(island_count: number, has_predators: boolean, of_colony: boolean): void {
    this.#smooth.hidden = of_colony;
    this.#species.hidden = of_colony || !has_predators;
    this.#island.hidden = island_count < 2;
    const islands = Array.from(
      {length: this.#island.hidden ? 0 : island_count}, (_, i) => ({value: String(i), text: texts.island_name(i)}));
    const is_known = Number(this.#island.value) < Math.max(island_count, 1);
    set_options(this.#island, [{value: "", text: texts.all_islands}, ...islands], is_known ? this.#island.value : "");
  }
}
