// Errors of the protocol core.
import type {Status} from "./protocol";

/** Received bytes are not what the protocol allows. Every reader of received bytes throws this and nothing else. */
export class DamagedData extends Error {
  override name = "DamagedData";
}

/** A message of the caller cannot be sent: it does not fit its type or is too long, and the text names the field; or
 *  there is no session for it. */
export class InvalidMessage extends Error {
  override name = "InvalidMessage";
}

/** A message of the caller contains an id of a session that has ended. */
export class SessionEnded extends InvalidMessage {
  override name = "SessionEnded";

  /** status: the Status with which the server would refuse the request; null: there is no session at present. */
  constructor(message: string, readonly status: Status|null) {
    super(message);
  }
}
