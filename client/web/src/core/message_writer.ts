// message_writer: writes messages as bytes, as protobuf.ts describes.
import {InvalidMessage} from "./errors";
import {
  BOOL,
  BYTES,
  depth_max,
  DOUBLE,
  ENUM,
  type Field,
  FLOAT,
  INT32,
  INT64,
  LENGTH,
  MESSAGE,
  type MessageType,
  STRING,
  UINT32,
  UINT64,
  wire_type_of
} from "./message_type";

const encoder = new TextEncoder();

class Writer {
  #data = new Uint8Array(256);
  #view = new DataView(this.#data.buffer);
  length = 0;

  /** Makes space for `count` more bytes, moves behind them and returns the position of the first. */
  #grow(count: number): number {
    const begin = this.length;
    this.length += count;
    if (this.length > this.#data.length) {
      const larger = new Uint8Array(Math.max(this.length, 2 * this.#data.length));
      larger.set(this.#data);
      this.#data = larger;
      this.#view = new DataView(larger.buffer);
    }
    return begin;
  }

  #byte(value: number): void {
    const at = this.#grow(1); // before #data is read, which it may replace
    this.#data[at] = value;
  }

  varint(low: number, high = 0): void {
    while (high > 0 || low > 127) {
      this.#byte(low & 127 | 128);
      low = (low >>> 7 | high << 25) >>> 0;
      high >>>= 7;
    }
    this.#byte(low);
  }

  bytes(bytes: Uint8Array): void {
    this.varint(bytes.length);
    const at = this.#grow(bytes.length);
    this.#data.set(bytes, at);
  }

  /** Puts the length of the bytes from `begin` on before them. */
  insert_length(begin: number): void {
    const count = this.length - begin;
    let length_bytes = 1;
    for (let rest = count >>> 7; rest > 0; rest >>>= 7) {
      ++length_bytes;
    }
    this.#grow(length_bytes);
    this.#data.copyWithin(begin + length_bytes, begin, begin + count);
    const end = this.length;
    this.length = begin;
    this.varint(count);
    this.length = end;
  }

  scalar(field: Field, value: unknown, path: string): void {
    switch (field.type) {
      case DOUBLE: {
        const at = this.#grow(8);
        this.#view.setFloat64(at, number_of(value, path), true);
        break;
      }
      case FLOAT: {
        const at = this.#grow(4);
        this.#view.setFloat32(at, number_of(value, path), true);
        break;
      }
      case BOOL:
        if (typeof value !== "boolean") {
          throw wrong(path, value, "true or false");
        }
        this.varint(value ? 1 : 0);
        break;
      case ENUM: {
        const number = typeof value === "string" ? field.values!.numbers.get(value) : value;
        if (number === undefined) {
          throw wrong(path, value, [...field.values!.numbers.keys()].join(", "));
        }
        this.#write_signed(whole_of(number, path, -0x80000000, 0x7fffffff));
        break;
      }
      case UINT32:
        this.varint(Number(whole_of(value, path, 0, 0xffffffff)));
        break;
      case INT32:
        this.#write_signed(whole_of(value, path, -0x80000000, 0x7fffffff));
        break;
      case UINT64:
        this.#write_unsigned(whole_of(value, path, 0, 0xffffffffffffffffn));
        break;
      case INT64:
        this.#write_signed(whole_of(value, path, -0x8000000000000000n, 0x7fffffffffffffffn));
        break;
      default: { // FIXED32
        const number = whole_of(value, path, 0, 0xffffffff), at = this.#grow(4);
        this.#view.setUint32(at, Number(number), true);
      }
    }
  }

  #write_unsigned(value: number|bigint): void {
    if (typeof value === "number" && Number.isSafeInteger(value)) {
      this.varint(value >>> 0, Math.floor(value / 0x100000000));
    } else {
      this.varint(Number(BigInt(value) & 0xffffffffn), Number(BigInt(value) >> 32n));
    }
  }

