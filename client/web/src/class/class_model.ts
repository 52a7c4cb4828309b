// ClassModel: a class as its teacher sees it: its members, their worlds and their statistics. It follows the server
// until close().
import type {ClassInfo, ClassMember} from "../core/protocol";
import {OtherHistory} from "../plots/other_history";
import {Changes} from "../world/changes";
import type {Server} from "../world/server";
import type {KnownWorld} from "../world/worlds";

import {no_standing, type Standing, standing_of} from "./standing";

const refresh_ms = 150; // several members may come at once

export interface Student {
  member: ClassMember;
  name: string;
  world: string;
  info: KnownWorld|null; // null: the world is not there
  history: OtherHistory|null;
  standing: Standing;
}

export class ClassModel {
  info: ClassInfo|null = null;
  problem = ""; // why the class cannot be read; empty: it can
  /** Calls its listeners after any change, at most once per animation frame. */
  readonly changes = new Changes(true);
  #read_ms = 0; // when `info` was read
  #timer = 0;
  readonly #histories = new Map<string, OtherHistory>(); // by world
  readonly #ends: (() => void)[];

  constructor(readonly server: Server, readonly name: string) {
    this.#ends = [
      server.events.listen((event) => {
        if (event.class_changed?.class === name || event.events_dropped) {
          this.#schedule();
        }
      }),
      server.changes.listen(() => {
        this.#follow_worlds();
        this.changes.notify();
      }),
    ];
    void this.refresh();
  }

  /** All members except removed ones, in the order in which they joined. */
  get students(): Student[] {
    return (this.info?.members ?? []).filter((member) => !member.removed).map((member) => this.student(member));
  }

  student(member: ClassMember): Student {
    const {name = "", world = ""} = member, history = this.#histories.get(world) ?? null;
    const info = this.server.worlds.find(world), standing = history === null ? no_standing : standing_of(history.table);
    return {member, name, world, info, history, standing};
  }

  get members(): ClassMember[] {
    return this.info?.members ?? [];
  }

  get is_frozen(): boolean {
    return this.info?.frozen ?? false;
  }

  /** Seconds until the code ends; 0: there is no code. */
  get code_valid_s(): number {
    const {code = "", code_valid_s = 0} = this.info ?? {};
    return code === "" ? 0 : Math.max(Math.round(code_valid_s - (performance.now() - this.#read_ms) / 1000), 0);
  }

  /** Reads the class. */
  async refresh(): Promise<void> {
    try {
      const {classes = []} = await this.server.request("list_classes", {});
      this.take(classes.find(({name}) => name === this.name) ?? null);
      this.problem = "";
    } catch (error) {
      this.problem = (error as Error).message;
    }
    this.changes.notify();
  }

  /** Takes the class as the server has answered it. */
  take(info: ClassInfo|null): void {
    this.info = info;
    this.#read_ms = performance.now();
    this.#follow_worlds();
    this.changes.notify();
  }

  close(): void {
    clearTimeout(this.#timer);
    this.#ends.forEach((end) => end());
    this.#histories.forEach((history) => history.close());
  }

  #schedule(): void {
    clearTimeout(this.#timer);
    this.#timer = setTimeout(() => void this.refresh(), refresh_ms) as unknown as number;
  }

  /** Reads the statistics of the worlds that are there, and of no others. */
  #follow_worlds(): void {
    const worlds = new Set(this.members.filter(({removed}) => !removed).map(({world = ""}) => world));
    for (const [world, history] of this.#histories) {
      if (!worlds.has(world) || !this.server.worlds.find(world)) {
        history.close();
        this.#histories.delete(world);
      }
    }
    for (const world of worlds) {
      if (!this.#histories.has(world) && this.server.worlds.find(world)) {
        this.#histories.set(world, new OtherHistory(this.server, world, () => this.changes.notify()));
      }
    }
  }
}
