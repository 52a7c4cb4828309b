// Refusals of the server as sentences.
import type {Status} from "../core/protocol";

import {capitalised} from "./numbers";

/** "fork_world.name" → "name". */
function last_field_name(field: string): string {
  return field.slice(field.lastIndexOf(".") + 1);
}

/** A sentence in place of the message of the server; empty: the message, which is English. */
export function reason_text(_reason: string|undefined): string {
  return "";
}

/** The message of a Status on one line, with the names of fields in place of their paths. */
export function refusal_text({message = "", violations = []}: Status): string {
  let text = message;
  for (const {field = ""} of violations) {
    text = text.replace(`${field}: `, `${last_field_name(field)}: `);
  }
  return capitalised(text.replace("\n  ", ": ").replaceAll("\n  ", "; "));
}
