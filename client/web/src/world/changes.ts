// Listeners: a list of functions that are called with each message. Changes: the same for changes, called at most once
// per animation frame, or once per microtask.

export class Listeners<Message = void> {
  #listeners = new Set<(message: Message) => void>();

  /** Returns a function that ends it. */
  listen(listener: (message: Message) => void): () => void {
    this.#listeners.add(listener);
    return () => this.#listeners.delete(listener);
  }

  call(message: Message): void {
    for (const listener of [...this.#listeners]) {
      listener(message);
    }
  }
}

export class Changes extends Listeners {
  #scheduled = false;

  /** per_frame: listeners wait for the next animation frame; a hidden page has none, so they then wait until it is
   *  shown. */
  readonly #per_frame: boolean;

  constructor(per_frame: boolean) {
    super();
    this.#per_frame = per_frame;
  }

  notify(): void {
    if (this.#scheduled) {
      return;
    }
    this.#scheduled = true;
    const call = (): void => {
      this.#scheduled = false;
      this.call();
    };
    if (this.#per_frame) {
      requestAnimationFrame(call);
    } else {
      queueMicrotask(call);
    }
  }
}
