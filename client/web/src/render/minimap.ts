// MinimapGrid: the densities of the whole island on the minimap, which are counted again only after a change.
import type {Camera} from "../core/messages";
import {is_whole_island_visible, minimap_frame, minimap_place, type Place} from "./camera";
import {count_overview, density_scale, DensityGrid} from "./density";
import type {Scene} from "./scene";
import type {StreamedIsland} from "./streamed_island";

export class MinimapGrid {
  readonly #grid = new DensityGrid();
  #version = 0;

  /** The minimap; null: the whole island is visible. */
  of(island: StreamedIsland, camera: Camera, place: Place): Scene["minimap"] {
    const size = island.size!, {whole} = island;
    if (is_whole_island_visible(camera, place, size)) {
      return null;
    }
    const version = whole === null ? island.version : -1 - island.whole_version;
    if (this.#version !== version) {
      this.#version = version;
      const from = whole ?? island.at.latest;
      count_overview(this.#grid, from, size, from.info!.tile_px);
    }
    const map = minimap_place(place, size), frame = minimap_frame(map, camera, place);
    return {place: map, frame, grid: this.#grid, scale: density_scale("viridis", this.#grid), version};
  }
}
