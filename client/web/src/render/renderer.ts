// Renderer: draws one pane: an island in its look, labels and the minimap, with WebGL2, or with Canvas2D where WebGL2 is missing.
//
// The worker owns it, calls add() after each decoded snapshot and draw() from requestAnimationFrame while needs_frame() is
// true, and acknowledges a snapshot after the draw() that follows it. add() copies what it needs: the decoder may reuse
// the columns of the snapshot.
import type {Snapshot} from "../core/snapshot";
import {steps_per_px} from "../core/snapshot";
import type {Camera, Drawing, Look, PopulationColumns, Tool} from "../core/messages";
import {
  clamped,
  fitted,
  is_whole_island_visible,
  minimap_frame,
  minimap_place,
  Size,
  to_world,
  visible_part
} from "./camera";
import {count_organisms, count_overview, density_scale, DensityGrid, join_tiles} from "./density";
import {Fallback} from "./fallback";
import {Families, FamilyColours} from "./families";
import {GlIsland} from "./gl_island";
import {Interpolator, KeptSnapshot} from "./interpolator";
import {healthiest, Label, place_labels} from "./labels";
import {
  colours_of,
  css,
  default_look,
  island_colours,
  packed,
  ScaleTable,
  ShapeStyle,
  styles_of,
  unknown
} from "./look";
import {
  dots_radius_pixels,
  health_scale_max,
  labels_are_readable,
  named_count,
  ranked_max,
  shown_health,
  shows_details,
  too_many_for_dots,
  too_small_to_see,
  traced_max,
  typical_radius_px,
} from "./marks";
import {circle_at} from "./picking";
import {inside_walls, Painter, Scene} from "./scene";
import {region_around, StreamedRegion, WantedView} from "./streamed_region";
import {Flashes, traced, Trails} from "./traces";

export type{WantedView} from "./streamed_region";

export interface Picked {
  organism: number|null; // ids
  food: number|null;
  poison: number|null;
  x_px: number; // the point of the island
  y_px: number;
  generation: number;
}

const hover_radius = 12; // CSS pixels

/** The radius of a mark on the screen, with the arc around a body. */
function radius_with_arc(radius: number, {form, edge_pixels}: ShapeStyle): number {
  return form !== "body" || radius < 0.8 * edge_pixels ? radius : radius + 1.6 * Math.min(edge_pixels, 0.4 * radius);
}

export class Renderer {
  #painter: Painter|null; // null while the graphics context is lost
  readonly #gl: WebGL2RenderingContext|null;
  #canvas_size: Size = {width: 1, height: 1};
  #ratio = 1;
  #wanted_camera: Camera|null = null; // null: the whole island
  #look: Look = default_look("vivid", "dark");
  #selected_id: number|null = null;
  #hovered_id: number|null = null; // by a panel
  #follows = false;
  #pointer: {x: number; y: number}|null = null;
  #tool: Tool = "select";
  #population: PopulationColumns|null = null;

  readonly #at = new Interpolator();
  readonly #trails = new Trails();
  readonly #flashes = new Flashes();
  readonly #region = new StreamedRegion();
  #snapshot_version = 0;
  #population_version = 0;
  #health_max = 100;

  #colours_key = "";
  #colours_version = 0;
  #organism_colours: Int32Array|null = null;
  #gene_range: [number, number]|null = null;
  #families: Families|null = null;
  #families_version = -1;
  readonly #family_colours = new FamilyColours();

  readonly #density = new DensityGrid();
  readonly #overview = new DensityGrid();
  #overview_version = 0;
  #whole_overview: KeptSnapshot|null = null; // densities of the whole island, if only a part is streamed
  #whole_overview_version = 0;

  #is_dirty = true;
  #drawn_blend = 1;
  #drawn_camera: Camera|null = null;
  #drawn: Drawing|null = null;
  #drawn_key = "";