  #write_signed(value: number|bigint): void {
    this.#write_unsigned(value < 0 ? BigInt.asUintN(64, BigInt(value)) : value);
  }

  take(): Uint8Array {
    return this.#data.slice(0, this.length);
  }
}

function wrong(path: string, got: unknown, allowed: string): InvalidMessage {
  const text = typeof got === "object" && got !== null ? Array.isArray(got) ? "a list" : "an object" : String(got);
  return new InvalidMessage(`${path}: got ${text}, allowed: ${allowed}`);
}

function number_of(value: unknown, path: string): number {
  if (typeof value !== "number") {
    throw wrong(path, value, "a number");
  }
  return value;
}

function whole_of(value: unknown, path: string, min: number|bigint, max: number|bigint): number|bigint {
  const is_whole = typeof value === "bigint" || (typeof value === "number" && Number.isInteger(value));
  if (!is_whole || (value as number | bigint) < min || (value as number | bigint) > max) {
    throw wrong(path, value, `a whole number from ${min} to ${max}`);
  }
  return value as number | bigint;
}

export function write_message(type: MessageType, message: object): Uint8Array {
  const writer = new Writer();
  write_fields(writer, type, message, "", depth_max);
  return writer.take();
}

function write_fields(writer: Writer, type: MessageType, message: object, path: string, depth: number): void {
  if (typeof message !== "object" || message === null || Array.isArray(message)) {
    throw wrong(path, message, `a ${type.name}`);
  }
  for (const [name, value] of Object.entries(message)) {
    const field = type.by_name.get(name), field_path = path === "" ? name : `${path}.${name}`;
    if (field === undefined) {
      throw new InvalidMessage(`${field_path}: ${type.name} has no field of this name`);
    }
    if (value === undefined || value === null) {
      continue;
    }
    if (field.repeated) {
      write_repeated(writer, field, value, field_path, depth);
    } else if (field.has_presence || !is_default(field, value)) {
      write_value(writer, field, value, field_path, depth);
    }
  }
}

function is_default(field: Field, value: unknown): boolean {
  return value === 0 ?
    !Object.is(value, -0) || (field.type !== DOUBLE && field.type !== FLOAT) :
    value === 0n || value === false || value === "" || (value instanceof Uint8Array && value.length === 0) ||
      (field.values !== null && field.values.numbers.get(value as string) === 0);
}

function write_repeated(writer: Writer, field: Field, values: unknown, path: string, depth: number): void {
  if (!Array.isArray(values) && !(ArrayBuffer.isView(values) && !(values instanceof DataView))) {
    throw wrong(path, values, "a list");
  }
  const list = values as ArrayLike<unknown>;
  if (wire_type_of[field.type] === LENGTH) {
    for (let i = 0; i < list.length; ++i) {
      write_value(writer, field, list[i], `${path}[${i}]`, depth);
    }
  } else if (list.length > 0) {
    writer.varint((field.number << 3 | LENGTH) >>> 0);
    const begin = writer.length;
    for (let i = 0; i < list.length; ++i) {
      writer.scalar(field, list[i], path);
    }
    writer.insert_length(begin);
  }
}

function write_value(writer: Writer, field: Field, value: unknown, path: string, depth: number): void {
  writer.varint((field.number << 3 | wire_type_of[field.type]!) >>> 0);
  switch (field.type) {
    case STRING:
      if (typeof value !== "string") {
        throw wrong(path, value, "a text");
      }
      writer.bytes(encoder.encode(value));
      break;
    case BYTES:
      if (!(value instanceof Uint8Array)) {
        throw wrong(path, value, "bytes");
      }
      writer.bytes(value);
      break;
    case MESSAGE: {
      if (depth === 0) {
        throw new InvalidMessage(`${path}: nested more than ${depth_max} deep`);
      }
      const begin = writer.length;
      write_fields(writer, field.message!, value as object, path, depth - 1);
      writer.insert_length(begin);
      break;
    }
    default:
      writer.scalar(field, value, path);
  }
}
