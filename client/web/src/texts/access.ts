// Why the user may not send a request now.
export const access_texts = {
  no_connection: "There is no connection to the server.",
  unknown_request: "The server does not know this request.",
  admin_only: "Only the role admin may create and delete worlds.",
  read_only: "You are connected as a viewer: read-only.",
  own_worlds: "You can change only your own worlds.",
  own_classes: "A teacher can change only the worlds of the own classes.",
  frozen: "Your teacher has frozen the class.",
  first_world: "This is your first world: it cannot be deleted.",
  watching: "You are watching. Press “Take part” to change worlds.",
  run_not_stored: "The run of this world is not stored.",
};
