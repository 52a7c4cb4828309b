// Protobuf: reads and writes messages by a FileDescriptorSet. There is no generated code.
//
// A message is a plain object; its type is in protocol.ts. Absent fields are missing. Repeated fields are arrays. Enums
// are names; a number without a name stays a number. 64-bit integers are numbers; beyond 2^53 they are rounded, except
// in the wide_fields of protocol.ts, where they are bigints. `bytes` are views of the bytes that were read.
//
// The reader accepts what Google's C++ parser accepts: packed and unpacked fields, unknown fields and fields of another
// wire type (skipped), parts of one message in several pieces (merged). It throws DamagedData for everything else. Its
// memory is bounded by the number of bytes it reads.
import {DamagedData, InvalidMessage} from "./errors";
import {type Messages, type RequestKinds, type RequestRules, wide_fields} from "./protocol";

const depth_max = 100; // levels of nested messages and groups

// FieldDescriptorProto.Type.
const DOUBLE = 1, FLOAT = 2, INT64 = 3, UINT64 = 4, INT32 = 5, FIXED64 = 6, FIXED32 = 7, BOOL = 8, STRING = 9;
const MESSAGE = 11, BYTES = 12, UINT32 = 13, ENUM = 14, SFIXED32 = 15, SFIXED64 = 16, SINT32 = 17, SINT64 = 18;

const VARINT = 0, EIGHT_BYTES = 1, LENGTH = 2, GROUP = 3, END_GROUP = 4, FOUR_BYTES = 5; // wire types

const wire_type_of = [
  -1, EIGHT_BYTES, FOUR_BYTES, VARINT, VARINT, VARINT, EIGHT_BYTES, FOUR_BYTES, VARINT, LENGTH, -1, LENGTH, LENGTH,
  VARINT, VARINT, FOUR_BYTES, EIGHT_BYTES, VARINT, VARINT
];

/** A message of any type, as it is read or written. */
type Fields = {
  [field: string]: unknown
};

export interface EnumType {
  name: string;
  names: Map<number, string>;
  numbers: Map<string, number>;
}

export interface Field {
  name: string;
  number: number;
  type: number; // FieldDescriptorProto.Type
  repeated: boolean;
  has_presence: boolean; // the value 0 differs from an absent field
  oneof: Field[]|null; // all fields of its oneof
  message: MessageType|null;
  values: EnumType|null;
  is_wide: boolean; // a 64-bit integer beyond 2^53 is a bigint
  /** The field's options, with extensions by name. */
  options: {rules?: RequestRules};
}

export interface MessageType {
  name: string; // "evod.v1.Request"
  fields: Field[];
  by_number: Map<number, Field>;
  by_name: Map<string, Field>;
}

// ---- the schema ----------------------------------------------------------------------------------------------------

// The parts of google/protobuf/descriptor.proto that describe other messages: name, number, type, repeated, message.
// FieldOptions are read as bytes, because their extensions are known only after the descriptor set is.
type BootstrapField = [name: string, number: number, type: number, repeated?: boolean, message?: string];
const bootstrap: {[message: string]: BootstrapField[]} = {
  FileDescriptorSet: [["file", 1, MESSAGE, true, "FileDescriptorProto"]],
  FileDescriptorProto: [
    ["name", 1, STRING], ["package", 2, STRING], ["message_type", 4, MESSAGE, true, "DescriptorProto"],
    ["enum_type", 5, MESSAGE, true, "EnumDescriptorProto"], ["extension", 7, MESSAGE, true, "FieldDescriptorProto"],
    ["syntax", 12, STRING]
  ],
  DescriptorProto: [
    ["name", 1, STRING], ["field", 2, MESSAGE, true, "FieldDescriptorProto"],
    ["nested_type", 3, MESSAGE, true, "DescriptorProto"], ["enum_type", 4, MESSAGE, true, "EnumDescriptorProto"]
  ],
  FieldDescriptorProto: [
    ["name", 1, STRING], ["extendee", 2, STRING], ["number", 3, INT32], ["label", 4, INT32], ["type", 5, INT32],
    ["type_name", 6, STRING], ["options", 8, BYTES], ["oneof_index", 9, INT32], ["proto3_optional", 17, BOOL]
  ],
  EnumDescriptorProto: [["name", 1, STRING], ["value", 2, MESSAGE, true, "EnumValueDescriptorProto"]],
  EnumValueDescriptorProto: [["name", 1, STRING], ["number", 2, INT32]],
};

