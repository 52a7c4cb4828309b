// LessonPlayer: plays a lesson in a world: sends what its steps do, follows the run, observes, and writes the notes.
// No DOM.
//
// What the user has done is in the notes of the run; this tab remembers them too. So a lesson goes on after a reload,
// and notes that could not be written, or that belong to the run before a reset, are written later, in their order.
import type {ParameterSet, WorldInfo} from "../core/protocol";
import {read_export} from "../world/run_export";
import type {Server} from "../world/server";
import {of_tab} from "../world/storage";

import {answer_of} from "./answers";
import {Course} from "./course";
import type {Lesson, Prediction, Setting} from "./lesson_file";
import {type KeptNote, type Note, note_text, read_note, united} from "./notes";
import {asked_by, values_of} from "./observing";
import {assignments, changed, set_parameters} from "./settings";

const poll_ms = 300, retry_ms = 3000;

/** A step that is being performed. */
interface Running {
  step: number; // from 0
  run: string; // id; empty: the run has not begun
  until: number; // the generation before this one is the last to run
  first: number; // the generation in which the step began
  speed: WorldInfo["speed"]; // to set again at the end; absent: it was not changed
}

interface Remembered {
  notes: KeptNote[];
  performed: number[];
  running: Running|null;
  step: number; // shown last
}

export type PlayerState = "reading"|"not begun"|"begun"; // reading: the notes are being read

export class LessonPlayer {
  state: PlayerState = "reading";
  course: Course;
  /** The step that is shown, from 0. */
  step = 0;
  running: Running|null = null;
  is_busy = false; // a request of the lesson has not been answered
  problem = ""; // why the last request failed; empty: it did not
  #notes: KeptNote[] = [];
  #performed = new Set<number>();
  #timer = 0;
  #tried_ms = -Infinity; // when unwritten notes were tried last

  /** on_change: called after any change. */
  constructor(
    readonly server: Server, readonly world: string, readonly name: string, readonly lesson: Lesson,
    readonly on_change: () => void) {
    this.course = new Course(lesson, []);
    void this.#begin_reading();
  }

