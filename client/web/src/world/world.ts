// ViewedWorld: the world that one pane shows: live, or a replay of its past.
//
// Owner        main; one per pane. The pane and the panels read it, and change what is shown by its methods.
// Polling      organism and population are read at most 4 times a second, and only while the page is visible and
//              something shows them. Everything else follows from answers, events and snapshots.

import {Changes} from "./changes";

import {Refusal, type Server} from "./server";
import {of_browser} from "./storage";
import type {Moment, RunRange} from "./time_scale";
import {default_look} from "../render/look";
import type {Drawing, FromWorker, Look, Message, PopulationColumns, RequestKind} from "../core/messages";
import type {SnapshotInfo} from "../core/snapshot";

const rate_default_hz = 30; // snapshots per second
const poll_ms = 250;
const missed_wait_min_ms = 1000,
      missed_wait_factor = 4; // at most a fifth of the time goes into reading generations whose events were dropped
const range_ms = 1000; // between two requests for the range of a replay, which grows with the live world
const no_runs = "The run of this world is not stored.";
const seek_wait_ms = 5000; // for the first snapshot after a seek
const gene_statistics_max = 400_000; // kept in the history of a world
export const speed_min = 1 / 1024, speed_max = 10000; // times real time

export class ViewedWorld {
  /** Name of the live world; requests of panels about the shown moment use `shown`. */
  name = "";
  /** Name of the world that is drawn: `name`, or the replay's world. */
  shown = "";
  island = 0;
  snapshot: SnapshotInfo|null = null; // the newest drawn
  healthiest: {id: number; health: number}[] = [];
  drawing: Drawing|null = null; // what the worker drew last
  /** GenerationStatistics of `name` of all islands, oldest first; and AppliedChange messages, oldest first. */
  history: Message[] = [];
  changes: Message[] = [];
  history_complete = false;
  parameters: Message|null = null; // ParameterSet of `shown`
  selected: number|null = null; // id of the selected organism
  selected_at: {x_px: number; y_px: number; health: number}|null = null; // in the drawn snapshot
  follow = false; // whether the camera follows the selected organism
  organism: Message|null = null; // OrganismInfo of the selected organism, polled 4 times a second
  population: PopulationColumns|null = null; // of the shown generation, if a panel or the look needs it
  look: Look;
  problem = ""; // why nothing is drawn: the server refused the subscription or the replay
  opening = false; // a replay is being opened or moved
  forked = ""; // the world that was forked last from this one
  rate_hz = rate_default_hz; // the greatest number of snapshots per second

  #changes = new Changes(true);
  #snapshot_listeners = new Set<(snapshot: SnapshotInfo) => void>();
  #end: (() => void)[] = [];
  #replay = ""; // name of the replay's world; empty: live
  #moment: Moment|null = null; // the moment of the past that was asked for last
  #seek_number = 0;
  #range_polled_ms = 0;
  /** The first moment that the last replay could show. */
  #begin: {run_id: string; generation: number; tick: number}|null = null;
  #unanswered = 0; // commands of this page
  #assumed: {state?: string; speed?: Message} = {}; // what the unanswered commands will bring about
  #nothing_to_resume = false; // the world was only stepped, so it has no run to resume
  #factor = 1; // the last speed that was not the maximum
  #needs_of_population = 0;
  #population_polled_ms = 0;
  #population_pending = false;
  #population_of = ""; // world, island, run and generation of `population`
  #placed = false; // organisms were placed since the population was read
  #organism_pending = false;
  #organism_tick = -1;
  #parameters_pending = false;
  #parameters_stale = false;
  #history_number = 0;
  #history_of = ""; // run_id of `history`; empty: not known
  #missed_wait_ms = missed_wait_min_ms;
  #missed_after: number|null =
    null; // the last generation before events were dropped, until the missed ones are requested
  #remembered: {run_id: string; island: number; generation: number; organism: number; follow: boolean}|null =
    null; // the organism selected last

