// Why the user may not send a request now.
export const access_texts = {
  no_connection: "There is no connection to the server.",
  unknown_request: "The server does not know this request.",
  admin_only: "Only the role admin may create and delete worlds.",
  read_only: "You are connected as a viewer: read-only.",
  watching: "You are watching. Press “Take part” to change worlds.",
  run_not_stored: "The run of this world is not stored.",
};
