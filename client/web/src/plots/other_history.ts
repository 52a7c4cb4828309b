// OtherHistory: the history of a world that no pane shows, for a comparison. It follows the world while it runs.
import type {Event} from "../core/protocol";
import {Changes} from "../world/changes";
import {WorldHistory} from "../world/history";
import type {Server} from "../world/server";
import {marks_of} from "./change_marks";
import {HistoryTable} from "./history_table";
import type {Mark} from "./plot_layout";

export class OtherHistory {
  readonly table = new HistoryTable();
  changes: (Mark&{label: string})[] = [];
  readonly #server: Server;
  readonly #history: WorldHistory;
  readonly #end: () => void;

  /** on_change: called after each change. */
  constructor(server: Server, readonly world: string, on_change: () => void) {
    const changes = new Changes(false);
    this.#server = server;
    this.#history = new WorldHistory(server, changes);
    const end_changes = changes.listen(() => {
      this.table.set_history(this.#history.generations);
      this.changes = marks_of(this.#history.changes);
      on_change();
    });
    const end_events = server.events.listen((event) => this.#take(event));
    this.#end = () => {
      end_changes();
      end_events();
    };
    void this.#history.read(world, false);
  }

  /** Why the history is not complete; empty if it is. */
  get problem(): string {
    return this.#history.problem;
  }

  get gene_names(): string[] {
    return this.#server.worlds.find(this.world)?.gene_names ?? [];
  }

  close(): void {
    this.#end();
  }

  #take(event: Event): void {
    if (event.events_dropped) {
      this.#history.read_missed();
    } else if (event.world !== this.world) {
      return;
    } else if (event.world_reset || event.world_created) {
      void this.#history.read(this.world, false);
    } else if (event.parameters_changed) {
      void this.#history.read_changes();
    } else if (event.generation_finished) {
      this.#history.append(event.generation_finished.statistics ?? []);
    }
  }
}