  constructor(readonly server: Server, readonly pane: number) {
    this.look = stored_look();
    this.#end.push(
      server.on_message((message) => this.#take(message)),
      server.on_event((event) => this.#take_event(event)),
      server.on_change(() => this.#server_changed()),
    );
    const timer = setInterval(() => this.#poll(), poll_ms);
    this.#end.push(() => clearInterval(timer));
  }

  // ---- what is shown ----

  get info(): Message|null {
    return this.server.world(this.shown); // WorldInfo of `shown`
  }

  get is_replay(): boolean {
    return this.#replay !== "" || this.info?.replay !== undefined;
  }

  get gene_names(): string[] {
    return this.info?.gene_names ?? [];
  }

  get gene_groups(): string[] {
    return this.info?.gene_groups ?? [];
  }

  /** What the organisms of the world try to do, as sentences; empty until the parameters have arrived. */
  get experiment(): string {
    return this.parameters?.summary ?? "";
  }

  /** "RUN_STATE_RUNNING" …; "" before anything is known. Assumes the effect of commands that are not answered yet. */
  get state(): string {
    return this.#assumed.state ?? (this.#snapshot_is_newer ? this.snapshot!.state : this.info?.state ?? "");
  }

  get speed(): Message|undefined {
    return this.#assumed.speed ?? (this.#snapshot_is_newer ? this.snapshot!.speed : this.info?.speed);
  }

  get tick(): number {
    return this.#snapshot_is_newer ? this.snapshot!.tick : Number(this.info?.tick ?? 0);
  }

  /** Whether the run or the replay has ended. */
  get is_over(): boolean {
    return this.state === "RUN_STATE_TERMINATED" || this.at_end;
  }

  /** Whether a replay shows its last stored moment. */
  get at_end(): boolean {
    const replay = this.info?.replay;
    return replay !== undefined && this.state !== "RUN_STATE_RUNNING" && this.tick >= Number(replay.last_tick ?? 0);
  }

  get #snapshot_is_newer(): boolean {
    const snapshot = this.snapshot, info = this.info;
    return snapshot !== null && snapshot.world === this.shown &&
      (!info || (info.run_id === snapshot.run_id && snapshot.tick > Number(info.tick ?? 0)));
  }

  show(world: string, island = 0): void {
    if (world === this.name && !this.#replay) {
      this.choose_island(island);
      return;
    }
    this.forked = world === this.name ? this.forked : "";
    this.#close_replay();
    this.name = world;
    this.#watch(world, island);
    void this.#read_history(false);
  }

  choose_island(island: number): void {
    if (island !== this.island) {
      this.#watch(this.shown, island);
    }
  }

  /** Limits the number of snapshots per second; null: the default. */
  set_rate(rate_hz: number|null): void {
    const before = this.rate_hz;
    this.rate_hz = rate_hz ?? rate_default_hz;
    if (this.rate_hz !== before && this.shown) {
      this.server.post({kind: "watch", pane: this.pane, world: this.shown, island: this.island, rate_hz: this.rate_hz});
    }
  }

  /** Whether the rate differs from the default. */
  get has_rate(): boolean {
    return this.rate_hz !== rate_default_hz;
  }

  select(organism: number|null): void {
    if (organism === this.selected) {
      return;
    }
    this.selected = organism;
    this.organism = null;
    this.#organism_tick = -1;
    this.follow = organism !== null && this.follow;
    this.#remember_selection();
    this.#post_selection();
    this.#poll();
    this.#changes.notify();
  }

  set_follow(follow: boolean): void {
    this.follow = follow && this.selected !== null;
    this.#remember_selection();
    this.#post_selection();
    this.#changes.notify();
  }

  set_look(change: Partial<Look>): void {
    this.look = {...this.look, ...change};
    of_browser.set("look", JSON.stringify(this.look));
    this.server.post({kind: "look", pane: this.pane, look: this.look});
    this.#poll();
    this.#changes.notify();
  }

  /** Keeps `population` up to date until the returned function is called. */
  need_population(): () => void {
    this.#needs_of_population += 1;
    this.#poll();
    let ended = false;
    return () => {
      this.#needs_of_population -= ended ? 0 : 1;
      ended = true;
    };
  }

  // ---- the past ----

  /** Why the past of the world cannot be shown, as a sentence; empty if it can. */
  get past_problem(): string {
    const live = this.server.world(this.name);
    return !live ? "No world is open." : live.storage || live.replay ? this.server.why_not("open_replay") : no_runs;
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
    const info = this.info, replay = info?.replay;
    if (replay) {
      return {
        first_generation: Number(replay.first_generation ?? 1),
        last_generation: Number(replay.last_generation ?? 1),
        first_tick: Number(replay.first_tick ?? 0),
        last_tick: Number(replay.last_tick ?? 0),
      };
    }
    if (!info) {
      return null;
    }
    const last_generation = this.#snapshot_is_newer ? this.snapshot!.generation : Number(info.generation ?? 1);
    const oldest = Math.min(Number(this.history[0]?.generation ?? last_generation), last_generation);
    const begin = this.#begin?.run_id === info.run_id ? this.#begin! : {generation: oldest, tick: 0};
    return {first_generation: begin.generation, last_generation, first_tick: begin.tick, last_tick: this.tick};
  }

  /** The first and the last tick of a generation, counted from the start of the run; null if the history does not contain them. */
  ticks_of(generation: number): {first: number; last: number}|null {
    const range = this.range, snapshot = this.snapshot;
    if (!range) {
      return null;
    }
    const begun = snapshot?.generation === generation ? snapshot.tick - snapshot.generation_tick :
      generation === 1                                ? 0 :
                                                        this.#end_tick(generation - 1);
    const is_first = this.is_replay && generation === range.first_generation;
    const first = is_first ? Math.max(range.first_tick, begun ?? 0) : begun; // a fork may begin within a generation
    const last = generation === range.last_generation ? range.last_tick : this.#end_tick(generation);
    return first === null || last === null ? null : {first, last};
  }

  /** The last tick of a generation that has ended; null if the history does not contain it. */
  #end_tick(generation: number): number|null {
    let low = 0, high = this.history.length; // the history is ordered by generation and island
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.history[middle]!.generation < generation) {
        low = middle + 1;
      } else {
        high = middle;
      }
    }
    const found = this.history[low];
    return found?.generation === generation ? Number(found.end_tick ?? 0) : null;
  }

  /** Shows a moment of the past in a replay; resolves when it is shown.
   *
   *  tick  since the generation began; absent: its first moment */
  show_past(generation: number, tick?: number): Promise<void> {
    return this.show_moment({generation, ...(tick === undefined ? {} : {tick})});
  }

  /** Shows the first moment of the generation that is `by` after the shown one, or after that of a running seek. */
  async move_generations(by: number): Promise<void> {
    const range = this.range, from = this.target?.generation ?? this.snapshot?.generation;
    if (range && from !== undefined) {
      await this.show_past(Math.min(range.last_generation, Math.max(range.first_generation, from + by)));
    }
  }

  /** Shows the moment that is `by` ticks after the shown one, or after the one that a running seek leads to. */
  async move_ticks(by: number): Promise<void> {
    const range = this.range, target = this.target, snapshot = this.snapshot;
    const from = target && target.generation === undefined ? target.tick : snapshot?.tick;
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

  /** Shows a moment of the past in a replay; resolves when it is shown, or when another moment is asked for. */
  async show_moment(moment: Moment): Promise<void> {
    const number = ++this.#seek_number, name = this.name;
    this.#moment = moment;
    this.opening = true;
    this.#changes.notify();
    try {
      if (!this.#replay) {
        const info = await this.server.request("open_replay", {world: name, at: moment});
        if (name !== this.name || this.#moment === null || this.#replay) {
          await this.server.request(
            "close_replay", {world: info.name ?? ""}); // another world, the live world or another replay is shown now
          return;
        }
        this.#replay = info.name ?? "";
        const {first_generation = 1, first_tick = 0} = info.replay ?? {};
        this.#begin = {run_id: info.run_id ?? "", generation: Number(first_generation), tick: Number(first_tick)};
        this.#watch(this.#replay, this.island);
        if (number !== this.#seek_number) { // another moment was asked for meanwhile
          return await this.show_moment(this.#moment);
        }
        await this.#drawn(Number(info.tick ?? 0));
      } else {
        const info = await this.server.request("seek", {world: this.#replay, to: moment});
        if (number === this.#seek_number) {
          await this.#drawn(Number(info.tick ?? 0));
        }
      }
    } catch (error) {
      if (number !== this.#seek_number || (error instanceof Refusal && error.reason === "REASON_SEEK_SUPERSEDED")) {
        return;
      }
      if (this.#replay && this.server.state.phase !== "open") {
        return; // the replay has ended with its session; the next session opens it again at this moment
      }
      if (!this.#replay) {
        this.#moment = null;
      }
      throw error;
    } finally {
      if (number === this.#seek_number && this.server.state.phase === "open") {
        this.opening = false;
        this.#changes.notify();
      }
    }
  }

  async back_to_live(): Promise<void> {
    if (this.#moment || this.#replay) {
      this.#close_replay();
      this.#watch(this.name, this.island);
    }
  }

  #close_replay(): void {
    this.#moment = null;
    this.#seek_number += 1;
    this.opening = false;
    const replay = this.#replay;
    this.#replay = "";
    if (replay) {
      this.server.request("close_replay", {world: replay})
        .catch(() => undefined); // it ends with the session at the latest
    }
  }

  /** Resolves when a snapshot of the shown world is drawn, or after seek_wait_ms. */
  drawn(): Promise<void> {
    return this.#drawn(null);
  }

  /** tick: of the snapshot; null: any. */
  #drawn(tick: number|null): Promise<void> {
    return new Promise((resolve) => {
      const end = (): void => {
        clearTimeout(timer);
        this.#snapshot_listeners.delete(listener);
        resolve();
      };
      const listener = (snapshot: SnapshotInfo): void => {
        if (
          snapshot.world === this.shown &&
          (tick === null || snapshot.tick === tick || snapshot.state === "RUN_STATE_RUNNING")) {
          end();
        }
      };
      const timer = setTimeout(end, seek_wait_ms);
      this.#snapshot_listeners.add(listener);
      if (this.snapshot) {
        listener(this.snapshot);
      }
    });
  }

  // ---- run control ----

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
      if (
        error instanceof Refusal &&
        error.reason === "REASON_NOTHING_TO_RESUME") { // another client has only stepped the world
        return await this.run();
      }
      throw error;
    }
    if (this.info?.state === "RUN_STATE_WAITING") { // a world that was only stepped has no run to resume
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

  /** Runs this many ticks, then pauses. A running world is paused first: otherwise it would run on when the lease of the step ends. */
  async step(ticks: number): Promise<void> {
    if (this.state === "RUN_STATE_RUNNING") {
      await this.pause();
    }
    await this.run_until_tick(this.tick + ticks);
  }

  set_speed(speed: {real_time_factor?: number; max?: boolean}): Promise<void> {
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

  async #command(assumed: {state?: string; speed?: Message}, kind: RequestKind, fields: Message): Promise<void> {
    this.#unanswered += 1;
    if (this.server.may(kind, this.shown)) {
      this.#assumed = {...this.#assumed, ...assumed};
      this.#changes.notify();
    }
    try {
      await this.server.request(kind, {world: this.shown, ...fields});
      this.#nothing_to_resume &&= kind !== "run" && kind !== "resume";
    } finally {
      this.#unanswered -= 1;
      if (this.#unanswered === 0) {
        this.#assumed = {};
      }
      this.#changes.notify();
    }
  }

  // ---- changes ----

  /** Calls `listener` after any change, at most once per animation frame. */
  on_change(listener: () => void): () => void {
    return this.#changes.listen(listener);
  }

  /** Calls `listener` after each snapshot that the worker reports, at most 20 times a second. */
  on_snapshot(listener: (snapshot: SnapshotInfo) => void): () => void {
    this.#snapshot_listeners.add(listener);
    return () => this.#snapshot_listeners.delete(listener);
  }

  close(): void {
    this.#close_replay();
    this.server.post({kind: "unwatch", pane: this.pane});
    for (const end of this.#end) {
      end();
    }
  }

  #watch(world: string, island: number): void {
    this.#forget(world, island);
    const factor = this.info?.speed?.real_time_factor;
    this.#factor = factor ?? 1;
    this.#post_selection();
    this.server.post({kind: "population", pane: this.pane, columns: null});
    this.server.post({kind: "look", pane: this.pane, look: this.look});
    this.server.post({kind: "watch", pane: this.pane, world, island, rate_hz: this.rate_hz});
    this.#read_parameters();
    this.#changes.notify();
  }

  /** Forgets everything about the world that was shown, because this one is shown next. */
  #forget(world: string, island: number): void {
    this.shown = world;
    this.island = island;
    this.snapshot = null;
    this.healthiest = [];
    this.selected = this.selected_at = this.organism = this.population = this.parameters = null;
    this.follow = false;
    this.problem = "";
    this.#population_of = "";
    this.#assumed = {};
    this.#nothing_to_resume = false;
  }

  #post_selection(): void {
    this.server.post({kind: "select", pane: this.pane, organism: this.selected, hovered: null, follow: this.follow});
  }

  #take(message: FromWorker): void {
    if (message.kind === "state") {
      if (message.state.phase === "open") {
        this.#session_opened();
      }
      return;
    }
    if (!("pane" in message) || message.pane !== this.pane) {
      return;
    }
    switch (message.kind) {
      case "snapshot":
        if (message.info.world !== this.shown || message.info.island !== this.island) {
          return; // of the world that was shown before
        }
        if (this.snapshot && this.snapshot.generation !== message.info.generation) {
          this.#parameters_stale = true;
        }
        this.#follow_generation(message.info);
        this.snapshot = message.info;
        if (this.selected !== null && this.#remembered === null) { // it was selected before the first snapshot
          this.#remember_selection();
        }
        this.healthiest = message.healthiest;
        this.selected_at = this.selected === null ? null : message.selected;
        this.problem = "";
        if (message.info.speed?.real_time_factor !== undefined && this.#unanswered === 0) {
          this.#factor = message.info.speed.real_time_factor;
        }
        for (const listener of [...this.#snapshot_listeners]) {
          listener(message.info);
        }
        break;
      case "drawing":
        this.drawing = message.drawing;
        break;
      case "watch_refused":
        this.problem =
          this.opening ? "" : message.message; // a replay that ended with its session is being opened again
        break;
      default:
        return;
    }
    this.#changes.notify();
  }

  #remember_selection(): void {
    const snapshot = this.snapshot;
    this.#remembered = this.selected === null || !snapshot ? null : {
      run_id: snapshot.run_id,
      island: this.island,
      generation: snapshot.generation,
      organism: this.selected,
      follow: this.follow
    };
  }

  /** Ends the selection with its generation: the next one uses the same ids. Selects the organism again when its generation is shown again. */
  #follow_generation(next: SnapshotInfo): void {
    const remembered = this.#remembered;
    const again = remembered !== null && remembered.run_id === next.run_id && remembered.island === this.island &&
      remembered.generation === next.generation;
    if (
      again ? this.selected === null :
              this.selected !== null && this.snapshot !== null && this.snapshot.generation !== next.generation) {
      this.selected = again ? remembered.organism : null;
      this.follow = again && remembered.follow;
      this.selected_at = this.organism = null;
      this.#organism_tick = -1;
      this.#post_selection();
    }
  }

  /** A new session began: replays have ended with the last one. */
  #session_opened(): void {
    if (!this.name) {
      return;
    }
    if (this.#moment) {
      const shown = this.snapshot?.world === this.#replay ? this.snapshot : null;
      this.#replay = "";
      const at = this.opening || !shown ? this.#moment : {generation: shown.generation, tick: shown.generation_tick};
      this.#reopen(at, shown).catch((error: Error) => {
        this.#watch(this.name, this.island);
        this.problem = error.message;
      });
    }
    this.#read_parameters();
    void this.#read_history(true);
  }

  /** Opens the replay again, with the speed that it had, and runs it if it ran. */
  async #reopen(at: Moment, shown: SnapshotInfo|null): Promise<void> {
    await this.show_moment(at);
    if (shown?.speed && this.#replay) {
      await this.set_speed({...shown.speed});
    }
    if (shown?.state === "RUN_STATE_RUNNING" && this.#replay) {
      await this.resume();
    }
  }

  #take_event(event: Message): void {
    if (event.events_dropped) {
      this.#read_parameters();
      this.#read_missed();
      return;
    }
    if (
      event.world === this.shown &&
      (event.parameters_changed || event.change_planned || event.change_cancelled || event.change_dropped)) {
      this.#read_parameters();
    }
    if (event.placed && event.world === this.shown) {
      this.#placed = true;
    }
    if (event.world !== this.name) {
      return;
    }
    if (event.generation_finished) {
      this.#append(event.generation_finished.statistics ?? []);
    } else if (event.world_damaged && this.shown === this.name) {
      this.#watch(this.name, this.island); // the server refuses it with the reason
    } else if (event.parameters_changed) {
      void this.#read_changes();
    } else if (event.world_reset || event.world_created) {
      this.selected = this.organism = this.population = null;
      this.#population_of = "";
      this.#post_selection();
      this.#read_parameters();
    }
    this.#changes.notify();
  }

  #server_changed(): void {
    const run_id: string = this.server.world(this.name)?.run_id ?? "";
    if (run_id !== "" && this.#history_of !== "" && run_id !== this.#history_of) {
      void this.#read_history(false); // the world was reset
    }
    const is_there = this.server.world(this.name) !== null || this.server.damage_of(this.name) !== "";
    if (this.name && this.server.worlds_known && this.server.state.phase === "open" && !is_there) {
      this.#close_replay(); // the live world was deleted
      this.name = "";
      this.#forget("", 0);
      this.history = [];
      this.changes = [];
      this.server.post({kind: "unwatch", pane: this.pane});
    }
    this.#changes.notify();
  }

  // ---- history ----

  /** The number of generations whose statistics are kept: as many as the server keeps, but fewer in worlds of many genes or islands. */
  get #generations_kept(): number {
    const world = this.server.world(this.name), genes = Math.max(1, world?.gene_names?.length ?? 1),
          islands = Math.max(1, world?.island_count ?? 1);
    return Math.min(
      this.server.limits.history_generations_kept ?? Infinity, Math.ceil(gene_statistics_max / (genes * islands)));
  }

  /** Adds the statistics of a generation that has ended. Drops the oldest ones from time to time, not each time. */
  #append(statistics: Message[]): void {
    const last: number = this.history[this.history.length - 1]?.generation ?? 0;
    const of_last = this.history.slice(-statistics.length);
    this.history.push(...statistics.filter(
      (one) => one.generation > last ||
        (one.generation === last &&
         !of_last.some((known) => known.generation === last && (known.island ?? 0) === (one.island ?? 0)))));
    const kept = this.#generations_kept * Math.max(1, statistics.length);
    if (this.history.length > 1.1 * kept) {
      this.history = this.history.slice(-kept);
    }
    this.#changes.notify();
  }

  /** same_run: the known history stays until the new one has arrived. */
  async #read_history(same_run: boolean): Promise<void> {
    const world = this.name, number = ++this.#history_number;
    this.#history_of = this.server.world(world)?.run_id ?? "";
    const generations: Message[] = [], changes: Message[] = [];
    if (!same_run) {
      this.history = [];
      this.changes = [];
      this.history_complete = false;
    }
    const oldest = Number(this.server.world(world)?.generation ?? 1) - this.#generations_kept;
    let next = oldest > 1 ? oldest : undefined; // absent: the oldest that the server keeps
    try {
      do {
        const page: Message =
          await this.server.request("get_history", {world, ...(next === undefined ? {} : {first_generation: next})});
        if (number !== this.#history_number) {
          return;
        }
        generations.push(...(page.generations ?? []));
        changes.push(...(page.changes ?? []));
        next = page.next_generation;
      } while (next !== undefined);
      const last: number = generations[generations.length - 1]?.generation ?? 0;
      this.history =
        [...generations, ...this.history.filter((one) => one.generation > last)]; // some have ended meanwhile
      this.changes = changes;
      this.history_complete = true;
    } catch {
      // The session ended, or the world was deleted: the next session or world reads its history.
    }
    this.#changes.notify();
  }

  /** Reads the generations whose events were dropped, at most once a second. */
  #read_missed(): void {
    if (this.#missed_after !== null || !this.name) {
      return;
    }
    this.#missed_after = this.history.length > 0 ? this.history[this.history.length - 1]!.generation : 0;
    const number = this.#history_number;
    setTimeout(() => void this.#read_after(number), this.#missed_wait_ms);
  }

  async #read_after(number: number): Promise<void> {
    const after: number = this.#missed_after ?? 0, read: Message[] = [];
    this.#missed_after = null;
    const begun = performance.now();
    let next: number|undefined =
      Math.max(after + 1, Number(this.server.world(this.name)?.generation ?? 1) - this.#generations_kept);
    try {
      while (next !== undefined) {
        const page: Message = await this.server.request("get_history", {world: this.name, first_generation: next});
        if (number !== this.#history_number) {
          return;
        }
        read.push(...(page.generations ?? []));
        next = page.next_generation;
      }
      const last: number = read.length > 0 ? read[read.length - 1]!.generation : after;
      this.history = [
        ...this.history.filter((one) => one.generation <= after), ...read,
        ...this.history.filter((one) => one.generation > last)
      ];
      void this.#read_changes();
      this.#missed_wait_ms = Math.max(missed_wait_min_ms, missed_wait_factor * (performance.now() - begun));
    } catch {
      // The session ended, or the world was deleted.
    }
    this.#changes.notify();
  }

  /** Reads the changes of the present generation and of later ones. */
  async #read_changes(): Promise<void> {
    const number = this.#history_number;
    const first = Math.max(1, Number(this.server.world(this.name)?.generation ?? 1) - 1);
    try {
      const page = await this.server.request("get_history", {world: this.name, first_generation: first});
      if (number === this.#history_number) {
        this.changes = [...this.changes.filter((change) => (change.generation ?? 0) < first), ...(page.changes ?? [])];
        this.#changes.notify();
      }
    } catch {
      // The change is read with the next history.
    }
  }

  // ---- queries ----

  /** Reads the parameters, and once more if they change while they are read. */
  #read_parameters(): void {
    this.#parameters_stale = true;
    if (this.#parameters_pending || !this.shown) {
      return;
    }
    this.#parameters_pending = true;
    this.#parameters_stale = false;
    const world = this.shown;
    this.server.request("get_parameters", {world})
      .then(
        (set) => {
          if (world === this.shown) {
            this.parameters = set;
          } else {
            this.#parameters_stale = true;
          }
        },
        () => undefined)
      .finally(() => {
        this.#parameters_pending = false;
        this.#changes.notify();
      });
  }

  #poll(): void {
    if (document.visibilityState === "hidden" || this.server.state.phase !== "open" || !this.shown || !this.snapshot) {
      return;
    }
    if (this.#parameters_stale) {
      this.#read_parameters();
    }
    if (this.#replay && performance.now() >= this.#range_polled_ms + range_ms) {
      this.#range_polled_ms = performance.now();
      this.server.request("get_statistics", {world: this.#replay}).catch(() => undefined); // Server takes the WorldInfo
    }
    this.#poll_organism();
    void this.#poll_population();
  }

  #poll_organism(): void {
    const organism = this.selected, tick = this.snapshot!.tick;
    if (organism === null || this.#organism_pending || tick === this.#organism_tick) {
      return;
    }
    this.#organism_pending = true;
    this.#organism_tick = tick;
    const world = this.shown, island = this.island;
    this.server.request("get_organism", {world, island, organism})
      .then(
        (info) => {
          if (world === this.shown && island === this.island && organism === this.selected) {
            this.organism = info;
            this.#changes.notify();
          }
        },
        (error: Refusal) => {
          if (error.reason === "REASON_ORGANISM_NOT_FOUND" && organism === this.selected && world === this.shown) {
            this.select(null);
          }
        })
      .finally(() => {
        this.#organism_pending = false;
        if (organism !== this.selected) {
          this.#poll();
        }
      });
  }

  get #look_needs_population(): boolean {
    const colour = this.look.colour_by;
    const points = this.selected !== null || this.drawing?.pointed_at?.organism != null;
    const needs = (which: Look["forces"]): boolean => which === "all" || (which === "selected" && points);
    return (colour !== "" && colour !== "health") || needs(this.look.forces) || needs(this.look.perception);
  }

  async #poll_population(): Promise<void> {
    const snapshot = this.snapshot!;
    if (this.#population_pending || (this.#needs_of_population === 0 && !this.#look_needs_population)) {
      return;
    }
    const of = [this.shown, this.island, snapshot.run_id, snapshot.generation].join(" ");
    const count: number = snapshot.live?.organism_count ?? 0;
    const changes =
      this.look.forces !== "none" && snapshot.state === "RUN_STATE_RUNNING"; // forces differ from tick to tick
    // Large populations are read less often: at most half of the time goes into reading.
    const due = performance.now() >= this.#population_polled_ms;
    if (of === this.#population_of && !this.#placed && !(changes && due) || count === 0) {
      return;
    }
    this.#population_pending = true;
    this.#placed = false;
    const begun = performance.now(), world = this.shown, island = this.island;
    try {
      const pages: Message[] = [];
      let rows = 0, total = 1;
      while (rows < total) {
        const page = await this.server.request("get_population", {world, island, first_organism: rows});
        if (
          world !== this.shown || island !== this.island ||
          (pages.length > 0 && page.generation !== pages[0]!.generation)) {
          return; // another world or generation is shown now
        }
        pages.push(page);
        total = page.organism_count ?? 0;
        if (!page.count) {
          break;
        }
        rows += page.count;
      }
      this.population = columns_of(pages, rows, island, this.gene_names);
      this.#population_of = [world, island, snapshot.run_id, this.population.generation].join(" ");
      this.server.post({kind: "population", pane: this.pane, columns: this.population});
      this.#changes.notify();
    } catch {
      this.#population_of =
        of; // refused: the world has no bodies, or the session ended; the next generation tries again
    } finally {
      this.#population_pending = false;
      this.#population_polled_ms = performance.now() + Math.max(poll_ms, performance.now() - begun);
    }
  }
}

