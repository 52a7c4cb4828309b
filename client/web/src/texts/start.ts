// What people read before a world can be shown, and about a link whose world is not there.

export const start_texts = {
  title: "evod",
  connecting: "Connecting to the server …",
  token: "Token",
  connect: "Connect",
  token_help:
    "The administrator of the server creates tokens with evod token add. The page keeps the token until this tab is " +
    "closed. Leave the field empty if the server needs no token.",
  try_again: "Try again",
  token_required: "The server requires a token.",
  lost: (message: string) => `${message}. Trying again …`,
  too_old: "This browser is too old: the page needs Chrome 111, Firefox 121, Safari 17 or a newer one.",
  no_protocol: (reason: string) => `The server does not send its protocol: ${reason}`,
  failed: (reason: string) => `The page has failed: ${reason || "its worker cannot be started"}`,
};

/** The wrong parts of a link: "island: got 7, the world default has 0 to 3". */
export const wrong_link_texts = {
  no_such_world: (name: string, worlds: readonly string[]) =>
    `world: got ${name}, this server has ${worlds.length > 0 ? worlds.join(", ") : "no world"}`,
  this_server: "this server",
  world: (name: string) => `the world ${name}`,
  generation: (generation: number) => `generation ${generation}`,
};
