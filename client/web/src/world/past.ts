// Past: shows earlier moments of a live world in a replay, which the server computes for this page.
import type {WorldInfo} from "../core/protocol";
import type {SnapshotInfo} from "../core/snapshot";
import {access_texts} from "../texts/access";
import {common_texts} from "../texts/common";

import type {Changes} from "./changes";
import type {RunControl} from "./run_control";
import type {SnapshotFeed} from "./feed";
import type {WorldHistory} from "./history";
import {Refusal} from "./server";
import type {Moment, RunRange} from "./time_scale";

const range_ms = 1000; // between two requests for the range of a replay, which grows with the live world

/** The live world whose past is shown. */
export interface LiveWorld {
  name(): string;
  /** Shows this world or its replay. */
  watch(world: string): void;
}

export class Past {
  opening = false; // a replay is being opened or moved
  forked = ""; // the world that was forked last from this one
  #replay = ""; // name of the replay's world; empty: live
  #moment: Moment|null = null; // the moment of the past that was asked for last
  #seek_number = 0;
  #range_polled_ms = 0;
  /** The first moment that the last replay could show. */
  #begin: {run_id: string; generation: number; tick: number}|null = null;
  readonly #live: LiveWorld;
  readonly #feed: SnapshotFeed;
  readonly #history: WorldHistory;
  readonly #changes: Changes;

  constructor(live: LiveWorld, feed: SnapshotFeed, history: WorldHistory, changes: Changes) {
    this.#live = live;
    this.#feed = feed;
    this.#history = history;
    this.#changes = changes;
  }

  /** Sets the first moment of the run, which is a fork. */
  begin({run_id = "", generation = 1, tick = 0}: WorldInfo): void {
    this.#begin = {run_id, generation, tick};
    this.#changes.notify();
  }

  /** Why the past of the world cannot be shown, as a sentence; empty if it can. */
  get problem(): string {
    const server = this.#feed.server, live = server.worlds.find(this.#live.name());
    return !live                  ? common_texts.no_world :
      live.storage || live.replay ? server.access.why_not("open_replay") :
                                    access_texts.run_not_stored;
  }

  /** Whether a replay is shown, also one that another page or the server has opened. */
  get is_shown(): boolean {
    return this.#replay !== "" || this.#feed.info?.replay !== undefined;
  }

  /** Whether this page has opened the replay that is shown, so that it can return to the live world. */
  get is_own_replay(): boolean {
    return this.#replay !== "";
  }

  /** The moment that a running seek leads to. */
  get target(): Moment|null {
    return this.opening ? this.#moment : null;
  }

