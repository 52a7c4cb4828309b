// Scene: everything that a painter draws in one frame. The renderer prepares it; GlIsland draws it.
import type {Camera, Look, PopulationColumns, Reading} from "../core/messages";
import type {SnapshotInfo} from "../core/snapshot";
import type {MinimapPlace, Place, Rectangle, Size} from "./camera";
import type {DensityGrid} from "./density";
import type {Interpolator} from "./interpolator";
import type {Label} from "./labels";
import type {Colour, IslandColours, ScaleTable, Styles} from "./look";
import type {Flash, Trails} from "./traces";

export interface Scene {
  place: Place;
  camera: Camera;
  look: Look;
  colours: IslandColours;
  styles: Styles;
  at: Interpolator; // the snapshots
  blend: number;
  shown_s: number; // the simulated time that is drawn
  snapshot_version: number; // changes with the snapshots
  colours_version: number; // changes with organism_colours
  organism_colours: Int32Array|null; // packed, by row of the latest snapshot; null: no colouring
  health_max: number; // the arc of a body is complete at this health
  healthiest: Reading["healthiest"];
  selected: number; // rows of the latest snapshot; -1: none
  pointed_at: number;
  population: PopulationColumns|null; // of the shown generation
  trails: Trails|null; // null: not shown
  flashes: readonly Flash[];
  shows: "organisms"|"dots"|"density";
  density: DensityGrid;
  density_scale: ScaleTable|null; // if densities are shown
  labels: Label[];
  minimap: {place: MinimapPlace; frame: Rectangle; grid: DensityGrid; scale: ScaleTable; version: number}|null;
  preview: {x: number; y: number; radius: number; colour: Colour}|null; // of what a click would place, in CSS pixels
}

export interface Painter {
  /** The width of a label's text in CSS pixels. */
  measure(text: string, ratio: number): number;
  /** Draws into scene.place. */
  draw(scene: Scene): void;
  /** Frees the memory. Call it before the painter is dropped while the canvas stays. */
  close(): void;
}

/** A canvas with a graphics context, which all painters of its islands share. */
export interface Surface {
  painter(): Painter;
  /** Begins a frame with several islands: fills the canvas, which is `size` CSS pixels. */
  fill(size: Size, ratio: number, colour: Colour): void;
  close(): void;
}

/** The part of the place inside the walls, in CSS pixels. */
export function inside_walls({camera, place}: {camera: Camera; place: Place}, island: Size): Rectangle {
  return {
    left: place.width / 2 - camera.x_px * camera.zoom,
    top: place.height / 2 - camera.y_px * camera.zoom,
    width: island.width * camera.zoom,
    height: island.height * camera.zoom,
  };
}

/** The rows for which rings or arrows are drawn: of all organisms, or of the one at the mouse and the selected one. */
export function chosen_rows(which: Look["forces"], scene: Scene): Iterable<number> {
  switch (which) {
    case "none":
      return [];
    case "selected":
      return [...new Set([scene.pointed_at, scene.selected])].filter((row) => row >= 0);
    case "all":
      return all_rows(scene.at.latest.count);
  }
}

function* all_rows(count: number): Generator<number> {
  for (let row = 0; row < count; ++row) {
    yield row;
  }
}

export const choice_seek = 2; // CHOICE_SEEK of world.proto
export const choice_flee = 3;
/** Length of an arrow, in px of the island, for a force of 1 kg px/s². */
export const arrow_px_per_force = 0.3;
/** No organism perceives farther than this. */
export const perception_px_max = 200;

export function colour_of_choice(choice: number, colours: IslandColours): Colour {
  return choice === choice_seek ? colours.seeks : choice === choice_flee ? colours.flees : colours.wanders;
}

/** How much of a trail is drawn: all of it up to real time, less at a higher speed, because whole trails would cover
 *  the organisms. */
export function trail_share({speed, ticks_per_s, simulated_s, tick}: SnapshotInfo): number {
  const measured = tick > 0 ? (ticks_per_s * simulated_s) / tick : 1;
  return Math.min(1, Math.max(1 / Math.sqrt(speed?.real_time_factor ?? measured), 0.15));
}

/** A trail whose end is older is fainter. */
export function trail_alpha(alpha: number, age_s: number, kept_s: number): number {
  return Math.trunc(alpha * (1 - 0.8 * Math.min(Math.max(age_s / kept_s, 0), 1)));
}
