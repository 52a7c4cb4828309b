// Width: the width of an element in CSS pixels, without a layout at each reading.

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

  /** The width within these limits; the lower one until the width is known. */
  within(least: number, most: number): number {
    return Math.min(Math.max(this.#px, least), most);
  }
}