  /** The moments of the run that can be shown; of a live world, as far as the page knows them. */
  get range(): RunRange|null {
    const {info, newer_snapshot, tick} = this.#feed, replay = info?.replay;
    if (replay) {
      const {first_generation = 1, last_generation = 1, first_tick = 0, last_tick = 0} = replay;
      return {first_generation, last_generation, first_tick, last_tick};
    }
    if (!info) {
      return null;
    }
    const last_generation = newer_snapshot?.generation ?? info.generation;
    const oldest = Math.min(this.#history.generations[0]?.generation ?? last_generation, last_generation);
    const begin = this.#begin?.run_id === info.run_id ? this.#begin! : {generation: oldest, tick: 0};
    return {first_generation: begin.generation, last_generation, first_tick: begin.tick, last_tick: tick};
  }

  /** The first and the last tick of a generation, counted from the start of the run; null if the history does not
   *  contain them. */
  ticks_of(generation: number): {first: number; last: number}|null {
    const range = this.range, snapshot = this.#feed.snapshot;
    if (!range) {
      return null;
    }
    let begun = generation === 1 ? 0 : this.#history.end_tick(generation - 1);
    if (snapshot?.generation === generation) {
      begun = snapshot.tick - snapshot.generation_tick;
    }
    const is_first = this.is_shown && generation === range.first_generation;
    const first = is_first ? Math.max(range.first_tick, begun ?? 0) : begun; // a fork may begin within a generation
    const last = generation === range.last_generation ? range.last_tick : this.#history.end_tick(generation);
    return first === null || last === null ? null : {first, last};
  }

  /** Shows the first moment of a generation; resolves when it is shown. */
  show(generation: number): Promise<void> {
    return this.show_moment({generation});
  }

  /** Shows the first moment of the generation that is `by` after the shown one, or after that of a running seek. */
  async move_generations(by: number): Promise<void> {
    const range = this.range, from = this.target?.generation ?? this.#feed.snapshot?.generation;
    if (range && from !== undefined) {
      await this.show(Math.min(range.last_generation, Math.max(range.first_generation, from + by)));
    }
  }

  /** Shows the moment that is `by` ticks after the shown one, or after the one that a running seek leads to. */
  async move_ticks(by: number): Promise<void> {
    const range = this.range, target = this.target;
    const from = target && target.generation === undefined ? target.tick : this.#feed.snapshot?.tick;
    if (range && from !== undefined) {
      await this.show_moment({tick: Math.min(range.last_tick, Math.max(range.first_tick, from + by))});
    }
  }

  /** Shows a moment, or the first one of the run if the run begins later: the history of a fork contains generations of
   *  its origin. */
  async show_nearest(moment: Moment): Promise<void> {
    try {
      await this.show_moment(moment);
    } catch (error) {
      const wrong = error instanceof Refusal ? error.violations[0] : undefined;
      const name = wrong?.field.endsWith(".tick") ? "tick" : "generation";
      const first = Number.parseInt(wrong?.allowed ?? "", 10), wanted = moment[name];
      if (wanted === undefined || !(first > wanted)) {
        throw error;
      }
      await this.show_moment({...moment, [name]: first});
    }
  }

  /** Shows a moment of the past; resolves when it is shown, or when another moment is asked for. */
  async show_moment(moment: Moment): Promise<void> {
    const number = ++this.#seek_number;
    this.#moment = moment;
    this.opening = true;
    this.#changes.notify();
    try {
      if (this.#replay) {
        await this.#seek(moment, number);
      } else {
        await this.#open(moment, number);
      }
    } catch (error) {
      if (number !== this.#seek_number || (error instanceof Refusal && error.reason === "REASON_SEEK_SUPERSEDED")) {
        return;
      }
      if (this.#replay && this.#feed.server.state.phase !== "open") {
        return; // the replay has ended with its session; the next session opens it again at this moment
      }
      if (!this.#replay) {
        this.#moment = null;
      }
      throw error;
    } finally {
      if (number === this.#seek_number && this.#feed.server.state.phase === "open") {
        this.opening = false;
        this.#changes.notify();
      }
    }
  }

  async #open(moment: Moment, number: number): Promise<void> {
    const name = this.#live.name(), server = this.#feed.server;
    const {name: replay = "", run_id = "", tick = 0, replay: range} =
      await server.request("open_replay", {world: name, at: moment});
    if (name !== this.#live.name() || this.#moment === null || this.#replay) {
      await server.request(
        "close_replay", {world: replay}); // another world, the live world or another replay is shown now
      return;
    }
    this.#replay = replay;
    this.#begin = {run_id, generation: range?.first_generation ?? 1, tick: range?.first_tick ?? 0};
    this.#live.watch(replay);
    if (number !== this.#seek_number) { // another moment was asked for while the replay was opened
      return await this.show_moment(this.#moment);
    }
    await this.#feed.drawn(tick);
  }

  async #seek(moment: Moment, number: number): Promise<void> {
    const {tick = 0} = await this.#feed.server.request("seek", {world: this.#replay, to: moment});
    if (number === this.#seek_number) {
      await this.#feed.drawn(tick);
    }
  }

  async back_to_live(): Promise<void> {
    if (this.#moment || this.#replay) {
      this.close();
      this.#live.watch(this.#live.name());
    }
  }

  /** Closes the replay, if one is open or being opened. */
  close(): void {
    this.#moment = null;
    this.#seek_number += 1;
    this.opening = false;
    const replay = this.#replay;
    this.#replay = "";
    if (replay) {
      this.#feed.server.request("close_replay", {world: replay})
        .catch(() => undefined); // it ends with the session at the latest
    }
  }

  /** Opens the replay again in a new session, because replays have ended with the last one: at the moment and with the
   *  speed that it had, and runs it if it ran. */
  session_opened(control: RunControl): void {
    if (!this.#moment) {
      return;
    }
    const shown = this.#feed.snapshot?.world === this.#replay ? this.#feed.snapshot : null;
    this.#replay = "";
    const at = this.opening || !shown ? this.#moment : {generation: shown.generation, tick: shown.generation_tick};
    this.#reopen(at, shown, control).catch((error: Error) => {
      this.#live.watch(this.#live.name());
      this.#feed.problem = error.message;
    });
  }

  async #reopen(at: Moment, shown: SnapshotInfo|null, control: RunControl): Promise<void> {
    await this.show_moment(at);
    if (shown?.speed && this.#replay) {
      await control.set_speed(shown.speed);
    }
    if (shown?.state === "RUN_STATE_RUNNING" && this.#replay) {
      await control.resume();
    }
  }

  /** Asks for the range of the replay from time to time. The answer reaches `info` through the server. */
  poll(): void {
    if (this.#replay && performance.now() >= this.#range_polled_ms + range_ms) {
      this.#range_polled_ms = performance.now();
      this.#feed.server.request("get_statistics", {world: this.#replay}).catch(() => undefined);
    }
  }
}
