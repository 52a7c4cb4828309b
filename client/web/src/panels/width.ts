// Width: the width of an element in CSS pixels, without a layout at each reading.

const px_min = 280;

export class Width {
  #px = 0;

  /** on_change  called after the width has changed, but not when the element is hidden */
  constructor(element: Element, on_change: () => void) {
    new ResizeObserver((entries) => {
      const px = Math.floor(entries[entries.length - 1]!.contentRect.width);
      if (px > 0 && px !== this.#px) {
        this.#px = px;
        on_change();
      }
    }).observe(element);
  }

  /** The width, from px_min to `most`; px_min until the width is known. */
  within(most: number): number {
    return Math.min(Math.max(this.#px, px_min), most);
  }
}
