// Feed: the subscriptions to snapshots of one pane: of one island, or of all islands of the world, which it shows as
// tiles.
//
// Views   Larger islands are streamed in tiles of the visible region, smaller ones whole. While one island is streamed
//         in part, a second subscription sends densities of the whole island once a second, for the minimap.
import type {Subscription} from "../core/core_session";
import type {Detail, View} from "../core/protocol";
import type {Snapshot} from "../core/snapshot";
import type {Renderer} from "../render/renderer";
import {tile_rate_hz} from "../render/tiles";
import type {Connection} from "./connection";

const unacknowledged_max = 2;
const view_ms = 200; // least time between two views
const is_local = /^(localhost|127\.|\[::1\])/.test(location.hostname); // the server is on this machine
// Whole snapshots are faster to decode, so a server on the same machine sends larger islands whole. Between the two
// numbers nothing changes.
const view_from = is_local ? 20_000 : 5_000, whole_below = 0.8 * view_from; // organisms
const bytes_per_s_max = is_local ? 4_000_000 : 500_000;

export interface Watched {
  world: string;
  island: number;
  rate_hz: number;
}

export class Feed {
  watched: Watched|null = null;
  /** The number of islands that are shown as tiles; 0: only watched.island. */
  islands = 0;
  subscription: Subscription|null = null;
  overview: Subscription|null = null;
  readonly #connection: Connection;
  #has_view = false; // the subscription is limited to a view
  #view_ms = 0; // when the last view was requested
  #detail: Detail = "DETAIL_UNSPECIFIED"; // of the last view of all islands

  constructor(connection: Connection) {
    this.#connection = connection;
  }

  /** Watches something else, or nothing. */
  watch(watched: Watched|null, islands: number): void {
    this.stop();
    this.watched = watched;
    this.islands = islands;
    this.#has_view = false;
  }

  /** Subscribes. Replaces the last subscriptions. */
  start(renderer: Renderer|null): void {
    this.stop();
    const {core, may_stream} = this.#connection;
    if (!this.watched || !core || core.failed || !may_stream) {
      return;
    }
    const {world, island, rate_hz} = this.watched, all = this.islands > 0, now_ms = performance.now();
    this.#detail = "DETAIL_UNSPECIFIED";
    this.#view_ms = now_ms;
    this.subscription = core.subscriptions.subscribe({
      subscribe_snapshots: {
        world,
        ...(all ? {} : {island}),
        rate_hz: all ? tile_rate_hz(rate_hz, this.islands) : rate_hz,
        codec: "CODEC_DELTA",
        unacknowledged_max,
        headings: true,
        species: true,
        ...(this.#has_view ? {view: {detail: "DETAIL_FULL", bytes_per_s_max, ...this.#wanted(renderer, now_ms)}} : {})
      }
    });
    if (this.#has_view && !all) {
      this.overview = core.subscriptions.subscribe(
        {subscribe_snapshots: {world, island, rate_hz: 1, codec: "CODEC_DELTA", view: {detail: "DETAIL_DENSITY"}}});
    }
    this.#connection.flush();
  }

  stop(): void {
    for (const subscription of [this.subscription, this.overview]) {
      if (subscription) {
        this.#connection.core?.subscriptions.unsubscribe(subscription);
      }
    }
    this.#connection.flush();
    this.forget();
  }

  /** Forgets the subscriptions, because their session has ended. */
  forget(): void {
    this.subscription = this.overview = null;
  }

  /** Subscribes again if a snapshot shows that a view is needed now, or no more. */
  follow_size({info}: Snapshot, renderer: Renderer|null): void {
    const organisms = info.counts.organisms * Math.max(this.islands, 1);
    const needs_view = organisms >= view_from || (this.#has_view && organisms >= whole_below);
    if (needs_view !== this.#has_view) {
      this.#has_view = needs_view;
      this.start(renderer);
    }
  }

  /** Requests another view after the camera has moved. */
  follow_camera(renderer: Renderer, now_ms: number): void {
    if (this.#has_view && this.subscription && now_ms - this.#view_ms >= view_ms) {
      const view = this.#wanted(renderer, now_ms);
      if (view) {
        this.#view_ms = now_ms;
        this.#connection.core?.subscriptions.set_view(this.subscription, {...view, bytes_per_s_max});
      }
    }
  }

  /** The view to request now; null if the last one is still suitable. */
  #wanted(renderer: Renderer|null, now_ms: number): View|null {
    if (this.islands === 0) {
      return renderer?.view.view_to_request(now_ms) ?? null;
    }
    const detail = renderer?.view.detail() ?? "DETAIL_FULL";
    if (detail === this.#detail) {
      return null;
    }
    this.#detail = detail;
    return {detail};
  }
}
