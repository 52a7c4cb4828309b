// Wire frames: an 8-byte header and a body (docs/PROTOCOL.md, Frames). Divides received bytes into frames, whatever the
// sizes of the pieces in which they arrive.
import {DamagedData} from "./errors";

export const control_channel = 1;

const header_bytes = 8;
const prefix = [0x45, 0x56, 1]; // "EV" and the framing version
const body_bytes_max = [0, 64 << 20, 256 << 20]; // of control messages and of snapshots that a client accepts

export interface Frame {
  channel: number;
  body: Uint8Array;
}

/** Returns a control frame with this body. */
export function encode_frame(body: Uint8Array): Uint8Array {
  const frame = new Uint8Array(header_bytes + body.length);
  frame.set(prefix);
  frame[3] = control_channel;
  new DataView(frame.buffer).setUint32(4, body.length, true);
  frame.set(body, header_bytes);
  return frame;
}

/** Memory: at most twice the received bytes of the incomplete frame, whatever length its header declares. */
export class FrameReader {
  #data = new Uint8Array(0); // received bytes that belong to no returned frame are at begin … end - 1
  #begin = 0;
  #end = 0;
  #is_own = true; // data is a buffer of this object; otherwise it is what feed() received

  /** Adds received bytes. The caller must not change them afterwards: bodies may be views of them. */
  feed(bytes: Uint8Array): void {
    const waiting = this.#end - this.#begin;
    if (waiting === 0) {
      this.#data = bytes;
      this.#begin = 0;
      this.#end = bytes.length;
      this.#is_own = false;
      return;
    }
    if (!this.#is_own || this.#data.length - this.#end < bytes.length) {
      const space = new Uint8Array(Math.max(waiting + bytes.length, this.#is_own ? 2 * waiting : 0));
      space.set(this.#data.subarray(this.#begin, this.#end));
      this.#data = space;
      this.#begin = 0;
      this.#end = waiting;
      this.#is_own = true;
    }
    this.#data.set(bytes, this.#end);
    this.#end += bytes.length;
  }

  /** Returns the next complete frame; null if more bytes are needed. After DamagedData the rest of the stream cannot be
   *  read. */
  next(): Frame|null {
    const waiting = this.#end - this.#begin, at = this.#begin, data = this.#data;
    for (let i = 0; i < Math.min(waiting, prefix.length); ++i) {
      if (data[at + i] !== prefix[i]) {
        throw new DamagedData(
          i < 2 ? "a frame does not begin with 'EV'" : `a frame has framing version ${data[at + i]}, not 1`);
      }
    }
    const channel = waiting > 3 ? data[at + 3]! : control_channel, bytes_max = body_bytes_max[channel];
    if (bytes_max === undefined || bytes_max === 0) {
      throw new DamagedData(`a frame is on channel ${channel}, not 1 or 2`);
    }
    if (waiting < header_bytes) {
      return null;
    }
    const length = new DataView(data.buffer, data.byteOffset + at + 4, 4).getUint32(0, true);
    if (length > bytes_max) {
      throw new DamagedData(`a frame declares ${length} bytes, allowed on its channel: at most ${bytes_max}`);
    }
    if (waiting - header_bytes < length) {
      return null;
    }
    const begin = at + header_bytes;
    this.#begin = begin + length;
    const body = this.#is_own ? data.slice(begin, this.#begin) : data.subarray(begin, this.#begin);
    if (this.#begin === this.#end) {
      this.#data = new Uint8Array(0);
      this.#begin = this.#end = 0;
      this.#is_own = true;
    }
    return {channel, body};
  }
}
