// IslandTiles: all islands of a world at once, as tiles over the canvas, in which the worker draws them. Each tile is a
// button, which shows only its island.
import type {FromWorker, TileInfo} from "../core/messages";
import type {Size} from "../render/camera";
import {tile_places, tiles_max} from "../render/tiles";
import {type LabelWidth, tile_texts} from "../texts/pane";
import {set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import type {ViewedWorld} from "../world/world";

// Labels are shorter in narrower tiles.
const wide_pixels = 200, middle_pixels = 110;

interface Tile {
  button: HTMLButtonElement;
  name: HTMLElement;
  facts: HTMLElement;
}

export class IslandTiles {
  readonly element = h("div", {class: "island-tiles", role: "group", hidden: true});
  /** An island was shown from the tiles, so that the user can return to them. */
  can_return = false;
  #of = ""; // the world for which tiles were shown last
  #count = 0; // of islands that are shown; 0: off
  #tiles: Tile[] = [];
  #infos: readonly(TileInfo|null)[] = [];
  #layout_key = "";
  #width: LabelWidth = "wide";
  readonly #world: ViewedWorld;
  readonly #on_change: (had_focus: boolean) => void;

  /** on_change: called after the tiles were shown or hidden; had_focus: one of the tiles before. */
  constructor(world: ViewedWorld, on_change: (had_focus: boolean) => void) {
    this.#world = world;
    this.#on_change = on_change;
    this.element.addEventListener("keydown", (event) => this.#key(event));
  }

  get is_on(): boolean {
    return this.#count > 0;
  }

  get island_count(): number {
    return this.#world.snapshot?.island_count ?? this.#world.info?.island_count ?? 1;
  }

  get has_focus(): boolean {
    return this.element.contains(document.activeElement);
  }

  /** Why all islands cannot be shown, as a sentence; empty if they can. */
  get problem(): string {
    const count = this.island_count;
    return count < 2 ? tile_texts.only_one : count > tiles_max ? tile_texts.too_many(count, tiles_max) : "";
  }

  /** Shows all islands, or only the chosen one. Returns why that is not possible. */
  toggle(): string {
    const problem = this.is_on ? "" : this.problem;
    if (problem === "") {
      const keeps_focus = document.activeElement instanceof HTMLButtonElement && !this.has_focus;
      this.#show(this.is_on ? 0 : this.island_count);
      this.can_return = false;
      if (this.is_on && !keeps_focus) { // the canvas can have no focus now
        this.#focus(this.#world.island);
      }
    }
    return problem;
  }

  /** Returns to all islands from the island that was shown from its tile. Returns whether it did. */
  return_to_all(): boolean {
    const returns = this.can_return && this.#of === this.#world.name && !this.is_on && this.problem === "";
    if (returns) {
      this.toggle();
    }
    return returns;
  }

  take(message: FromWorker): void {
    if (message.kind === "tiles" && message.pane === this.#world.feed.pane) {
      this.#infos = message.tiles;
      this.#write();
    }
  }

  /** size: of the canvas, in CSS pixels; island: in px. */
  refresh(size: Size, island: Size|null): void {
    const count = this.island_count;
    if (this.is_on && this.#world.snapshot !== null && count !== this.#count) {
      this.#show(this.problem === "" ? count : 0);
    }
    if (!this.is_on) {
      return;
    }
    const aspect = island === null ? 1 : island.width / island.height;
    const key = [this.#count, size.width, size.height, aspect].join(" ");
    if (key !== this.#layout_key) {
      this.#layout_key = key;
      this.#lay_out(size, aspect);
    }
    this.#write();
  }

  #show(count: number): void {
    this.#of = this.#world.name;
    this.#count = count;
    this.#infos = [];
    this.#layout_key = "";
    const had_focus = this.has_focus;
    this.element.hidden = count === 0;
    this.#world.server.post({kind: "islands", pane: this.#world.feed.pane, islands: count});
    this.#tiles = Array.from({length: count}, (_, island) => this.#tile(island));
    this.element.replaceChildren(...this.#tiles.map(({button}) => button));
    this.#on_change(had_focus);
    if (had_focus && count > 0) {
      this.#focus(this.#world.island);
    }
  }

  #tile(island: number): Tile {
    const name = h("span", {class: "island-tile-name"}), facts = h("span", {class: "island-tile-facts"});
    const button =
      h("button", {type: "button", class: "island-tile", tabindex: -1, onclick: () => this.#open(island)},
        h("span", {class: "island-tile-label"}, name, facts));
    return {button, name, facts};
  }

  /** Shows only this island. */
  #open(island: number): void {
    this.#world.choose_island(island);
    this.#show(0);
    this.can_return = true;
  }

  #lay_out(size: Size, aspect: number): void {
    const places = tile_places(size, this.#count, aspect);
    this.#tiles.forEach(({button}, i) => {
      const {left, top, width, height} = places[i]!;
      button.style.cssText = `left: ${left}px; top: ${top}px; width: ${width}px; height: ${height}px`;
    });
    const {width} = places[0]!;
    this.#width = width >= wide_pixels ? "wide" : width >= middle_pixels ? "middle" : "narrow";
  }

  #write(): void {
    const world = this.#world, fitness = this.#fitness_means();
    set_attribute(this.element, "aria-label", tile_texts.group(world.shown));
    this.#tiles.forEach(({button, name, facts}, island) => {
      const info = this.#infos[island] ?? null, mean = fitness.get(island) ?? null, chosen = island === world.island;
      set_text(name, tile_texts.name(island, this.#width));
      set_text(facts, info === null ? "" : tile_texts.facts(info.alive, mean, this.#width));
      const label = info === null ? tile_texts.waiting(island) :
                                    tile_texts.label(island, info.generation, info.alive, info.health_mean, mean);
      set_attribute(button, "aria-label", label);
      set_attribute(button, "title", label);
      set_attribute(button, "aria-current", chosen ? "true" : null);
      button.tabIndex = chosen ? 0 : -1;
    });
  }

  /** The mean fitness of the newest finished generation of each island, by island. */
  #fitness_means(): Map<number, number> {
    const {generations: history} = this.#world.history, means = new Map<number, number>();
    for (let i = history.length - 1; i >= 0 && history.length - i <= this.#count; --i) {
      const {island = 0, fitness_mean} = history[i]!;
      if (!means.has(island)) {
        means.set(island, Number(fitness_mean ?? 0));
      }
    }
    return means;
  }

  /** Chooses an island by the arrow keys, as in a grid. */
  #key(event: KeyboardEvent): void {
    const tops = this.#tiles.map(({button}) => button.style.top), columns = tops.lastIndexOf(tops[0]!) + 1;
    const by = {ArrowLeft: -1, ArrowRight: 1, ArrowUp: -columns, ArrowDown: columns}[event.key];
    const {island} = this.#world;
    const next = event.key === "Home" ? 0 :
      event.key === "End"             ? this.#count - 1 :
      by === undefined                ? null :
                                        island + by;
    if (next === null || event.ctrlKey || event.altKey || event.metaKey) {
      return;
    }
    event.preventDefault();
    if (next >= 0 && next < this.#count) {
      this.#world.choose_island(next);
      this.#write();
      this.#focus(next);
    }
  }

  #focus(island: number): void {
    this.#write();
    this.#tiles[island]?.button.focus({preventScroll: true});
  }
}
