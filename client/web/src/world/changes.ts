// Changes: a list of listeners, called at most once per animation frame, or once per microtask.

export class Changes {
  #listeners = new Set<() => void>();
  #scheduled = false;

  /** per_frame: listeners wait for the next animation frame; a hidden page has none, so they then wait until it is
   *  shown. */
  readonly #per_frame: boolean;

  constructor(per_frame: boolean) {
    this.#per_frame = per_frame;
  }

  listen(listener: () => void): () => void {
    this.#listeners.add(listener);
    return () => this.#listeners.delete(listener);
  }

  notify(): void {
    if (this.#scheduled) {
      return;
    }
    this.#scheduled = true;
    const call = (): void => {
      this.#scheduled = false;
      for (const listener of [...this.#listeners]) {
        listener();
      }
    };
    if (this.#per_frame) {
      requestAnimationFrame(call);
    } else {
      queueMicrotask(call);
    }
  }
}
