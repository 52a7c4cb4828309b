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
import {read_message} from "./message_reader";
import {
  BOOL,
  BYTES,
  ENUM,
  type EnumType,
  type Field,
  INT32,
  MESSAGE,
  type MessageType,
  STRING,
  wire_type_of
} from "./message_type";
import {write_message} from "./message_writer";
import {type Messages, type RequestKinds, type RequestRules, wide_fields} from "./protocol";

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
      read_message(bootstrap_types().get("FileDescriptorSet")!, descriptor);
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
        field.options = read_message(field_options, options);
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

  /** Returns the names of an enum in the order of their declaration; empty if there is no such enum. */
  enum_names(name: string): string[] {
    const numbers = this.#enums.get(name)?.numbers ?? new Map<string, number>();
    return [...numbers.keys()];
  }

  decode<Name extends keyof Messages>(type: Name, bytes: Uint8Array): Messages[Name] {
    return read_message(this.type(type), bytes);
  }

  encode<Name extends keyof Messages>(type: Name, message: Messages[Name]): Uint8Array {
    return write_message(this.type(type), message);
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
    const is_known = type === MESSAGE ? message !== null :
      type === ENUM                   ? values !== null :
                                        (wire_type_of[type] ?? -1) >= 0;
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
