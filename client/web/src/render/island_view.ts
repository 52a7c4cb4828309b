// IslandView: one island in a rectangle of the canvas: its camera, its scene for a painter, and what is at a point of
// it.
import type {Camera, Drawing, Look, PopulationColumns, Reading, Tool} from "../core/messages";
import {type Snapshot, type SnapshotInfo, steps_per_px} from "../core/snapshot";
import {clamped, fitted, type Place, type Point, visible_part} from "./camera";
import {Colouring} from "./colouring";
import {count_organisms, density_scale, DensityGrid, join_tiles} from "./density";
import {Description} from "./description";
import {continues} from "./interpolator";
import {colours_of, default_look, island_colours, styles_of} from "./look";
import {dots_radius_pixels, shows_details, too_many_for_dots, too_small_to_see, typical_radius_px} from "./marks";
import {MinimapGrid} from "./minimap";
import {organism_at, picked_at, type Picked} from "./picking";
import type {Painter, Scene} from "./scene";
import {labels_of} from "./scene_labels";
import {StreamedIsland} from "./streamed_island";
import {StreamedRegion, type WantedView} from "./streamed_region";

/** What the page sets. */
export interface ViewSettings {
  place: Place;
  camera: Camera|null; // null: the whole island, also after a change of the size
  look: Look;
  selected: number|null; // ids
  hovered: number|null; // the organism that a panel points at
  follows: boolean; // the camera keeps the selected organism in the middle
  pointer: Point|null; // CSS pixels in the place
  tool: Tool;
  population: PopulationColumns|null;
}

const hover_radius = 12; // CSS pixels

export function default_settings(place: Place): ViewSettings {
  return {
    place,
    camera: null,
    look: default_look("vivid", "dark"),
    selected: null,
    hovered: null,
    follows: false,
    pointer: null,
    tool: "select",
    population: null,
  };
}

export class IslandView {
  readonly island = new StreamedIsland();
  settings: ViewSettings;
  #population_version = 0;
  readonly region = new StreamedRegion();
  readonly #colouring = new Colouring();
  readonly #density = new DensityGrid();
  readonly #minimap = new MinimapGrid();
  readonly description = new Description();
  #is_dirty = true;
  #drawn_blend = 1;
  #drawn_camera: Camera|null = null;
  #drawn_place: Place|null = null;

  /** painter: null while the graphics context is lost. */
  constructor(settings: ViewSettings, public painter: Painter|null) {
    this.settings = settings;
  }

  change(settings: Partial<ViewSettings>): void {
    this.settings = {...this.settings, ...settings};
    this.#population_version += settings.population === undefined ? 0 : 1;
    this.#is_dirty = true;
  }

  add(snapshot: Snapshot, now_ms: number): void {
    this.island.add(snapshot, now_ms, this.camera(), this.settings.place, this.settings.look);
    this.#is_dirty = true;
  }

  /** Takes densities of the whole island for the minimap, while only a part is streamed. */
  add_overview(snapshot: Snapshot): void {
    this.island.add_overview(snapshot);
    this.#is_dirty = true;
  }

  /** Drops the snapshots. Call it before another world or island is shown. */
  clear(): void {
    this.island.clear();
    this.region.forget();
    this.#is_dirty = true;
  }

  /** What the page shows of this snapshot, as the labels of the next frame do. */
  read(info: SnapshotInfo, now_ms: number): Reading {
    const before = this.island.reading, reading = this.island.read(info, now_ms);
    this.#is_dirty ||= reading !== before;
    return reading;
  }

  /** Whether draw() would draw something else than the last time. */
  needs_frame(now_ms: number): boolean {
    return this.#is_dirty || this.#blend_at(now_ms) !== this.#drawn_blend;
  }