/** Joins pages of the population. A column of little-endian numbers has no alignment in a message, so it is copied. */
function columns_of(pages: Message[], rows: number, island: number, gene_names: string[]): PopulationColumns {
  const bytes_of = (field: string, count: number, size: number): Uint8Array[]|null => {
    if (pages.some((page) => (page[field]?.length ?? 0) !== count * size * (page.count ?? 0))) {
      return null;
    }
    return Array.from({length: count}, (_, column) => {
      const all = new Uint8Array(rows * size);
      let at = 0;
      for (const page of pages) {
        const length = (page.count ?? 0) * size;
        all.set((page[field] as Uint8Array).subarray(column * length, (column + 1) * length), at);
        at += length;
      }
      return all;
    });
  };
  const floats = (field: string, count: number): Float32Array[]|null =>
    bytes_of(field, count, 4)?.map((bytes) => new Float32Array(bytes.buffer)) ?? null;
  const founders = bytes_of("founders", 1, 4);
  return {
    generation: pages[0]?.generation ?? 0,
    island,
    gene_names,
    genes: floats("genes", gene_names.length) ?? [],
    founders: founders ? new Uint32Array(founders[0]!.buffer) : null,
    choices: bytes_of("choices", 1, 1)?.[0] ?? null,
    forces: floats("forces", 2),
    targets: floats("targets", 2),
  };
}

function stored_look(): Look {
  const look = default_look("vivid", matchMedia("(prefers-color-scheme: light)").matches ? "light" : "dark");
  look.flashes = !matchMedia("(prefers-reduced-motion: reduce)").matches;
  try {
    const stored: Message = JSON.parse(of_browser.get("look") || "{}");
    for (const name of Object.keys(look) as (keyof Look)[]) {
      if (typeof stored[name] === typeof look[name]) {
        (look as Message)[name] = stored[name];
      }
    }
  } catch {
    // The stored text is not of this page: the look begins with its defaults.
  }
  return look;
}
