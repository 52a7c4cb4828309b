// PaneTool: what a click on the island does: select, place food, poison or an organism, or remove.
import type {Drawing, Tool} from "../core/messages";
import type {Place, Remove} from "../core/protocol";
import {tool_texts} from "../texts/pane";
import {gene_problem} from "../world/names";
import type {PlacedModel} from "../world/panel_context";
import {place} from "../world/placing";
import type {ViewedWorld} from "../world/world";
import type {Picked} from "./picker";

const organism_radius_px = 10; // copies are placed at least so far from the walls

export class PaneTool {
  tool: Tool = "select";
  model: PlacedModel|null = null;

  readonly #world: ViewedWorld;
  readonly #on_change: () => void;

  constructor(world: ViewedWorld, on_change: () => void) {
    this.#world = world;
    this.#on_change = on_change;
  }

  set(tool: Tool): void {
    const {info: organism, id: selected} = this.#world.selection;
    if (tool === "organism" && organism !== null && selected !== null) {
      this.model = {name: tool_texts.copy_of(selected), genes: [...(organism.genes ?? [])]};
    }
    this.tool = tool;
    this.#on_change();
  }

  /** Chooses the tool "organism" with these genes. Returns why it cannot act in this world, as a sentence; empty if it
   *  can. */
  place_copies_of(model: PlacedModel): string {
    const problem = this.problem("organism", model);
    if (problem === "") {
      this.model = model;
      this.tool = "organism";
      this.#on_change();
    }
    return problem;
  }

  /** Why the tool cannot act in this world, as a sentence; empty if it can. */
  problem(tool = this.tool, model = this.model): string {
    const world = this.#world;
    if (tool === "select") {
      return "";
    }
    if (!world.server.features.has("place")) {
      return tool_texts.no_place;
    }
    if (!world.shown) {
      return tool_texts.no_world;
    }
    if (world.is_replay) {
      return tool_texts.is_replay;
    }
    const why = world.server.access.why_not(tool === "remove" ? "remove" : "place", world.shown);
    if (why !== "") {
      return why;
    }
    if (tool === "organism" && model === null && world.selection.info === null) {
      return tool_texts.no_organism;
    }
    const copies_selected = model === this.model && this.tool !== "organism" && world.selection.info !== null;
    return tool === "organism" && model?.gene_names && !copies_selected ?
      gene_problem(model.name, model.gene_names, world.name, world.gene_names) :
      "";
  }

  /** What a click there would do; empty: it would select. */
  hint(there: NonNullable<Drawing["pointed_at"]>): string {
    switch (this.tool) {
      case "select":
        return "";
      case "food":
      case "poison":
        return tool_texts.place[this.tool];
      case "organism":
        return tool_texts.place_organism(this.model?.name ?? null);
      case "remove":
        return there.organism !== null ? tool_texts.remove_organism(there.organism) :
          there.food !== null          ? tool_texts.remove.food :
          there.poison !== null        ? tool_texts.remove.poison :
                                         tool_texts.nothing_to_remove;
    }
  }

  /** Places or removes something. Returns why that was not possible, as a sentence; empty if it was. */
  async use(picked: Picked): Promise<string> {
    const problem = this.problem();
    if (problem !== "" || picked.x_px < 0 || this.#world.snapshot === null) {
      return problem;
    }
    const {server, shown, island} = this.#world;
    try {
      if (this.tool !== "remove") {
        await place(this.#world, this.#placing_at(picked));
        return "";
      }
      const removal = removal_of(picked);
      if (removal === null) {
        return tool_texts.nothing_to_remove;
      }
      await server.request("remove", {world: shown, island, ...removal});
      return "";
    } catch (error) {
      return error instanceof Error ? error.message : String(error);
    }
  }

  #placing_at({x_px, y_px}: Picked): Place {
    const {width_px, height_px, item_radius_px} = this.#world.snapshot!;
    const inside = (value: number, size: number, radius: number): number =>
      Math.min(Math.max(value, radius), size - radius);
    const at = (radius: number) => ({x_px: inside(x_px, width_px, radius), y_px: inside(y_px, height_px, radius)});
    if (this.tool === "organism") {
      return {organisms: [{...at(organism_radius_px), genes: this.model?.genes ?? []}]};
    }
    return {items: [{...at(item_radius_px), kind: this.tool === "food" ? "ITEM_KIND_FOOD" : "ITEM_KIND_POISON"}]};
  }
}

/** What is removed there; null: nothing. */
function removal_of({generation, organism, food, poison}: Picked): Remove|null {
  return organism !== null ? {generation, organisms: [organism]} :
    food !== null          ? {generation, food: [food]} :
    poison !== null        ? {generation, poison: [poison]} :
                             null;
}
