// SeenEvents: what has happened in a live world while the page has shown it: placed, removed, migrated, forked. The
// history of a world does not contain it.
//
// Owner    TimeMarks; one per time line.
import {kind_of} from "../core/messages";
import type {Event} from "../core/protocol";
import {timeline_texts} from "../texts/timeline";
import {event_text} from "../world/event_text";
import type {ViewedWorld} from "../world/world";

const kept_max = 1000;

export type SeenKind = "placed"|"removed"|"migration"|"fork";

export interface SeenEvent {
  kind: SeenKind;
  generation: number;
  label: string; // next to the mark
  text: string;
}

export class SeenEvents {
  /** Oldest first. */
  all: SeenEvent[] = [];
  readonly #world: ViewedWorld;
  readonly #end: () => void;
  #of = ""; // the run
  #forked = "";

  constructor(world: ViewedWorld) {
    this.#world = world;
    this.#forked = world.past.forked;
    this.#end = world.server.events.listen((event) => this.#take(event));
  }

  close(): void {
    this.#end();
  }

  /** Forgets the events of another run, and takes note of a fork. */
  refresh(): void {
    const {name, server, past: {forked}, snapshot} = this.#world;
    const of = `${name} ${server.worlds.find(name)?.run_id ?? ""}`;
    if (of !== this.#of) {
      this.#of = of;
      this.all = [];
      this.#forked = forked;
    }
    if (forked !== this.#forked) {
      this.#forked = forked;
      if (forked !== "" && snapshot) {
        const text = timeline_texts.forked(forked);
        this.#add({kind: "fork", generation: snapshot.generation, label: timeline_texts.mark_labels.fork, text});
      }
    }
  }

  #take(event: Event): void {
    const about = kind_of(event);
    if (event.world !== this.#world.name) {
      return;
    }
    if (about?.kind === "placed" || about?.kind === "removed" || about?.kind === "migration") {
      const label = timeline_texts.mark_labels[about.kind], generation = about.value.generation ?? 0;
      this.refresh();
      this.#add({kind: about.kind, generation, label, text: event_text(event)[0]});
    }
  }

  #add(event: SeenEvent): void {
    this.all.push(event);
    if (this.all.length > kept_max) {
      this.all.shift();
    }
  }
}
