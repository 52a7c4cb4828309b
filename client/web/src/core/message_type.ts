// message_type: what the schema says about messages, and the numbers of the wire format.
import type {RequestRules} from "./protocol";

export const depth_max = 100; // levels of nested messages and groups

// FieldDescriptorProto.Type. Schema refuses the others, which no message of the protocol has.
export const DOUBLE = 1, FLOAT = 2, INT64 = 3, UINT64 = 4, INT32 = 5, FIXED32 = 7, BOOL = 8, STRING = 9;
export const MESSAGE = 11, BYTES = 12, UINT32 = 13, ENUM = 14;

export const VARINT = 0, EIGHT_BYTES = 1, LENGTH = 2, GROUP = 3, END_GROUP = 4, FOUR_BYTES = 5; // wire types

export const wire_type_of = [
  -1, EIGHT_BYTES, FOUR_BYTES, VARINT, VARINT, VARINT, -1, FOUR_BYTES, VARINT, LENGTH, -1, LENGTH, LENGTH, VARINT,
  VARINT
];

/** A message of any type, as it is read or written. */
export type Fields = {
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