// What these messages contain after reading.
interface EnumDescription {
  name?: string;
  value?: {name?: string; number?: number}[];
}
interface FieldDescription {
  name?: string;
  extendee?: string;
  number?: number;
  label?: number;
  type?: number;
  type_name?: string;
  options?: Uint8Array;
  oneof_index?: number;
  proto3_optional?: boolean;
}
interface MessageDescription {
  name?: string;
  field?: FieldDescription[];
  nested_type?: MessageDescription[];
  enum_type?: EnumDescription[];
}
interface FileDescription {
  package?: string;
  message_type?: MessageDescription[];
  enum_type?: EnumDescription[];
  extension?: FieldDescription[];
  syntax?: string;
}

function bootstrap_types(): Map<string, MessageType> {
  const types = new Map<string, MessageType>();
  for (const name of Object.keys(bootstrap)) {
    types.set(name, {name, fields: [], by_number: new Map(), by_name: new Map()});
  }
  for (const [name, fields] of Object.entries(bootstrap)) {
    for (const [field, number, type, repeated, message] of fields) {
      add_field(types.get(name)!, {
        name: field,
        number,
        type,
        repeated: repeated === true,
        has_presence: true,
        oneof: null,
        message: message === undefined ? null : types.get(message)!,
        values: null,
        is_wide: false,
        options: {}
      });
    }
  }
  return types;
}

function add_field(to: MessageType, field: Field): void {
  to.fields.push(field);
  to.by_number.set(field.number, field);
  to.by_name.set(field.name, field);
}

const no_bytes = new Uint8Array(0);
const label_repeated = 3;

/** The message types of a FileDescriptorSet. */
export class Schema {
  readonly #types = new Map<string, MessageType>();
  readonly #enums = new Map<string, EnumType>();

  /** descriptor: a serialised google.protobuf.FileDescriptorSet that contains every file that it imports. */
  constructor(descriptor: Uint8Array) {
    const {file: files = []}: {file?: FileDescription[]} =
      read(bootstrap_types().get("FileDescriptorSet")!, descriptor);
    for (const file of files) {
      this.#add_names(file, file.package ?? "", file.message_type ?? []);
    }
    const with_options: [Field, Uint8Array][] = [];
    for (const file of files) {
      const proto3 = file.syntax === "proto3";
      this.#each_message(file.package ?? "", file.message_type ?? [], (name, message) => {
        const type = this.#types.get(name)!;
        const oneofs = new Map<number, Field[]>();
        for (const description of message.field ?? []) {
          const field = this.#field_of(description, proto3);
          if (description.oneof_index !== undefined && !description.proto3_optional) {
            field.oneof = oneofs.get(description.oneof_index) ?? [];
            field.oneof.push(field);
            oneofs.set(description.oneof_index, field.oneof);
          }
          add_field(type, field);
          with_options.push([field, description.options ?? no_bytes]);
        }
      });
    }
    for (const file of files) {
      for (const description of file.extension ?? []) {
        const extended = this.#types.get((description.extendee ?? "").replace(/^\./, ""));
        if (extended !== undefined) {
          add_field(extended, this.#field_of(description, false));
        }
      }
    }
    const field_options = this.#types.get("google.protobuf.FieldOptions");
    for (const [field, options] of with_options) {
      if (field_options !== undefined && options.length > 0) {
        field.options = read(field_options, options);
      }
    }
  }

  /** Returns a message type. Throws InvalidMessage if there is none of this name. */
  type(name: string): MessageType {
    const type = this.#types.get(name);
    if (type === undefined) {
      throw new InvalidMessage(`the server's protocol has no message ${name}`);
    }
    return type;
  }

  /** Returns the names of an enum in the order of their numbers; empty if there is no such enum. */
  enum_names(name: string): string[] {
    const numbers = this.#enums.get(name)?.numbers ?? new Map<string, number>();
    return [...numbers].sort((a, b) => a[1] - b[1]).map(([value]) => value);
  }

  decode<Name extends keyof Messages>(type: Name, bytes: Uint8Array): Messages[Name] {
    return read(this.type(type), bytes);
  }

  encode<Name extends keyof Messages>(type: Name, message: Messages[Name]): Uint8Array {
    return write(this.type(type), message);
  }

  /** Returns the rules of every kind of request that the server knows, by the name of its field in Request. */
  request_rules(): Map<keyof RequestKinds, RequestRules> {
    const rules = new Map<keyof RequestKinds, RequestRules>();
    for (const field of this.type("evod.v1.Request").fields) {
      if (field.options.rules !== undefined) {
        rules.set(field.name as keyof RequestKinds, field.options.rules);
      }
    }
    return rules;
  }

  #add_names(file: FileDescription, prefix: string, messages: MessageDescription[]): void {
    const add_enums = (scope: string, enums: EnumDescription[]) => {
      for (const description of enums) {
        const name = join(scope, description.name ?? "");
        const values: EnumType = {name, names: new Map(), numbers: new Map()};
        for (const value of description.value ?? []) {
          if (!values.names.has(value.number ?? 0)) { // the first name of a number is the usual one
            values.names.set(value.number ?? 0, value.name ?? "");
          }
          values.numbers.set(value.name ?? "", value.number ?? 0);
        }
        this.#enums.set(name, values);
      }
    };
    add_enums(prefix, file.enum_type ?? []);
    this.#each_message(prefix, messages, (name, message) => {
      this.#types.set(name, {name, fields: [], by_number: new Map(), by_name: new Map()});
      add_enums(name, message.enum_type ?? []);
    });
  }

  #each_message(
    scope: string, messages: MessageDescription[], what: (name: string, message: MessageDescription) => void): void {
    for (const message of messages) {
      const name = join(scope, message.name ?? "");
      what(name, message);
      this.#each_message(name, message.nested_type ?? [], what);
    }
  }

  #field_of(description: FieldDescription, proto3: boolean): Field {
    const name = description.name ?? "", type = description.type ?? 0;
    const type_name = (description.type_name ?? "").replace(/^\./, "");
    const message = type === MESSAGE ? this.#types.get(type_name) ?? null : null;
    const values = type === ENUM ? this.#enums.get(type_name) ?? null : null;
    const is_known = type === MESSAGE ? message !== null : type === ENUM ? values !== null : wire_type_of[type] >= 0;
    if (!is_known) {
      throw new DamagedData(`the descriptor of the field ${name} has the type ${type} ${type_name}, which is unknown`);
    }
    const repeated = description.label === label_repeated;
    return {
      name,
      number: description.number ?? 0,
      type,
      repeated,
      oneof: null,
      message,
      values,
      is_wide: wide_fields.has(name),
      options: {},
      has_presence: !proto3 || type === MESSAGE || description.oneof_index !== undefined
    };
  }
}

