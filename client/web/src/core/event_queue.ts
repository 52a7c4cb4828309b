// EventQueue: the events that the page has not taken yet, in order.
//
// A world without bodies can end thousands of generations per second. If the page is slower than the server, the queue
// drops events about the progress of the simulation and adds an EventsDropped, so its memory stays bounded. Events
// about clients are never dropped.
import type {Event} from "./protocol";

export class EventQueue {
  #events: Event[] = [];

  /** most: more events than these make the queue drop. */
  readonly #most: number;

  constructor(most: number) {
    this.#most = most;
  }

  get is_empty(): boolean {
    return this.#events.length === 0;
  }

  push(event: Event): void {
    this.#events.push(event);
    if (this.#events.length <= this.#most) {
      return;
    }
    let dropped = 0;
    this.#events = this.#events.filter((one) => {
      const drops =
        one.generation_finished !== undefined || one.migration !== undefined || one.events_dropped !== undefined;
      dropped += one.events_dropped ? one.events_dropped.dropped_count ?? 0 : drops ? 1 : 0;
      return !drops;
    });
    this.#events.push({events_dropped: {dropped_count: dropped}});
  }

  /** Returns all events and empties the queue. */
  take(): Event[] {
    const events = this.#events;
    this.#events = [];
    return events;
  }
}
