// Errors of the protocol core.

/** Received bytes are not what the protocol allows. Every reader of received bytes throws this and nothing else. */
export class DamagedData extends Error {
  override name = "DamagedData";
}

/** A message of the caller does not fit its type, or is too long to be sent. The text names the field. */
export class InvalidMessage extends Error {
  override name = "InvalidMessage";
}
