// Body: reads the numbers in the body of a snapshot, one after another, in the layout that stream.proto describes.
//
// It checks everything and throws only DamagedData. Columns may point into memory that the next column overwrites.
import {DamagedData} from "./errors";

const with_exceptions = 128; // flag in the width of a column

if (new Uint8Array(new Uint16Array([1]).buffer)[0] !== 1) {
  throw new Error("this page needs a little-endian processor");
}

// Aligned copies of columns and exceptions. The memory grows to the longest column so far.
let column_space = new Int32Array(1024), bytes_space = new Uint8Array(4096);

function u32_at(bytes: Uint8Array, at: number): number {
  return (bytes[at] | bytes[at + 1] << 8 | bytes[at + 2] << 16 | bytes[at + 3] << 24) >>> 0;
}

export class BodyReader {
  #at = 0;

  readonly #bytes: Uint8Array;

  constructor(bytes: Uint8Array) {
    this.#bytes = bytes;
  }

  rest_bytes(): number {
    return this.#bytes.length - this.#at;
  }

  #take(count: number): number {
    if (count > this.#bytes.length - this.#at) {
      throw new DamagedData("a snapshot's body ends too early");
    }
    this.#at += count;
    return this.#at - count;
  }

  u8(): number {
    return this.#bytes[this.#take(1)];
  }

  u16(): number {
    const at = this.#take(2);
    return this.#bytes[at] | this.#bytes[at + 1] << 8;
  }

  u32(): number {
    return u32_at(this.#bytes, this.#take(4));
  }

  end(): void {
    if (this.#at !== this.#bytes.length) {
      throw new DamagedData("a snapshot's body has surplus bytes at its end");
    }
  }

  /** Reads `count` numbers in planes of bytes, the lowest byte of every number first. width: 1, 2 or 4. */
  planes(count: number, width: number, to: Int32Array|Uint8Array): void {
    const at = this.#take(count * width), bytes = this.#bytes;
    if (width === 1) {
      to.set(bytes.subarray(at, at + count));
    } else if (width === 2) {
      for (let i = 0, low = at, high = at + count; i < count; ++i) {
        to[i] = bytes[low++] | bytes[high++] << 8;
      }
    } else {
      for (let i = 0; i < count; ++i) {
        to[i] = bytes[at + i] | bytes[at + count + i] << 8 | bytes[at + 2 * count + i] << 16 |
          bytes[at + 3 * count + i] << 24;
      }
    }
  }

  /** Reads a column of signed numbers. The result has at least `count` elements and is valid until the next column. The
   *  caller must ensure that the input justifies memory for `count` numbers. */
  column(count: number): Int32Array {
    const width_and_flag = this.u8(), width = width_and_flag & ~with_exceptions;
    let exceptions = 0, indices_at = 0, values_at = 0;
    if (width_and_flag & with_exceptions) {
      exceptions = this.u32();
      indices_at = this.#take(4 * exceptions);
      values_at = this.#take(4 * exceptions);
    }
    if (width !== 0 && width !== 1 && width !== 2 && width !== 4) {
      throw new DamagedData(`a snapshot's body has a column of ${width} bytes per value, allowed 0, 1, 2, 4`);
    }
    const at = this.#take(count * width), bytes = this.#bytes;
    if (column_space.length < count) {
      column_space = new Int32Array(Math.max(count, 2 * column_space.length));
    }
    const column = column_space;
    if (width === 0) {
      column.fill(0, 0, count);
    } else if (width === 1) {
      for (let i = 0; i < count; ++i) {
        column[i] = bytes[at + i] << 24 >> 24;
      }
    } else if (width === 2) {
      for (let i = 0, from = at; i < count; ++i, from += 2) {
        column[i] = (bytes[from] | bytes[from + 1] << 8) << 16 >> 16;
      }
    } else {
      if (bytes_space.length < 4 * count) {
        bytes_space = new Uint8Array(Math.max(4 * count, 2 * bytes_space.length));
      }
      bytes_space.set(bytes.subarray(at, at + 4 * count));
      column.set(new Int32Array(bytes_space.buffer, 0, count));
    }
    for (let i = 0; i < exceptions; ++i) {
      const index = u32_at(bytes, indices_at + 4 * i);
      if (index >= count) {
        throw new DamagedData(`a snapshot's body has a separately stored value for index ${index} of ${count} values`);
      }
      column[index] = u32_at(bytes, values_at + 4 * i);
    }
    return column;
  }

  /** Reads `count` rising numbers below `end`, at most 2^32. */
  rising_column(count: number, end: number): Uint32Array {
    const steps = this.column(count), numbers = new Uint32Array(count);
    let next = 0;
    for (let i = 0; i < count; ++i) {
      next += steps[i] >>> 0;
      if (next >= end) {
        throw new DamagedData("a snapshot's body has an id or index that is too large");
      }
      numbers[i] = next++;
    }
    return numbers;
  }
}