function join(scope: string, name: string): string {
  return scope === "" ? name : `${scope}.${name}`;
}

// ---- reading -------------------------------------------------------------------------------------------------------

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

  uint32(): number {
    this.#varint();
    return this.#low;
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
      case SFIXED32:
        return this.#view.getInt32(this.take(4), true);
      case FIXED64:
      case SFIXED64: {
        const at = this.take(8);
        return whole(
          this.#view.getUint32(at, true), this.#view.getUint32(at + 4, true), field.type === SFIXED64, field.is_wide);
      }
    }
    this.#varint();
    switch (field.type) {
      case INT64:
        return whole(this.#low, this.#high, true, field.is_wide);
      case UINT64:
        return whole(this.#low, this.#high, false, field.is_wide);
      case SINT64: {
        const sign = -(this.#low & 1);
        return whole(
          ((this.#low >>> 1 | this.#high << 31) ^ sign) >>> 0, (this.#high >>> 1 ^ sign) >>> 0, true, field.is_wide);
      }
      case BOOL:
        return this.#low !== 0 || this.#high !== 0;
      case UINT32:
        return this.#low;
      case SINT32:
        return this.#low >>> 1 ^ -(this.#low & 1);
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
function read<Message extends object>(type: MessageType, bytes: Uint8Array): Message {
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

// ---- writing -------------------------------------------------------------------------------------------------------

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
      case SINT32:
      case SINT64: {
        const bits = field.type === SINT32 ? 32n : 64n;
        const number = BigInt(whole_of(value, path, -(1n << (bits - 1n)), (1n << (bits - 1n)) - 1n));
        this.#write_unsigned(number < 0n ? -2n * number - 1n : 2n * number);
        break;
      }
      case FIXED32:
      case SFIXED32: {
        const number = field.type === FIXED32 ? whole_of(value, path, 0, 0xffffffff) :
                                                whole_of(value, path, -0x80000000, 0x7fffffff);
        const at = this.#grow(4);
        this.#view.setUint32(at, Number(number) >>> 0, true);
        break;
      }
      default: { // FIXED64, SFIXED64
        const number = field.type === FIXED64 ? whole_of(value, path, 0, 0xffffffffffffffffn) :
                                                whole_of(value, path, -0x8000000000000000n, 0x7fffffffffffffffn);
        const at = this.#grow(8);
        this.#view.setBigUint64(at, BigInt.asUintN(64, BigInt(number)), true);
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

function write(type: MessageType, message: object): Uint8Array {
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
