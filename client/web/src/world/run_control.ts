// RunControl: runs, pauses and steps the shown world, and sets its speed. Until a command is answered, it states what
// the command will bring about.
import type {RequestKind} from "../core/messages";
import type {RequestKinds, RunState, Speed} from "../core/protocol";
import type {SnapshotInfo} from "../core/snapshot";

import type {Changes} from "./changes";
import type {SnapshotFeed} from "./feed";
import {Refusal} from "./server";

export const speed_min = 1 / 1024, speed_max = 10000; // times real time

type ControlKind = Extract<RequestKind, "run"|"pause"|"resume"|"run_until_tick"|"set_speed">;
type Assumed = {
  state?: RunState;
  speed?: Speed
};

export class RunControl {
  #unanswered = 0; // commands of this page
  #assumed: Assumed = {}; // what the unanswered commands will bring about
  #nothing_to_resume = false; // the world was only stepped, so it has no run to resume
  #factor = 1; // the last speed that was not the maximum
  readonly #feed: SnapshotFeed;
  readonly #changes: Changes;

  constructor(feed: SnapshotFeed, changes: Changes) {
    this.#feed = feed;
    this.#changes = changes;
  }

  /** RUN_STATE_UNSPECIFIED before anything is known. */
  get state(): RunState {
    const {newer_snapshot, info} = this.#feed;
    return this.#assumed.state ?? newer_snapshot?.state ?? info?.state ?? "RUN_STATE_UNSPECIFIED";
  }

  get speed(): Speed|undefined {
    const {newer_snapshot, info} = this.#feed;
    return this.#assumed.speed ?? (newer_snapshot ? newer_snapshot.speed : info?.speed);
  }

  /** Whether the run or the replay has ended. */
  get is_over(): boolean {
    return this.state === "RUN_STATE_TERMINATED" || this.at_end;
  }

  /** Whether a replay shows its last stored moment. */
  get at_end(): boolean {
    const replay = this.#feed.info?.replay;
    return replay !== undefined && this.state !== "RUN_STATE_RUNNING" && this.#feed.tick >= (replay.last_tick ?? 0);
  }

  /** Another world is shown. */
  forget(): void {
    this.#assumed = {};
    this.#nothing_to_resume = false;
    this.#factor = this.#feed.info?.speed?.real_time_factor ?? 1;
  }

  take(snapshot: SnapshotInfo): void {
    if (snapshot.speed?.real_time_factor !== undefined && this.#unanswered === 0) {
      this.#factor = snapshot.speed.real_time_factor;
    }
  }

  run(generations?: number): Promise<void> {
    return this.#command({state: "RUN_STATE_RUNNING"}, "run", generations === undefined ? {} : {generations});
  }

  pause(): Promise<void> {
    return this.#command({state: "RUN_STATE_PAUSED"}, "pause", {});
  }

  async resume(): Promise<void> {
    try {
      await this.#command({state: "RUN_STATE_RUNNING"}, "resume", {});
    } catch (error) {
      const is_stepped = error instanceof Refusal && error.reason === "REASON_NOTHING_TO_RESUME";
      if (is_stepped) { // another client has only stepped the world
        return await this.run();
      }
      throw error;
    }
    if (this.#feed.info?.state === "RUN_STATE_WAITING") { // a world that was only stepped has no run to resume
      await this.run();
    }
  }

  run_until_tick(tick: number): Promise<void> {
    this.#nothing_to_resume ||= this.state === "RUN_STATE_WAITING";
    return this.#command({}, "run_until_tick", {tick});
  }

  /** Runs, pauses or resumes the world, whichever its state allows. */
  async pause_or_resume(): Promise<void> {
    switch (this.state) {
      case "RUN_STATE_RUNNING":
        return this.pause();
      case "RUN_STATE_PAUSED":
        return this.#nothing_to_resume ? this.run() : this.resume();
      case "RUN_STATE_WAITING":
        return this.run();
    }
  }

  /** Runs this many ticks, then pauses. A running world is paused first: otherwise it would run on when the lease of
   *  the step ends. */
  async step(ticks: number): Promise<void> {
    if (this.state === "RUN_STATE_RUNNING") {
      await this.pause();
    }
    await this.run_until_tick(this.#feed.tick + ticks);
  }

  set_speed(wanted: Speed): Promise<void> {
    const speed = {...wanted};
    if (speed.real_time_factor !== undefined) {
      this.#factor = speed.real_time_factor = Math.min(Math.max(speed.real_time_factor, speed_min), speed_max);
    }
    return this.#command({speed}, "set_speed", {speed});
  }

  /** The speed that is set again when the maximum is turned off. */
  get factor(): number {
    return this.speed?.real_time_factor ?? this.#factor;
  }

  multiply_speed(by: number): Promise<void> {
    if (this.speed?.max) {
      return by > 1 ? Promise.resolve() : this.set_speed({real_time_factor: this.#factor});
    }
    return this.set_speed({real_time_factor: this.factor * by});
  }

  toggle_max_speed(): Promise<void> {
    return this.set_speed(this.speed?.max ? {real_time_factor: this.#factor} : {max: true});
  }

  async #command<Kind extends ControlKind>(assumed: Assumed, kind: Kind, fields: RequestKinds[Kind]): Promise<void> {
    const {server, world} = this.#feed;
    this.#unanswered += 1;
    if (server.access.why_not(kind, world) === "") {
      this.#assumed = {...this.#assumed, ...assumed};
      this.#changes.notify();
    }
    try {
      await server.request(kind, {world, ...fields});
      this.#nothing_to_resume &&= kind !== "run" && kind !== "resume";
    } finally {
      this.#unanswered -= 1;
      if (this.#unanswered === 0) {
        this.#assumed = {};
      }
      this.#changes.notify();
    }
  }
}
