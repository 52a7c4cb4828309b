// IslandLegend: explains the colours of the organisms in the lower left corner of the island: a colour scale, or
// entries.
import {colours_of, css, ramp_at} from "../render/look";
import type {Colour} from "../render/look";
import {set_attribute} from "../widgets/controls";
import {h, set_text} from "../widgets/dom";
import {island_legend_texts as texts} from "../texts/island_legend";
import {shown_number} from "../texts/numbers";
import type {ViewedWorld} from "../world/world";

interface Scale {
  title: string;
  low: number;
  high: number;
}

interface Entry {
  mark: "disc"|"ring"|"arrow";
  colour: string;
  text: string;
}

const grey = "rgb(140, 140, 144)";

export class IslandLegend {
  readonly element: HTMLElement;
  readonly #scale_title = h("div", {});
  readonly #bar = h("canvas", {class: "island-legend-bar", width: 200, height: 1, "aria-hidden": "true"});
  readonly #low = h("span", {});
  readonly #high = h("span", {});
  readonly #scale =
    h("div", {}, this.#scale_title, this.#bar, h("div", {class: "island-legend-range"}, this.#low, this.#high));
  readonly #title = h("div", {});
  readonly #entries = h("ul", {});
  #palette = "";
  #key = "";

  constructor() {
    this.element = h("div", {class: "island-legend", hidden: true}, this.#scale, this.#title, this.#entries);
  }

  /** shows_all: all islands are shown, which have colours only by health. */
  refresh(world: ViewedWorld, shows_all: boolean): void {
    const scale = scale_of(world);
    const {title, entries} = entries_of(world);
    const is_known = !shows_all || (world.look.colour_by === "health" && world.feed.drawing?.density === null);
    const is_empty = scale === null && entries.length === 0;
    this.element.hidden = !world.has_bodies || world.feed.drawing === null || !is_known || is_empty;
    if (this.element.hidden) {
      return;
    }
    const look = world.look;
    set_attribute(this.element, "data-background", look.skin === "classic" ? "classic" : look.background);
    this.#scale.hidden = scale === null;
    if (scale !== null) {
      set_text(this.#scale_title, scale.title);
      set_text(this.#low, shown_number(scale.low));
      set_text(this.#high, shown_number(scale.high));
      this.#draw_bar(look.palette);
    }
    this.#title.hidden = title === "";
    set_text(this.#title, title);
    const key = JSON.stringify(entries);
    if (key !== this.#key) {
      this.#key = key;
      this.#entries.replaceChildren(...entries.map(({mark, colour, text}) => {
        const sign = h("span", {class: `island-legend-mark ${mark}`, "aria-hidden": "true"});
        sign.style.color = colour;
        return h("li", {}, sign, text);
      }));
    }
  }

  #draw_bar(palette: "violet"|"viridis"|"cividis"): void {
    if (palette === this.#palette) {
      return;
    }
    this.#palette = palette;
    const context = this.#bar.getContext("2d")!;
    for (let x = 0; x < 200; ++x) {
      context.fillStyle = css(ramp_at(palette, (x + 0.5) / 200));
      context.fillRect(x, 0, 1, 1);
    }
  }
}

function scale_of(world: ViewedWorld): Scale|null {
  const {feed: {drawing}, look} = world;
  if (drawing === null) {
    return null;
  }
  if (drawing.density !== null) {
    return {title: texts.density(drawing.density.cell_px), low: 0, high: drawing.density.most};
  }
  if (look.colour_by === "health") {
    return {title: texts.health, low: 0, high: drawing.health_max};
  }
  if (look.colour_by !== "" && look.colour_by !== "lineage" && drawing.gene_range !== null) {
    return {title: texts.gene(look.colour_by), low: drawing.gene_range[0], high: drawing.gene_range[1]};
  }
  return null;
}

function entries_of(world: ViewedWorld): {title: string; entries: Entry[]} {
  const {feed: {drawing}, look, population: {columns: population}} = world;
  const entries: Entry[] = [];
  let title = "";
  const add = (mark: Entry["mark"], colour: Colour|string, text: string) =>
    entries.push({mark, colour: typeof colour === "string" ? colour : css(colour), text});
  if (drawing === null || drawing.density !== null) {
    return {title, entries};
  }
  const colours = colours_of(look);
  if (look.colour_by === "lineage") {
    if (drawing.lineages === null || drawing.lineages.length === 0) {
      add("disc", grey, texts.unknown_lineages);
    } else {
      title = texts.lineages;
      drawing.lineages.forEach(({founder, count, colour}) => add("disc", colour, texts.lineage(founder, count)));
      const others = drawing.lineage_others;
      if (others !== null && others.lineages > 0) {
        add("disc", grey, texts.smaller_lineages(others.lineages, others.count));
      }
      if (others !== null && others.placed > 0) {
        add("disc", grey, texts.placed(others.placed));
      }
    }
  }
  if (look.perception === "all" && population !== null) {
    add("ring", colours.food_radius, texts.food_radius);
    add("ring", colours.poison_radius, texts.poison_radius);
  }
  if (look.forces !== "none" && population?.forces) {
    if (drawing.headings) {
      add("arrow", colours.wanders, texts.networks);
    } else {
      add("arrow", colours.seeks, texts.seeks);
      add("arrow", colours.flees, drawing.predators ? texts.flees_both : texts.flees);
      add("arrow", colours.wanders, texts.wanders);
    }
  }
  return {title, entries};
}
