// ParameterReader: the parameters of the shown world, read again after each event about them.
import type {ParameterSet} from "../core/protocol";
import {experiment_text} from "../texts/experiment";

import type {Changes} from "./changes";
import type {SnapshotFeed} from "./feed";

export class ParameterReader {
  set: ParameterSet|null = null; // of the shown world
  warnings: readonly string[] = []; // of the server, about `set`
  #pending = false;
  #is_stale = false;
  readonly #feed: SnapshotFeed;
  readonly #changes: Changes;

  constructor(feed: SnapshotFeed, changes: Changes) {
    this.#feed = feed;
    this.#changes = changes;
  }

  /** What the organisms of the world try to do, as sentences; empty until the parameters have arrived. */
  get experiment(): string {
    return this.set === null ? "" : experiment_text(this.set);
  }

  /** The parameters may have changed: poll() reads them. */
  expire(): void {
    this.#is_stale = true;
  }

  poll(): void {
    if (this.#is_stale) {
      this.read();
    }
  }

  /** Reads the parameters, and once more if they change while they are read. */
  read(): void {
    this.#is_stale = true;
    const {world, server} = this.#feed;
    if (this.#pending || !world) {
      return;
    }
    this.#pending = true;
    this.#is_stale = false;
    server.respond("get_parameters", {world})
      .then(
        ({parameters, warnings}) => {
          if (world === this.#feed.world) {
            this.set = parameters ?? null;
            this.warnings = warnings ?? [];
          } else {
            this.#is_stale = true;
          }
        },
        () => undefined)
      .finally(() => {
        this.#pending = false;
        this.#changes.notify();
      });
  }
}
