// message_reader: reads messages from bytes, as protobuf.ts describes.
import {DamagedData} from "./errors";
import {
  BOOL,
  BYTES,
  depth_max,
  DOUBLE,
  EIGHT_BYTES,
  END_GROUP,
  ENUM,
  type Field,
  type Fields,
  FIXED32,
  FLOAT,
  FOUR_BYTES,
  GROUP,
  INT64,
  LENGTH,
  MESSAGE,
  type MessageType,
  STRING,
  UINT32,
  UINT64,
  VARINT,
  wire_type_of
} from "./message_type";

const decoder = new TextDecoder("utf-8", {fatal: true, ignoreBOM: true});

class Reader {
  at = 0;
  end: number; // of the innermost message
  readonly #view: DataView;
  #low = 0; // of the last varint
  #high = 0;

  constructor(readonly bytes: Uint8Array) {
    this.end = bytes.length;
    this.#view = new DataView(bytes.buffer, bytes.byteOffset, bytes.byteLength);
  }

  /** Reads a varint into low and high, both unsigned. */
  #varint(): void {
    const bytes = this.bytes, end = this.end;
    let at = this.at, low = 0, high = 0;
    for (let shift = 0;; shift += 7) {
      if (at >= end || shift > 63) {
        throw new DamagedData(at >= end ? "a message ends within a number" : "a number has more than 10 bytes");
      }
      const byte = bytes[at++]!;
      if (shift < 28) {
        low |= (byte & 127) << shift;
      } else if (shift === 28) {
        low |= (byte & 15) << 28;
        high = (byte & 127) >> 4;
      } else {
        high |= (byte & 127) << (shift - 32);
      }
      if (byte < 128) {
        break;
      }
    }
    this.at = at;
    this.#low = low >>> 0;
    this.#high = high >>> 0;
  }

  tag(): number {
    this.#varint();
    if (this.#high !== 0 || this.#low < 8) {
      throw new DamagedData("a message has an invalid field number");
    }
    return this.#low;
  }

  /** Reads a length and returns the position after that many bytes. */
  end_of_length(): number {
    this.#varint();
    if (this.#high !== 0 || this.#low > this.end - this.at) {
      throw new DamagedData("a field is longer than its message");
    }
    return this.at + this.#low;
  }

  /** Returns the position of the next `count` bytes and moves behind them. */
  take(count: number): number {
    if (count > this.end - this.at) {
      throw new DamagedData("a message ends within a field");
    }
    this.at += count;
    return this.at - count;
  }

  bytes_of_length(): Uint8Array {
    const end = this.end_of_length(), begin = this.at;
    this.at = end;
    return this.bytes.subarray(begin, end);
  }

  string(): string {
    try {
      return decoder.decode(this.bytes_of_length());
    } catch (error) {
      throw error instanceof DamagedData ? error : new DamagedData("a text is not valid UTF-8");
    }
  }

  /** Reads a value of any type but STRING, BYTES and MESSAGE. */
  scalar(field: Field): number|bigint|boolean|string {
    switch (field.type) {
      case DOUBLE:
        return this.#view.getFloat64(this.take(8), true);
      case FLOAT:
        return this.#view.getFloat32(this.take(4), true);
      case FIXED32:
        return this.#view.getUint32(this.take(4), true);
    }
    this.#varint();
    switch (field.type) {
      case INT64:
        return whole(this.#low, this.#high, true, field.is_wide);
      case UINT64:
        return whole(this.#low, this.#high, false, field.is_wide);
      case BOOL:
        return this.#low !== 0 || this.#high !== 0;
      case UINT32:
        return this.#low;
      case ENUM:
        return field.values!.names.get(this.#low | 0) ?? (this.#low | 0);
      default:
        return this.#low | 0; // INT32
    }
  }

  /** Skips the value of a field. */
  skip(number: number, wire_type: number, depth: number): void {
    switch (wire_type) {
      case VARINT:
        this.#varint();
        break;
      case EIGHT_BYTES:
        this.take(8);
        break;
      case FOUR_BYTES:
        this.take(4);
        break;
      case LENGTH:
        this.at = this.end_of_length();
        break;
      case GROUP:
        if (depth === 0) {
          throw new DamagedData(`a message is nested more than ${depth_max} deep`);
        }
        for (;;) {
          const tag = this.tag();
          if ((tag & 7) === END_GROUP) {
            if (tag >>> 3 !== number) {
              throw new DamagedData("a group has the end of another group");
            }
            break;
          }
          this.skip(tag >>> 3, tag & 7, depth - 1);
        }
        break;
      default:
        throw new DamagedData(`a field has the wire type ${wire_type}, allowed: 0, 1, 2, 3 and 5`);
    }
  }
}

/** Returns a 64-bit integer: as a bigint if it is wide and a number would not be exact, otherwise as a number. */
function whole(low: number, high: number, is_signed: boolean, is_wide: boolean): number|bigint {
  const top = is_signed ? high | 0 : high;
  if (!is_wide || (top >= -0x200000 && top < 0x200000)) {
    return top * 0x100000000 + low;
  }
  return (BigInt(top) << 32n) | BigInt(low);
}

/** Message: what the type describes. */
export function read_message<Message extends object>(type: MessageType, bytes: Uint8Array): Message {
  const message: Fields = {};
  read_fields(new Reader(bytes), type, message, depth_max);
  return message as Message;
}

/** Reads fields up to reader.end. */
function read_fields(reader: Reader, type: MessageType, message: Fields, depth: number): void {
  while (reader.at < reader.end) {
    const tag = reader.tag(), number = tag >>> 3, wire_type = tag & 7;
    const field = type.by_number.get(number);
    const own = field === undefined ? -1 : wire_type_of[field.type]!;
    if (field === undefined || (wire_type !== own && !(field.repeated && wire_type === LENGTH && own !== LENGTH))) {
      reader.skip(number, wire_type, depth);
    } else if (field.repeated) {
      read_repeated(reader, field, (message[field.name] ??= []) as unknown[], wire_type !== own, depth);
    } else {
      if (field.oneof !== null && message[field.name] === undefined) {
        for (const other of field.oneof) {
          delete message[other.name];
        }
      }
      message[field.name] = read_value(reader, field, message[field.name], depth);
    }
  }
}

function read_repeated(reader: Reader, field: Field, values: unknown[], is_packed: boolean, depth: number): void {
  if (!is_packed) {
    values.push(read_value(reader, field, undefined, depth));
    return;
  }
  const outer_end = reader.end;
  reader.end = reader.end_of_length();
  while (reader.at < reader.end) {
    values.push(reader.scalar(field));
  }
  reader.end = outer_end;
}

/** before: the value of a message so far; later parts are merged into it. */
function read_value(reader: Reader, field: Field, before: unknown, depth: number): unknown {
  switch (field.type) {
    case STRING:
      return reader.string();
    case BYTES:
      return reader.bytes_of_length();
    case MESSAGE: {
      if (depth === 0) {
        throw new DamagedData(`a message is nested more than ${depth_max} deep`);
      }
      const message = (before ?? {}) as Fields, outer_end = reader.end;
      reader.end = reader.end_of_length();
      read_fields(reader, field.message!, message, depth - 1);
      reader.end = outer_end;
      return message;
    }
    default:
      return reader.scalar(field);
  }
}