  draw(now_ms: number): void {
    const {painter} = this;
    if (painter === null) {
      return;
    }
    this.#is_dirty = false;
    const blend = (this.#drawn_blend = this.#blend_at(now_ms));
    this.#follow(blend);
    const camera = (this.#drawn_camera = this.camera());
    this.#drawn_place = this.settings.place;
    if (camera === null) {
      painter.draw(this.#scene({x_px: 0, y_px: 0, zoom: 1}, blend, painter));
      return;
    }
    const scene = this.#scene(camera, blend, painter);
    painter.draw(scene);
    const by_lineage = this.settings.look.colour_by === "lineage" ? this.#current_population() : null;
    this.description.update(scene, this.#what_is_pointed_at(scene), this.#colouring, by_lineage);
  }

  /** The camera of the last frame; differs from the one that was set while it follows an organism. Null before the
   *  first snapshot. */
  camera(): Camera|null {
    const {size} = this.island, {camera, place} = this.settings;
    return size === null               ? null :
      camera === null || place.is_tile ? fitted(place, size, place.frame) :
                                         clamped(camera, place, size);
  }

  /** Whether a frame has shown the island at its present place. */
  get is_drawn(): boolean {
    return this.#drawn_camera !== null && this.#drawn_place === this.settings.place;
  }

  /** What is drawn at a point; see picked_at(). */
  pick(x: number, y: number, radius: number): Picked|null {
    const camera = this.#drawn_camera;
    return camera && picked_at({x, y}, radius, camera, this.settings.place, this.island.at, this.#drawn_blend);
  }

  /** The View to request now (SetView), if the island is streamed in part; null if the one returned last is still
   *  suitable. */
  view_to_request(now_ms: number): WantedView|null {
    const camera = this.camera();
    return camera === null ? null : this.region.update(camera, this.settings.place, this.detail(camera), now_ms);
  }

  /** The level of detail that is useful for what is drawn. */
  detail(camera = this.camera()): WantedView["detail"] {
    if (camera === null) {
      return "DETAIL_FULL";
    }
    const {look, selected} = this.settings;
    const details_of_all = (look.perception === "all" || look.forces === "all") && shows_details(camera);
    const no_single_organism_matters = look.colour_by === "" && !details_of_all && selected === null;
    const small = typical_radius_px * camera.zoom < dots_radius_pixels;
    return this.#wants_density(camera)    ? "DETAIL_DENSITY" :
      small && no_single_organism_matters ? "DETAIL_DOTS" :
                                            "DETAIL_FULL";
  }

  #blend_at(now_ms: number): number {
    return this.settings.look.interpolate ? this.island.at.blend_at(now_ms) : 1;
  }

  /** Keeps the followed organism in the centre. */
  #follow(blend: number): void {
    const {at} = this.island, {follows, selected, place} = this.settings;
    const row = follows && !place.is_tile ? at.latest.index_of(selected) : -1;
    if (row >= 0) {
      const {zoom} = this.camera()!;
      this.settings.camera = {x_px: at.x_at(row, blend) / steps_per_px, y_px: at.y_at(row, blend) / steps_per_px, zoom};
    }
  }

  #wants_density(camera: Camera): boolean {
    const {look, place} = this.settings, {latest} = this.island.at;
    const count = this.island.organism_count;
    const is_too_many = too_small_to_see(camera) && too_many_for_dots(camera, place, latest.info!, count);
    return look.density && look.colour_by === "" && is_too_many;
  }

  /** The population, if it is that of the shown generation. */
  #current_population(): PopulationColumns|null {
    const {info} = this.island.at.latest, of = this.settings.population;
    return of !== null && info !== null && of.generation === info.generation && of.island === info.island ? of : null;
  }

  #scene(camera: Camera, blend: number, painter: Painter): Scene {
    const {at, trails, flashes, health_max, reading, version} = this.island;
    const {look, place, pointer, tool, selected, hovered} = this.settings, {latest} = at;
    const population = this.#current_population();
    this.#colouring.update(
      {look, latest, snapshot_version: version, population, population_version: this.#population_version, health_max});
    const scene: Scene = {
      place,
      camera,
      look,
      colours: colours_of(look),
      styles: styles_of(look),
      at,
      blend,
      shown_s: at.shown_s(blend),
      snapshot_version: version,
      colours_version: this.#colouring.version,
      organism_colours: this.#colouring.colours,
      health_max,
      healthiest: reading !== null && continues(latest.info!, reading.info) ? reading.healthiest : [],
      selected: latest.index_of(selected),
      pointed_at: pointer !== null && tool === "select" ? organism_at(pointer, hover_radius, camera, place, at, blend) :
                                                          latest.index_of(hovered),
      population: population !== null && shows_details(camera) ? population : null,
      trails: look.trails && place.has_details && shows_details(camera) ? trails : null,
      flashes: look.flashes ? flashes.all : [],
      shows: "organisms",
      density: this.#density,
      density_scale: null,
      labels: [],
      minimap: null,
      preview: null,
    };
    if (latest.info !== null) {
      this.#choose_detail(scene);
      scene.labels = scene.shows !== "density" && place.has_details ? labels_of(scene, painter) : [];
      scene.minimap = look.minimap ? this.#minimap.of(this.island, camera, place) : null;
      scene.preview = preview_of(pointer, tool, camera, latest.info);
    }
    return scene;
  }

  /** After a change of the level of detail, densities are drawn until the first snapshot with the new detail arrives.
   *  */
  #choose_detail(scene: Scene): void {
    const {at, camera, place, look, blend} = scene, {latest} = at, info = latest.info!;
    if (latest.densities.length > 0) {
      scene.shows = "density";
      join_tiles(this.#density, latest.densities, info.tile_px);
    } else if (this.#wants_density(camera)) {
      scene.shows = "density";
      count_organisms(this.#density, at, blend, visible_part(camera, place), this.island.size!, camera.zoom);
    } else if (latest.organism_dots.count > 0) {
      scene.shows = "dots";
    }
    scene.density_scale = scene.shows === "density" ? density_scale(look.palette, this.#density) : null;
  }

  #what_is_pointed_at(scene: Scene): Drawing["pointed_at"] {
    const {pointer, tool} = this.settings, {id} = scene.at.latest;
    return pointer === null ? null :
      tool === "select" ? {organism: scene.pointed_at < 0 ? null : id[scene.pointed_at]!, food: null, poison: null} :
                          this.pick(pointer.x, pointer.y, hover_radius);
  }
}

/** Of what a click would place. */
function preview_of(pointer: Point|null, tool: Tool, camera: Camera, {item_radius_px}: SnapshotInfo): Scene["preview"] {
  if (pointer === null || (tool !== "food" && tool !== "poison" && tool !== "organism")) {
    return null;
  }
  const radius_px = tool === "organism" ? typical_radius_px : item_radius_px;
  const colour = tool === "organism" ? island_colours.classic.body : island_colours.classic[tool];
  return {...pointer, radius: Math.max(radius_px * camera.zoom, 3), colour};
}