  close(): void {
    clearTimeout(this.#timer);
  }

  get info(): WorldInfo|null {
    return this.server.worlds.find(this.world);
  }

  /** Why the user cannot play the lesson in this world now, as a sentence; empty: he can. */
  get why_not(): string {
    const {access} = this.server;
    return (["add_note", "set_parameters", "reset_world", "run"] as const)
             .map((kind) => access.why_not(kind, this.world))
             .find((why) => why !== "") ??
      "";
  }

  /** Whether the generations of a step have run, so that only the observations may be missing. */
  has_performed(step: number): boolean {
    return this.#performed.has(step);
  }

  /** Whether notes wait to be written. */
  get has_unwritten(): boolean {
    return this.#notes.some(({run}) => run !== (this.info?.run_id ?? ""));
  }

  /** How many of the generations of the running step have ended, from 0 to 1. */
  get progress(): number {
    const {running, info} = this;
    if (running === null || running.run === "" || info?.run_id !== running.run) {
      return 0;
    }
    return Math.min(
      Math.max(((info.generation ?? 1) - running.first) / Math.max(running.until - running.first, 1), 0), 1);
  }

  // ---- what the user does ----

  show(step: number): void {
    this.step = Math.min(Math.max(step, 0), this.lesson.steps.length - 1);
    this.#changed();
  }

  /** Begins the lesson, or begins it again: sets the parameters of the lesson, all others to their defaults, and resets
   *  the world. */
  begin(): Promise<void> {
    return this.#attempt(async () => {
      const set = await this.#read_parameters();
      await this.#set(set, this.lesson.experiment, true);
      await this.#reset();
      this.#forget();
      this.state = "begun";
    });
  }

  predict(value: Prediction): Promise<void> {
    const step = this.step, id = this.lesson.steps[step]!.predict!.id;
    return this.#attempt(async () => {
      this.#add({kind: "lesson_prediction", lesson: this.name, step: step + 1, id, value});
      await this.#write();
      if (this.course.phase(step) === "do" && this.lesson.steps[step]!.do === undefined) {
        await this.#observe(step);
      }
    });
  }

  /** Performs what the shown step does, then observes. fast: at the maximum speed */
  perform(fast: boolean): Promise<void> {
    const step = this.step;
    return this.#attempt(async () => {
      const {set, reset, run} = this.lesson.steps[step]!.do ?? {};
      this.running = {step, run: "", until: 0, first: 0, speed: undefined};
      if (set !== undefined) {
        await this.#set(await this.#read_parameters(), set);
      }
      if (reset) {
        await this.#reset();
      }
      await this.#write();
      if (run !== undefined) {
        await this.#run(run, fast);
      } else {
        await this.#observe(step);
      }
    }, () => (this.running = null));
  }

  /** Observes the shown step again after a failure. */
  observe(): Promise<void> {
    return this.#attempt(() => this.#observe(this.step));
  }

  resume(): Promise<void> {
    return this.#attempt(() => this.server.request("resume", {world: this.world}));
  }

  /** Writes notes that could not be written before, if that may succeed now. */
  retry(): void {
    const now = performance.now();
    const is_due = now - this.#tried_ms > retry_ms && this.state === "begun" && !this.is_busy && this.has_unwritten;
    if (is_due && this.why_not === "") {
      this.#tried_ms = now;
      void this.#attempt(() => this.#write());
    }
  }

  // ---- requests ----

  async #attempt(act: () => Promise<unknown>, failed: () => void = () => undefined): Promise<void> {
    this.is_busy = true;
    this.problem = "";
    this.on_change();
    try {
      await act();
    } catch (error) {
      this.problem = error instanceof Error ? error.message : String(error);
      failed();
    } finally {
      this.is_busy = false;
      this.#changed();
    }
  }

  async #read_parameters(): Promise<ParameterSet> {
    return await this.server.request("get_parameters", {world: this.world});
  }

  async #set(set: ParameterSet, settings: {[name: string]: Setting}, all = false): Promise<void> {
    const wanted = changed(set_parameters(this.server.parameters, set, settings, all));
    if (wanted.length > 0) {
      const revision = set.revision === undefined ? {} : {expected_revision: set.revision};
      await this.server.request("set_parameters", {world: this.world, parameters: assignments(wanted), ...revision});
    }
  }

  /** Begins another run with the seed of the lesson. */
  async #reset(): Promise<void> {
    await this.server.request("reset_world", {world: this.world, seed: this.lesson.seed});
  }

  async #run(generations: number, fast: boolean): Promise<void> {
    const {world, server} = this, before = this.info?.speed;
    if (fast && !before?.max) {
      await server.request("set_speed", {world, speed: {max: true}});
      this.running!.speed = before;
    }
    const first = this.info?.generation ?? 1, info = await server.request("run", {world, generations});
    Object.assign(
      this.running!, {run: info.run_id ?? "", first, until: info.run_until_generation ?? first + generations});
    this.#follow();
  }

  // ---- the run ----

  /** Looks at the world until its run has ended. */
  #follow(): void {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.#look(), poll_ms) as unknown as number;
  }

  async #look(): Promise<void> {
    const {running, world, server} = this;
    if (running === null) {
      return;
    }
    if (server.state.phase === "open") {
      try {
        await server.request("get_statistics", {world}); // the server's answer updates `info`
      } catch {
        // The session ended; the next one asks again.
      }
    }
    const {info} = this;
    if (info !== null && info.run_id !== running.run) {
      this.running = null; // another user, or this one in another panel, has reset the world
    } else if (info !== null && has_ended(info, running.until)) {
      await this.#attempt(() => this.#end(running));
    } else {
      this.#follow();
    }
    this.#changed();
  }

  async #end({step, speed}: Running): Promise<void> {
    this.running = null;
    this.#performed.add(step);
    await this.#observe(step);
    if (speed !== undefined) {
      await this.server.request("set_speed", {world: this.world, speed});
    }
  }

  async #observe(step: number): Promise<void> {
    const {lesson, name, course} = this, of = lesson.steps[step]!, asked = asked_by(of, course.observed);
    const {observations = []} = asked.expressions.length === 0 ?
      {} :
      await this.server.request("observe", {world: this.world, expressions: asked.expressions});
    const {observed, law} = values_of(asked, asked.expressions.map((_, i) => observations[i]?.value));
    for (const [id, value] of observed) {
      this.#add({kind: "lesson_observation", lesson: name, step: step + 1, id, value});
    }
    const answer = answer_of(lesson, of, course.predictions, new Map([...course.observed, ...observed]), law);
    if (answer !== null) {
      this.#add({kind: "lesson_answer", lesson: name, step: step + 1, ...answer});
    }
    this.#performed.add(step);
    await this.#write();
  }

  // ---- notes ----

  #add(note: Note): void {
    this.#notes.push({note, run: ""});
    this.#changed();
  }

  /** Writes all notes that the present run does not contain. */
  async #write(): Promise<void> {
    const run = this.info?.run_id ?? "";
    for (const kept of this.#notes.filter((one) => one.run !== run)) {
      await this.server.request("add_note", {world: this.world, kind: kept.note.kind, text: note_text(kept.note)});
      kept.run = run;
      this.#remember();
    }
  }

  #forget(): void {
    this.#notes = [];
    this.#performed.clear();
    this.running = null;
    this.step = 0;
  }

  async #begin_reading(): Promise<void> {
    const remembered = this.#remembered(), run = this.info?.run_id ?? "";
    this.#notes = united(run, await this.#journaled(), remembered?.notes ?? []);
    this.#performed = new Set(remembered?.performed ?? []);
    this.state = this.#notes.length > 0 || remembered !== null ? "begun" : "not begun";
    this.course = this.#course();
    this.step = remembered?.step ?? this.course.open;
    if (this.state === "begun") {
      this.running = remembered?.running?.run === run ? remembered.running : this.#found_run();
      if (this.running !== null) {
        this.step = this.running.step;
        this.#follow();
      }
    }
    this.#changed();
  }

  /** The run of the open step if this tab does not remember it; null: the world has no such goal. */
  #found_run(): Running|null {
    const {course, info} = this, until = info?.run_until_generation;
    if (until === undefined || course.phase(course.open) !== "do") {
      return null;
    }
    const generations = this.lesson.steps[course.open]!.do?.run ?? 1;
    return {step: course.open, run: info?.run_id ?? "", until, first: until - generations, speed: undefined};
  }

  /** The notes in the journal of the run; none if the run is not stored. */
  async #journaled(): Promise<Note[]> {
    const notes: Note[] = [];
    try {
      await read_export(
        this.server, {world: this.world, table: "RUN_TABLE_NOTES", format: "TEXT_FORMAT_JSON_LINES"},
        (rows) => notes.push(...rows.flatMap((row) => read_note(row, this.name) ?? [])));
    } catch {
      // The server stores no runs, or the world ended: this tab remembers the notes.
    }
    return notes;
  }

  #course(): Course {
    return new Course(this.lesson, this.#notes.map(({note}) => note), this.#performed);
  }

  #changed(): void {
    this.course = this.#course();
    this.#remember();
    this.on_change();
  }

  // ---- what this tab remembers ----

  get #key(): string {
    return `lesson ${this.world} ${this.name}`;
  }

  #remember(): void {
    if (this.state === "begun") {
      const {step, running} = this;
      const remembered: Remembered = {notes: this.#notes, performed: [...this.#performed], running, step};
      of_tab.set(this.#key, JSON.stringify(remembered));
    }
  }

  #remembered(): Remembered|null {
    try {
      return JSON.parse(of_tab.get(this.#key) || "null") as Remembered | null;
    } catch {
      return null;
    }
  }
}

/** Whether the generation before `until` has ended. */
function has_ended(info: WorldInfo, until: number): boolean {
  const waits = info.state === "RUN_STATE_WAITING" && info.run_until_generation === undefined;
  return waits || info.state === "RUN_STATE_TERMINATED" || (info.generation ?? 1) >= until;
}
