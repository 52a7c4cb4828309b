// SnapshotFeed: the island that one pane shows, its newest snapshot, and how it is drawn.
import type {Drawing, FromWorker, Look, Reading} from "../core/messages";
import type {GeneGroup} from "../core/protocol";
import type {SnapshotInfo} from "../core/snapshot";
import {default_look} from "../render/look";

import {type Changes, Listeners} from "./changes";
import type {Server} from "./server";
import type {KnownWorld} from "./worlds";
import {of_browser} from "./storage";

const rate_default_hz = 30; // snapshots per second
const drawn_wait_ms = 5000; // for the first snapshot after a seek

type SnapshotMessage = Extract<FromWorker, {kind: "snapshot"}>;

export class SnapshotFeed {
  /** Name of the world that is drawn: a live world or a replay. */
  world = "";
  island = 0;
  snapshot: SnapshotInfo|null = null; // the newest drawn
  reading: Reading|null = null;
  drawing: Drawing|null = null; // what the worker drew last
  look: Look = stored_look();
  problem = ""; // why nothing is drawn: the server refused the subscription or the replay
  rate_hz = rate_default_hz; // the greatest number of snapshots per second
  readonly taken = new Listeners<SnapshotInfo>(); // called after a snapshot and what belongs to it were taken
  readonly #changes: Changes;

  constructor(readonly server: Server, readonly pane: number, changes: Changes) {
    this.#changes = changes;
  }

  get healthiest(): Reading["healthiest"] {
    return this.reading?.healthiest ?? [];
  }

  get info(): KnownWorld|null {
    return this.server.worlds.find(this.world);
  }

  get gene_names(): string[] {
    return this.info?.gene_names ?? [];
  }

  get gene_groups(): GeneGroup[] {
    return this.info?.gene_groups ?? [];
  }

  get tick(): number {
    return this.newer_snapshot?.tick ?? this.info?.tick ?? 0;
  }

  /** The snapshot, if it is newer than `info`. */
  get newer_snapshot(): SnapshotInfo|null {
    const snapshot = this.snapshot, info = this.info;
    const is_newer = snapshot !== null && snapshot.world === this.world &&
      (!info || (info.run_id === snapshot.run_id && snapshot.tick > info.tick));
    return is_newer ? snapshot : null;
  }

  /** Forgets the island that was shown, because this one is shown next. */
  forget(world: string, island: number): void {
    this.world = world;
    this.island = island;
    this.snapshot = this.reading = null;
    this.problem = "";
  }

  subscribe(): void {
    this.server.post({kind: "look", pane: this.pane, look: this.look});
    this.#post_watch();
  }

  unsubscribe(): void {
    this.server.post({kind: "unwatch", pane: this.pane});
  }

  #post_watch(): void {
    this.server.post({kind: "watch", pane: this.pane, world: this.world, island: this.island, rate_hz: this.rate_hz});
  }

  /** Limits the number of snapshots per second; null: the default. */
  set_rate(rate_hz: number|null): void {
    const before = this.rate_hz;
    this.rate_hz = rate_hz ?? rate_default_hz;
    if (this.rate_hz !== before && this.world) {
      this.#post_watch();
    }
  }

  /** Whether the rate differs from the default. */
  get has_rate(): boolean {
    return this.rate_hz !== rate_default_hz;
  }

  set_look(change: Partial<Look>): void {
    this.look = {...this.look, ...change};
    of_browser.set("look", JSON.stringify(this.look));
    this.server.post({kind: "look", pane: this.pane, look: this.look});
    this.#changes.notify();
  }

  take(message: SnapshotMessage): void {
    this.snapshot = message.info;
    this.reading = message.reading;
    this.problem = "";
  }

  /** Resolves when a snapshot of the shown world is drawn, or after drawn_wait_ms.
   *
   *  tick  of the snapshot, unless the world runs; null: any */
  drawn(tick: number|null = null): Promise<void> {
    return new Promise((resolve) => {
      const end = (): void => {
        clearTimeout(timer);
        end_listening();
        resolve();
      };
      const listener = (snapshot: SnapshotInfo): void => {
        const is_it = tick === null || snapshot.tick === tick || snapshot.state === "RUN_STATE_RUNNING";
        if (snapshot.world === this.world && is_it) {
          end();
        }
      };
      const timer = setTimeout(end, drawn_wait_ms), end_listening = this.taken.listen(listener);
      if (this.snapshot) {
        listener(this.snapshot);
      }
    });
  }
}

function stored_look(): Look {
  const look = default_look("vivid", matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark");
  look.flashes = !matchMedia("(prefers-reduced-motion: reduce)").matches;
  try {
    const stored: {[name: string]: unknown} = JSON.parse(of_browser.get("look") || "{}");
    const known = Object.entries(look).filter(([name, value]) => typeof stored[name] === typeof value);
    return {...look, ...Object.fromEntries(known.map(([name]) => [name, stored[name]]))};
  } catch {
    return look; // the stored text is not of this page
  }
}
