// BreedingFeed: chooses the generation whose breeding the glass box shows, and reads it from the server page by page.
// No DOM.
//
// Following  In a fast world there is always a newer generation. The feed waits until the pending one has arrived, and
//            for a short time after each change, so that something is shown.
import type {Breeding} from "../core/protocol";
import {glass_box_texts} from "../texts/glass_box";
import {origin_run_of} from "../world/origin";
import type {ViewedWorld} from "../world/world";
import {type Comparison, compare} from "./comparison";
import {type BreedingKey, BreedingRecord, same_key} from "./record";
import type {Moment, Stepper} from "./stepper";

const shown_min_ms = 500; // least time for which a breeding stays while the feed follows a fast world
const shown_after_playing_ms = 1500; // … and after the breeding was played to its end

export interface FeedListener {
  /** Something has arrived, or a request has failed. */
  changed(): void;
  /** The steps of another breeding begin. at_end: those of the last one were at their end. */
  begun(at_end: boolean): void;
  /** The sought organism was not picked when this generation bred. */
  not_picked(organism: number, generation: number): void;
}

export class BreedingFeed {
  shown: BreedingRecord|null = null;
  comparison: Comparison|null = null; // for `shown`; null until all contenders have arrived
  problem = ""; // why no more arrives
  origin_run = ""; // id of the run in which the chosen generation bred, if the shown world is a fork of it
  newest = 0; // the generation before the shown one; 0: none yet
  last = 0; // the last generation that has bred; in a replay, it may be later than the newest
  chosen = 0;
  #next: BreedingRecord|null = null; // replaces `shown` when its first page has arrived
  #pending = false;
  #next_change_ms = 0; // earliest time to show a newer generation
  #sought: number|null = null; // show the first pick of this organism
  readonly #stepper: Stepper;
  readonly #listener: FeedListener;

  constructor(stepper: Stepper, listener: FeedListener) {
    this.#stepper = stepper;
    this.#listener = listener;
  }

  /** sought  steps to the first pick of this organism as soon as it has been received; null: to the beginning */
  choose(generation: number, sought: number|null): void {
    this.#sought = sought;
    if (Number.isInteger(generation)) {
      this.chosen = generation;
    }
  }

  try_again(): void {
    this.problem = this.origin_run = "";
  }

  /** follow  shows the newest generation unless the user is in the middle of the steps */
  update(world: ViewedWorld, follow: boolean): void {
    this.#choose_record(world, follow);
    this.#seek_pick();
    this.#request(world);
  }

  #choose_record(world: ViewedWorld, follow: boolean): void {
    const snapshot = world.snapshot;
    if (!snapshot || world.has_births) {
      this.#forget();
      return;
    }
    const of = {world: world.shown, run_id: snapshot.run_id, island: world.island};
    this.newest = Math.max(0, snapshot.generation - 1);
    const replay = world.info?.replay;
    this.last = replay ? Math.max(this.newest + 1, replay.last_generation ?? 0) - 1 : this.newest;
    // A replay shows the same run as the live world, so its breedings are the same.
    if (this.shown && (this.shown.key.run_id !== of.run_id || this.shown.key.island !== of.island)) {
      this.shown = null;
      this.comparison = null;
      this.#stepper.load(0, 0);
    }
    if (this.#next && !same_key({...of, generation: this.#next.key.generation}, this.#next.key)) {
      this.#next = null;
    }
    if (this.last === 0) {
      return;
    }
    const now = performance.now();
    if (this.#stepper.playing) {
      this.#next_change_ms = now + shown_after_playing_ms;
    }
    const idle = this.#next === null || this.problem !== "";
    const settled = !this.#stepper.playing && (this.#stepper.at_begin || this.#stepper.at_end);
    if (follow && this.newest > 0 && idle && settled && now >= this.#next_change_ms) {
      this.chosen = this.newest;
    }
    this.chosen = Math.min(Math.max(this.chosen, 1), this.last);
    const key: BreedingKey = {...of, generation: this.chosen}, current = (this.#next ?? this.shown)?.key;
    if (
      !current || current.generation !== key.generation || current.run_id !== key.run_id ||
      current.island !== key.island) {
      this.#next = new BreedingRecord(key);
      this.problem = this.origin_run = "";
      this.#next_change_ms = now + shown_min_ms;
    }
  }

  #forget(): void {
    this.shown = this.#next = this.comparison = null;
    this.newest = this.last = 0;
    this.problem = this.origin_run = "";
    this.#stepper.load(0, 0);
  }

  #request(world: ViewedWorld): void {
    const record = this.#next ?? this.shown;
    if (!record || this.#pending || this.problem !== "") {
      return;
    }
    // While a pick is sought, all picks are needed.
    const needed: Moment = this.#next ? {stage: "scaling", index: 0} :
      this.#sought !== null           ? {stage: "picking", index: record.pick_count} :
                                        this.#stepper.moment;
    const fields = record.wanted(needed);
    if (!fields) {
      return;
    }
    this.#pending = true;
    world.server.request("get_breeding", {...fields, world: world.shown})
      .then(
        (breeding) => this.#receive(record, breeding),
        (error: Error) => {
          if (record === this.#next || record === this.shown) {
            this.problem = error.message;
            this.origin_run = origin_run_of(error);
          }
        })
      .finally(() => {
        this.#pending = false;
        this.#listener.changed();
      });
  }

  #receive(record: BreedingRecord, breeding: Breeding): void {
    if (record !== this.#next && record !== this.shown) {
      return; // another generation has been chosen
    }
    if (!record.add(breeding)) {
      this.problem = glass_box_texts.wrong_generation(record.key.generation);
      return;
    }
    if (record === this.#next) {
      const at_end = this.shown !== null && this.#stepper.at_end && !this.#stepper.at_begin;
      this.shown = record;
      this.#next = null;
      this.comparison = null;
      this.#stepper.load(record.pick_count, record.descendant_count);
      this.#listener.begun(at_end);
    }
    this.comparison ??= compare(record);
  }

  /** Steps to the first pick of the sought organism as soon as this pick has been received. */
  #seek_pick(): void {
    if (this.#sought === null || this.#next || !this.shown) {
      return;
    }
    const {picks, pick_count, key} = this.shown,
                              found = picks.findIndex((pick) => (pick.organism ?? 0) === this.#sought);
    if (found >= 0) {
      this.#stepper.go_to(1 + found);
      this.#sought = null;
    } else if (picks.length >= pick_count) {
      this.#stepper.go_to(pick_count);
      this.#listener.not_picked(this.#sought, key.generation);
      this.#sought = null;
    }
  }
}
