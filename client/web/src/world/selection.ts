// Selection: the selected organism of a pane. It ends with its generation, because the next one uses the same ids, and
// begins again when its generation is shown again.
import type {OrganismInfo} from "../core/protocol";
import type {SnapshotInfo} from "../core/snapshot";

import type {Changes} from "./changes";
import type {SnapshotFeed} from "./feed";
import type {Refusal} from "./server";

type Place = {
  x_px: number; y_px: number; health: number
};

export class Selection {
  id: number|null = null; // of the selected organism
  follow = false; // whether the camera follows it
  is_lost = false; // the organism that the camera followed is dead, or is not in what is shown now
  at: Place|null = null; // in the drawn snapshot
  info: OrganismInfo|null = null; // polled 4 times a second
  #pending = false;
  #info_tick = -1;
  #remembered: {run_id: string; island: number; generation: number; id: number; follow: boolean}|null =
    null; // what was selected last
  readonly #feed: SnapshotFeed;
  readonly #changes: Changes;
  readonly #on_change: () => void;

  /** on_change: called at once after the user has selected another organism. */
  constructor(feed: SnapshotFeed, changes: Changes, on_change: () => void) {
    this.#feed = feed;
    this.#changes = changes;
    this.#on_change = on_change;
  }

  select(organism: number|null): void {
    if (organism === this.id) {
      return;
    }
    this.id = organism;
    this.info = null;
    this.#info_tick = -1;
    this.follow = organism !== null && this.follow;
    this.is_lost = false;
    this.#remember();
    this.post();
    this.#on_change();
    this.#changes.notify();
  }

  set_follow(follow: boolean): void {
    this.follow = follow && this.id !== null;
    this.is_lost = false;
    this.#remember();
    this.post();
    this.#changes.notify();
  }

  /** Ends the selection, because another island or another run is shown. */
  forget(): void {
    this.id = this.at = this.info = null;
    this.#lose();
  }

  post(): void {
    const {server, pane} = this.#feed;
    server.post({kind: "select", pane, organism: this.id, hovered: null, follow: this.follow});
  }

  /** Call it before the feed takes the snapshot. */
  follow_generation(next: SnapshotInfo): void {
    const remembered = this.#remembered, before = this.#feed.snapshot;
    const again = remembered !== null && remembered.run_id === next.run_id && remembered.island === this.#feed.island &&
      remembered.generation === next.generation;
    const ends = this.id !== null && before !== null && before.generation !== next.generation;
    if (again ? this.id === null : ends) {
      const {info, follow} = this;
      this.id = again ? remembered.id : null;
      this.#lose();
      this.follow = again && remembered.follow;
      this.at = this.info = null;
      this.#info_tick = -1;
      this.post();
      if (!again && info?.number !== undefined) {
        this.is_lost = false;
        void this.#find_again(info, follow, next);
      }
    }
  }

  /** With births, finds the organism in the next interval, where it has another id: first come the prey, then the
   *  predators, each in the order of their numbers, and then those that were born in this interval. */
  async #find_again(sought: OrganismInfo, follow: boolean, next: SnapshotInfo): Promise<void> {
    const {world, island, server} = this.#feed, rank = (one: OrganismInfo): number =>
      (one.species === "SPECIES_PREDATOR" ? 2 ** 32 : 0) + (one.number ?? 0);
    for (let low = 0, high = next.live?.organism_count ?? 0; low < high;) {
      const organism = (low + high) >> 1;
      const found = await server.request("get_organism", {world, island, organism}).catch(() => null);
      const is_shown = this.id === null && world === this.#feed.world && island === this.#feed.island;
      if (found?.generation !== next.generation || !is_shown) {
        return;
      }
      const is_born_here = found.placed_tick !== undefined;
      if (!is_born_here && rank(found) === rank(sought)) {
        this.select(organism);
        this.set_follow(follow);
        return;
      }
      [low, high] = is_born_here || rank(found) > rank(sought) ? [low, organism] : [organism + 1, high];
    }
    this.is_lost = follow;
    this.#changes.notify();
  }

  /** Call it after the feed has taken a snapshot. */
  take(at: Place|null): void {
    if (this.id !== null && this.#remembered === null) { // it was selected before the first snapshot
      this.#remember();
    }
    this.at = this.id === null ? null : at;
  }

  #lose(): void {
    this.is_lost ||= this.follow;
    this.follow = false;
  }

  #remember(): void {
    const {snapshot, island} = this.#feed, {id, follow} = this;
    this.#remembered =
      id === null || !snapshot ? null : {run_id: snapshot.run_id, island, generation: snapshot.generation, id, follow};
  }

  /** Reads `info` if a newer snapshot is drawn. */
  poll(tick: number): void {
    const organism = this.id, {world, island, server} = this.#feed;
    if (organism === null || this.#pending || tick === this.#info_tick) {
      return;
    }
    this.#pending = true;
    this.#info_tick = tick;
    const is_selected = (): boolean => organism === this.id && world === this.#feed.world;
    server.request("get_organism", {world, island, organism})
      .then(
        (info) => {
          // With births, another organism has the same id in the next interval.
          const is_other = info.number !== undefined && info.generation !== this.#feed.snapshot?.generation;
          if (is_selected() && island === this.#feed.island && !is_other) {
            this.info = info;
            if (this.follow && info.alive !== true) {
              this.#lose();
              this.#remember();
              this.post();
            }
            this.#changes.notify();
          }
        },
        (error: Refusal) => {
          // With births, the next interval may already have begun, in which the organism has another id.
          const has_number = this.info?.number !== undefined;
          if (error.reason === "REASON_ORGANISM_NOT_FOUND" && is_selected() && !has_number) {
            const {follow} = this;
            this.select(null);
            this.is_lost = follow;
          }
        })
      .finally(() => {
        this.#pending = false;
        if (organism !== this.id) {
          this.#on_change();
        }
      });
  }
}