  /** painter: draws instead of the canvas, for tests. */
  constructor(readonly canvas: OffscreenCanvas, painter: Painter|null = null) {
    if (painter) {
      this.#painter = painter;
      this.#gl = null;
      return;
    }
    const gl = (this.#gl = canvas.getContext("webgl2", {alpha: false, antialias: false, depth: false, stencil: false}));
    if (gl === null) {
      const context = canvas.getContext("2d", {alpha: false});
      if (context === null) {
        throw new Error("this browser offers neither WebGL2 nor Canvas2D in a worker");
      }
      this.#painter = new Fallback(context);
      return;
    }
    this.#painter = new GlIsland(gl);
    canvas.addEventListener("webglcontextlost", (event) => {
      event.preventDefault(); // asks the browser to restore the context
      this.#painter = null;
    });
    canvas.addEventListener("webglcontextrestored", () => {
      this.#painter = new GlIsland(gl);
      this.#is_dirty = true;
    });
  }

  /** Sets the size in CSS pixels and the device pixels per CSS pixel. */
  resize(width: number, height: number, pixel_ratio: number): void {
    this.#canvas_size = {width: Math.max(width, 1), height: Math.max(height, 1)};
    this.#ratio = pixel_ratio;
    const device_width = Math.max(Math.round(width * pixel_ratio), 1);
    const device_height = Math.max(Math.round(height * pixel_ratio), 1);
    if (this.canvas.width !== device_width || this.canvas.height !== device_height) {
      this.canvas.width = device_width;
      this.canvas.height = device_height;
    }
    this.#is_dirty = true;
  }

  /** null shows the whole island, also after a change of the size. */
  set_camera(camera: Camera|null): void {
    this.#wanted_camera = camera;
    this.#is_dirty = true;
  }

  set_look(look: Look): void {
    this.#look = look;
    this.#is_dirty = true;
  }

  /** hovered: the organism that a panel points at. */
  set_selection(selected: number|null, hovered: number|null, follow: boolean): void {
    this.#selected_id = selected;
    this.#hovered_id = hovered;
    this.#follows = follow;
    this.#is_dirty = true;
  }

  set_pointer(at: {x: number; y: number}|null, tool: Tool): void {
    this.#pointer = at;
    this.#tool = tool;
    this.#is_dirty = true;
  }

  set_population(columns: PopulationColumns|null): void {
    this.#population = columns;
    ++this.#population_version;
    this.#is_dirty = true;
  }

  /** Shows a snapshot. `now_ms`: performance.now() when it arrived. */
  add(snapshot: Snapshot, now_ms: number): void {
    const {info, organisms} = snapshot, is_whole = info.tile_px === 0;
    const camera = this.camera(), visible = camera === null ? null : visible_part(camera, this.#canvas_size);
    const with_trails = traced(snapshot, visible === null ? null : region_around(visible));
    if (this.#look.flashes && with_trails !== null && camera !== null && shows_details(camera)) {
      this.#flashes.add(this.#at.latest, snapshot, is_whole && organisms.id.length < traced_max ? null : visible);
    } else {
      this.#flashes.clear();
    }
    if (is_whole) {
      this.#whole_overview = null;
    }
    this.#at.add(snapshot, now_ms);
    this.#trails.add(info, with_trails);
    this.#health_max = health_scale_max(this.#at.latest.health, this.#at.latest.count);
    ++this.#snapshot_version;
    this.#is_dirty = true;
  }

  /** Takes densities of the whole island for the minimap, while only a part is streamed. */
  add_overview(snapshot: Snapshot): void {
    this.#whole_overview ??= new KeptSnapshot();
    this.#whole_overview.set(snapshot);
    ++this.#whole_overview_version;
    this.#is_dirty = true;
  }

  /** Drops the snapshots. Call it before another world or island is shown. */
  clear(): void {
    this.#at.clear();
    this.#trails.clear();
    this.#flashes.clear();
    this.#whole_overview = null;
    this.#region.forget();
    ++this.#snapshot_version;
    this.#is_dirty = true;
  }

  /** Whether draw() would draw something else than the last time. */
  needs_frame(now_ms: number): boolean {
    return this.#painter !== null && (this.#is_dirty || this.#blend_at(now_ms) !== this.#drawn_blend);
  }

  draw(now_ms: number): void {
    if (this.#painter === null) { // the graphics context is lost; it will be restored
      return;
    }
    this.#is_dirty = false;
    const blend = (this.#drawn_blend = this.#blend_at(now_ms));
    this.#follow(blend);
    const camera = (this.#drawn_camera = this.camera());
    if (camera === null) {
      this.#painter.draw(this.#scene({x_px: 0, y_px: 0, zoom: 1}, blend, this.#painter));
      return;
    }
    const scene = this.#scene(camera, blend, this.#painter);
    this.#painter.draw(scene);
    this.#describe(scene);
  }

  /** The camera of the last frame; differs from the one that was set while it follows an organism. Null before the first snapshot. */
  camera(): Camera|null {
    const island = this.#island();
    if (island === null) {
      return null;
    }
    return this.#wanted_camera === null ? fitted(this.#canvas_size, island) :
                                          clamped(this.#wanted_camera, this.#canvas_size, island);
  }

  /** Returns what is drawn at a point: the organism or item whose centre is within `radius` CSS pixels, or whose body contains the point.
   *  Null: the point is not on the island. */
  pick(x: number, y: number, radius: number): Picked|null {
    const camera = this.#drawn_camera;
    const {info, id, food, poison} = this.#at.latest;
    if (camera === null || info === null) {
      return null;
    }
    const place = to_world(camera, this.#canvas_size, {x, y});
    if (place.x < 0 || place.y < 0 || place.x > info.width_px || place.y > info.height_px) {
      return null;
    }
    const organism = this.#organism_at(x, y, radius);
    const item_at = (items: typeof food): number|null => {
      const found = circle_at(
        place.x, place.y, items.whole, (i) => items.x[i]! / steps_per_px, (i) => items.y[i]! / steps_per_px,
        () => info.item_radius_px, 1 / camera.zoom, radius);
      return found < 0 ? null : items.id[found]!;
    };
    return {
      organism: organism < 0 ? null : id[organism]!,
      food: item_at(food),
      poison: item_at(poison),
      x_px: place.x,
      y_px: place.y,
      generation: info.generation,
    };
  }

  /** The `count` healthiest organisms, the healthiest first. */
  healthiest(count: number): {id: number; health: number}[] {
    const {latest} = this.#at;
    return healthiest(latest, count).map((row) => ({id: latest.id[row]!, health: latest.health[row]! / steps_per_px}));
  }

  selected(): {x_px: number; y_px: number; health: number}|null {
    const {latest} = this.#at;
    const row = latest.index_of(this.#selected_id);
    return row < 0 ? null : {
      x_px: latest.x[row]! / steps_per_px,
      y_px: latest.y[row]! / steps_per_px,
      health: latest.health[row]! / steps_per_px
    };
  }

  /** What was drawn last; another object only after a change. Null before the first snapshot. */
  drawing(): Drawing|null {
    return this.#drawn;
  }

  /** The View to request now (SetView), if the island is streamed in part; null if the one returned last is still suitable. */
  view_to_request(now_ms: number): WantedView|null {
    const camera = this.camera();
    if (camera === null) {
      return null;
    }
    const look = this.#look;
    const details_of_all = (look.perception === "all" || look.forces === "all") && shows_details(camera);
    const no_single_organism_matters = look.colour_by === "" && !details_of_all && this.#selected_id === null;
    const small = typical_radius_px * camera.zoom < dots_radius_pixels;
    const detail = this.#wants_density(camera) ? "DETAIL_DENSITY" :
      small && no_single_organism_matters      ? "DETAIL_DOTS" :
                                                 "DETAIL_FULL";
    return this.#region.update(camera, this.#canvas_size, detail, now_ms);
  }

  /** Call after the subscription was renewed. */
  forget_view(): void {
    this.#region.forget();
  }

  /** Frees the graphics memory. */
  close(): void {
    this.#painter = null;
    this.#gl?.getExtension("WEBGL_lose_context")?.loseContext();
  }

  #island(): Size|null {
    const {info} = this.#at.latest;
    return info === null ? null : {width: info.width_px, height: info.height_px};
  }

  #blend_at(now_ms: number): number {
    return this.#look.interpolate ? this.#at.blend_at(now_ms) : 1;
  }

  /** Keeps the followed organism in the centre. */
  #follow(blend: number): void {
    const row = this.#follows ? this.#at.latest.index_of(this.#selected_id) : -1;
    if (row >= 0) {
      const {zoom} = this.camera()!;
      this.#wanted_camera = {
        x_px: this.#at.x_at(row, blend) / steps_per_px,
        y_px: this.#at.y_at(row, blend) / steps_per_px,
        zoom
      };
    }
  }

  #organism_at(x: number, y: number, radius: number): number {
    const camera = this.#drawn_camera;
    if (camera === null) {
      return -1;
    }
    const at = this.#at;
    const place = to_world(camera, this.#canvas_size, {x, y});
    return circle_at(
      place.x, place.y, at.latest.count, (i) => at.x_at(i, this.#drawn_blend) / steps_per_px,
      (i) => at.y_at(i, this.#drawn_blend) / steps_per_px, (i) => at.latest.radius[i]! / steps_per_px, 1 / camera.zoom,
      radius);
  }

  #organism_count(): number {
    const {info, count} = this.#at.latest;
    return Math.max(info!.counts.organisms, Number(info!.live?.organism_count ?? 0), count);
  }

  #wants_density(camera: Camera): boolean {
    const look = this.#look;
    const count = this.#organism_count();
    const is_too_many = (this.#painter?.organisms_max ?? Infinity) < count ||
      (too_small_to_see(camera) && too_many_for_dots(camera, this.#canvas_size, this.#at.latest.info!, count));
    return look.density && look.colour_by === "" && is_too_many;
  }

  #scene(camera: Camera, blend: number, painter: Painter): Scene {
    const at = this.#at, look = this.#look, canvas = this.#canvas_size, ratio = this.#ratio;
    const {latest} = at;
    const colours = colours_of(look);
    const population = this.#current_population();
    this.#colour_organisms(population);
    const shown_camera = this.#drawn_camera;
    this.#drawn_camera = camera; // organism_at() reads it
    const pointed_at = this.#pointer !== null && this.#tool === "select" ?
      this.#organism_at(this.#pointer.x, this.#pointer.y, hover_radius) :
      latest.index_of(this.#hovered_id);
    this.#drawn_camera = shown_camera;
    const scene: Scene = {
      canvas,
      ratio,
      camera,
      look,
      colours,
      styles: styles_of(look),
      at,
      blend,
      shown_s: at.shown_s(blend),
      snapshot_version: this.#snapshot_version,
      colours_version: this.#colours_version,
      organism_colours: this.#organism_colours,
      health_max: this.#health_max,
      selected: latest.index_of(this.#selected_id),
      pointed_at,
      population: population !== null && shows_details(camera) ? population : null,
      trails: look.trails && shows_details(camera) ? this.#trails : null,
      flashes: look.flashes ? this.#flashes.all : [],
      shows: "organisms",
      density: this.#density,
      density_scale: null,
      labels: [],
      minimap: null,
      preview: null,
    };
    if (latest.info === null) {
      return scene;
    }
    const island = {width: latest.info.width_px, height: latest.info.height_px};
    // After a change of the level of detail, densities are drawn until the first snapshot with the new detail arrives.
    if (latest.densities.length > 0) {
      scene.shows = "density";
      join_tiles(this.#density, latest.densities, latest.info.tile_px);
    } else if (this.#wants_density(camera)) {
      scene.shows = "density";
      count_organisms(this.#density, at, blend, visible_part(camera, canvas), island, camera.zoom);
    } else if (latest.organism_dots.count > 0) {
      scene.shows = "dots";
    }
    scene.density_scale = scene.shows === "density" ? density_scale(look.palette, this.#density) : null;
    if (scene.shows !== "density") {
      scene.labels = this.#labels(scene, painter);
    }
    if (look.minimap && !is_whole_island_visible(camera, canvas, island)) {
      const whole = this.#whole_overview;
      const version = whole === null ? this.#snapshot_version : -1 - this.#whole_overview_version;
      if (this.#overview_version !== version) {
        this.#overview_version = version;
        count_overview(this.#overview, whole ?? latest, island, (whole ?? latest).info!.tile_px);
      }
      const place = minimap_place(canvas, island);
      scene.minimap = {
        place,
        frame: minimap_frame(place, camera, canvas),
        grid: this.#overview,
        scale: density_scale("viridis", this.#overview),
        version: this.#overview_version,
      };
    }
    if (this.#pointer !== null && (this.#tool === "food" || this.#tool === "poison" || this.#tool === "organism")) {
      const radius_px = this.#tool === "organism" ? typical_radius_px : latest.info.item_radius_px;
      const colour = this.#tool === "organism" ? island_colours.classic.body : island_colours.classic[this.#tool];
      scene.preview = {...this.#pointer, radius: Math.max(radius_px * camera.zoom, 3), colour};
    }
    return scene;
  }

  #current_population(): PopulationColumns|null {
    const {info} = this.#at.latest;
    const of = this.#population;
    return of !== null && info !== null && of.generation === info.generation && of.island === info.island ? of : null;
  }

  /** Computes the colour of each organism after a change of the snapshot, the population or the colouring. */
  #colour_organisms(population: PopulationColumns|null): void {
    const look = this.#look;
    const {latest} = this.#at;
    const key = look.colour_by === "" ?
      "" :
      `${this.#snapshot_version} ${this.#population_version} ${look.colour_by} ${look.palette}`;
    if (key === this.#colours_key) {
      return;
    }
    this.#colours_key = key;
    ++this.#colours_version;
    this.#gene_range = null;
    if (look.colour_by === "") {
      this.#organism_colours = null;
      return;
    }
    if (this.#organism_colours === null || this.#organism_colours.length < latest.count) {
      this.#organism_colours = new Int32Array(Math.max(latest.count, 2 * (this.#organism_colours?.length ?? 0)));
    }
    const colours = this.#organism_colours;
    if (look.colour_by === "health") {
      const scale = new ScaleTable(look.palette, 0, this.#health_max);
      for (let i = 0; i < latest.count; ++i) {
        colours[i] = scale.at(latest.health[i]! / steps_per_px);
      }
      return;
    }
    const grey = packed(unknown);
    if (look.colour_by === "lineage") {
      const founders = population?.founders ?? null;
      if (this.#families_version !== this.#population_version) {
        this.#families_version = this.#population_version;
        this.#families = founders === null ? null : new Families(founders);
        if (this.#families !== null) {
          this.#family_colours.update(this.#families);
        }
      }
      const families = this.#families;
      for (let i = 0; i < latest.count; ++i) {
        colours[i] =
          families === null || population === null ? grey : packed(this.#family_colours.of(families.of(latest.id[i]!)));
      }
      return;
    }
    const values = population?.genes[population.gene_names.indexOf(look.colour_by)];
    if (values === undefined) {
      colours.fill(grey);
      return;
    }
    let [low, high] = [Infinity, -Infinity];
    for (const value of values) {
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
    this.#gene_range = values.length > 0 ? [low, high] : null;
    const scale = new ScaleTable(look.palette, low, high);
    for (let i = 0; i < latest.count; ++i) {
      const value = values[latest.id[i]!];
      colours[i] = value === undefined || Number.isNaN(value) ? grey : scale.at(value);
    }
  }

  /** Labels: the health of the visible organisms if there is room; otherwise of the healthiest, the selected and the pointed one. */
  #labels(scene: Scene, painter: Painter): Label[] {
    const {at, blend, camera, canvas, styles} = scene;
    const {latest} = at;
    const named = latest.count <= ranked_max ? healthiest(latest, named_count) : [];
    for (const row of [scene.selected, scene.pointed_at]) {
      if (row >= 0 && !named.includes(row)) {
        named.push(row);
      }
    }
    let labelled = named;
    if (labels_are_readable(camera, canvas, 0, styles.label_zoom_min, painter.label_height)) {
      const visible = visible_part(camera, canvas);
      const shown: number[] = [];
      for (let row = 0; row < latest.count; ++row) {
        const x = at.x_at(row, blend) / steps_per_px;
        const y = at.y_at(row, blend) / steps_per_px;
        if (
          x >= visible.left && x <= visible.left + visible.width && y >= visible.top &&
          y <= visible.top + visible.height) {
          shown.push(row);
        }
      }
      if (
        shown.length > 0 &&
        labels_are_readable(camera, canvas, shown.length, styles.label_zoom_min, painter.label_height)) {
        labelled = shown;
      }
    }
    const inside = inside_walls(scene, {width: latest.info!.width_px, height: latest.info!.height_px});
    const labels = labelled.map((row): Label => {
      const health = String(shown_health(latest.health[row]!));
      const text = named.includes(row) ? `#${latest.id[row]!} ${health}` : health;
      return {
        text,
        x: inside.left + (at.x_at(row, blend) / steps_per_px) * camera.zoom,
        y: inside.top + (at.y_at(row, blend) / steps_per_px) * camera.zoom,
        radius: radius_with_arc((latest.radius[row]! / steps_per_px) * camera.zoom, styles.organism),
        width: painter.measure(text, scene.ratio),
        left: 0,
        top: 0,
      };
    });
    place_labels(labels, painter.label_height, inside);
    return labels;
  }

  #what_is_pointed_at(scene: Scene): Drawing["pointed_at"] {
    if (this.#pointer === null) {
      return null;
    }
    if (this.#tool === "select") {
      return {organism: scene.pointed_at < 0 ? null : scene.at.latest.id[scene.pointed_at]!, food: null, poison: null};
    }
    const picked = this.pick(this.#pointer.x, this.#pointer.y, hover_radius);
    return picked === null ? null : {organism: picked.organism, food: picked.food, poison: picked.poison};
  }

  /** Keeps a description of the frame for legends and hints. */
  #describe(scene: Scene): void {
    const {at} = scene;
    const pointed_at = this.#what_is_pointed_at(scene);
    const scale = scene.density_scale;
    const by_lineage =
      this.#look.colour_by === "lineage" && this.#current_population() !== null ? this.#families : null;
    const key = [
      scene.shows,
      scale?.high,
      this.#density.cell_px,
      this.#health_max,
      this.#gene_range,
      at.latest.has_headings,
      this.#colours_key === "" ? "" : this.#look.colour_by,
      by_lineage === null ? "" : this.#families_version,
      pointed_at?.organism,
      pointed_at?.food,
      pointed_at?.poison,
      pointed_at === null,
    ].join();
    if (key === this.#drawn_key) {
      return;
    }
    this.#drawn_key = key;
    const others = by_lineage === null ? 0 : by_lineage.size - by_lineage.shown.reduce((sum, {size}) => sum + size, 0);
    this.#drawn = {
      renderer: this.#painter!.kind,
      shows: scene.shows,
      density: scale === null ? null : {cell_px: this.#density.cell_px, most: scale.high},
      health_max: this.#health_max,
      gene_range: this.#gene_range,
      headings: at.latest.has_headings,
      pointed_at,
      lineages: by_lineage === null ?
        null :
        by_lineage.shown.map(({founder, size}, i) => ({founder, count: size, colour: css(this.#family_colours.of(i))})),
      lineage_others: by_lineage === null ? null : {
        lineages: by_lineage.count - by_lineage.shown.length,
        count: others,
        placed: (this.#population?.founders?.length ?? 0) - by_lineage.size
      },
    };
  }
}
