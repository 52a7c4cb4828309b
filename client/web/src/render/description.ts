// Description: what the last frame showed, for legends and hints. It is replaced only after a change.
import type {Drawing, PopulationColumns} from "../core/messages";
import type {Colouring} from "./colouring";
import type {Scene} from "./scene";

export class Description {
  /** Null before the first frame with a snapshot. */
  drawing: Drawing|null = null;
  #key = "";

  /** by_lineage: the population whose lineages are shown. */
  update(scene: Scene, pointed_at: Drawing["pointed_at"], colouring: Colouring, by_lineage: PopulationColumns|null):
    void {
    const {at, density, density_scale, health_max, look, shows} = scene;
    const key = [
      shows,
      density_scale?.high,
      density.cell_px,
      health_max,
      at.latest.has_headings,
      at.latest.has_species,
      look.colour_by,
      colouring.legend_key,
      by_lineage === null,
      pointed_at?.organism,
      pointed_at?.food,
      pointed_at?.poison,
      pointed_at === null,
    ].join();
    if (key === this.#key) {
      return;
    }
    this.#key = key;
    this.drawing = {
      shows,
      density: density_scale === null ? null : {cell_px: density.cell_px, most: density_scale.high},
      health_max,
      gene_range: colouring.gene_range,
      headings: at.latest.has_headings,
      predators: at.latest.has_species,
      pointed_at: pointed_at && {organism: pointed_at.organism, food: pointed_at.food, poison: pointed_at.poison},
      ...colouring.lineages(by_lineage),
    };
  }
}
