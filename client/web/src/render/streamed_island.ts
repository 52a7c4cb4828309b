// StreamedIsland: the snapshots of one island, and what is derived from them when they arrive: trails, flashes, the
// scale of health.
//
// add() copies what it needs: the decoder may reuse the columns of the snapshot.
import type {Camera, Look, Reading} from "../core/messages";
import {type Snapshot, type SnapshotInfo, steps_per_px} from "../core/snapshot";
import {type Size, visible_part} from "./camera";
import {continues, Interpolator, KeptSnapshot} from "./interpolator";
import {healthiest} from "./labels";
import {health_scale_max, shows_details, traced_max} from "./marks";
import {region_around} from "./streamed_region";
import {Flashes, traced, Trails} from "./traces";

const healthiest_count = 5, reading_ms = 400;

export class StreamedIsland {
  readonly at = new Interpolator();
  readonly trails = new Trails();
  readonly flashes = new Flashes();
  version = 0; // changes with the snapshots
  health_max = 100;
  reading: Reading|null = null; // the last one that read() returned
  #read_ms = 0;
  /** Densities of the whole island, while only a part is streamed. */
  whole: KeptSnapshot|null = null;
  whole_version = 0;

  /** Shows a snapshot. `now_ms`: performance.now() when it arrived; camera: the present one. */
  add(snapshot: Snapshot, now_ms: number, camera: Camera|null, canvas: Size, look: Look): void {
    const {info, organisms} = snapshot, is_whole = info.tile_px === 0;
    const visible = camera === null ? null : visible_part(camera, canvas);
    const with_trails = traced(snapshot, visible === null ? null : region_around(visible));
    if (look.flashes && with_trails !== null && camera !== null && shows_details(camera)) {
      this.flashes.add(this.at.latest, snapshot, is_whole && organisms.id.length < traced_max ? null : visible);
    } else {
      this.flashes.clear();
    }
    if (is_whole) {
      this.whole = null;
    }
    this.at.add(snapshot, now_ms);
    this.trails.add(info, with_trails);
    this.health_max = health_scale_max(this.at.latest.health, this.at.latest.count);
    ++this.version;
  }

  /** Takes densities of the whole island for the minimap, while only a part is streamed. */
  add_overview(snapshot: Snapshot): void {
    this.whole ??= new KeptSnapshot();
    this.whole.set(snapshot);
    ++this.whole_version;
  }

  /** Drops the snapshots. */
  clear(): void {
    this.at.clear();
    this.trails.clear();
    this.flashes.clear();
    this.whole = this.reading = null;
    ++this.version;
  }

  /** The size of the island; null before the first snapshot. */
  get size(): Size|null {
    const {info} = this.at.latest;
    return info === null ? null : {width: info.width_px, height: info.height_px};
  }

  get organism_count(): number {
    const {info, count} = this.at.latest;
    return Math.max(info?.counts.organisms ?? 0, info?.live?.organism_count ?? 0, count);
  }

  /** What the page shows now. The labels show it, too, until the generation ends. */
  read(info: SnapshotInfo, now_ms: number): Reading {
    const {reading} = this, is_running = info.state === "RUN_STATE_RUNNING";
    if (reading !== null && is_running && continues(info, reading.info) && now_ms < this.#read_ms + reading_ms) {
      return reading;
    }
    this.#read_ms = now_ms;
    return (this.reading = {info, healthiest: this.#healthiest()});
  }

  #healthiest(): Reading["healthiest"] {
    const {latest} = this.at;
    return healthiest(latest, healthiest_count)
      .map((row) => ({id: latest.id[row]!, health: latest.health[row]! / steps_per_px}));
  }

  /** The place and the health of a living organism. */
  organism(id: number|null): {x_px: number; y_px: number; health: number}|null {
    const {latest} = this.at, row = latest.index_of(id);
    return row < 0 ? null : {
      x_px: latest.x[row]! / steps_per_px,
      y_px: latest.y[row]! / steps_per_px,
      health: latest.health[row]! / steps_per_px
    };
  }
}
