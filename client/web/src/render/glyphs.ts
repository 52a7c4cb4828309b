// Glyphs: the characters of labels as an atlas, drawn at the size of device pixels, so that text is sharp at any pixel
// ratio.

const characters = "#0123456789 ♥";
const font_pixels = 13;
const font = (pixels: number) => `${pixels}px system-ui, "DejaVu Sans", sans-serif`;

export const label_height = 14; // CSS pixels

export class Glyphs {
  readonly bytes: Uint8Array; // red: the glyph; green: its halo
  readonly cell_width: number; // device pixels
  readonly cell_height: number;
  readonly columns = characters.length;
  readonly padding: number; // left of a glyph in its cell, and above it
  readonly #advances: number[]; // whole device pixels

  constructor(readonly ratio: number) {
    const pixels = font_pixels * ratio;
    const measuring = new OffscreenCanvas(1, 1).getContext("2d")!;
    measuring.font = font(pixels);
    this.#advances = [...characters].map((character) => Math.round(measuring.measureText(character).width));
    const halo = 1.5 * ratio;
    this.padding = Math.ceil(halo) + 1;
    this.cell_width = Math.max(...this.#advances) + 2 * this.padding;
    this.cell_height = Math.ceil(label_height * ratio) + 2 * this.padding;
    const width = this.cell_width * this.columns;
    const canvas = new OffscreenCanvas(width, this.cell_height);
    const context = canvas.getContext("2d", {willReadFrequently: true})!;
    context.font = font(pixels);
    context.textBaseline = "alphabetic";
    context.lineJoin = "round";
    context.lineWidth = 2 * halo;
    const layers = [false, true].map((is_halo) => {
      context.clearRect(0, 0, width, this.cell_height);
      [...characters].forEach((character, i) => {
        const x = i * this.cell_width + this.padding;
        const y = this.padding + Math.round(11.5 * ratio);
        if (is_halo) {
          context.strokeText(character, x, y);
        }
        context.fillText(character, x, y);
      });
      return context.getImageData(0, 0, width, this.cell_height).data;
    });
    this.bytes = new Uint8Array(4 * width * this.cell_height);
    for (let i = 0; i < this.bytes.length; i += 4) {
      this.bytes[i] = layers[0]![i + 3]!;
      this.bytes[i + 1] = layers[1]![i + 3]!;
      this.bytes[i + 3] = 255;
    }
  }

  /** Returns the number of a character in the atlas, -1 if it is not there. */
  index_of(character: string): number {
    return characters.indexOf(character);
  }

  advance(index: number): number {
    return this.#advances[index]!;
  }

  /** The width of a text in CSS pixels. */
  measure(text: string): number {
    let width = 0;
    for (const character of text) {
      width += this.#advances[this.index_of(character)] ?? 0;
    }
    return width / this.ratio;
  }
}
