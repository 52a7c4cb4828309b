// What people read before a world can be shown, and about a link whose world is not there.
import type * as english from "../texts/start";

export const start_texts: typeof english.start_texts = {
  title: "evod",
  connecting: "Verbindung zum Server wird aufgebaut …",
  token: "Token",
  connect: "Verbinden",
  token_help:
    "Tokens erzeugt, wer den Server verwaltet, mit evod token add. Die Seite merkt sich das Token, bis dieser " +
    "Tab geschlossen wird. Das Feld bleibt leer, wenn der Server kein Token braucht.",
  try_again: "Noch einmal",
  token_required: "Der Server verlangt ein Token.",
  lost: (message) => `${message}. Neuer Versuch …`,
  too_old: "Dieser Browser ist zu alt: Die Seite braucht Chrome 111, Firefox 121, Safari 17 oder neuer.",
  no_protocol: (reason) => `Der Server sendet sein Protokoll nicht: ${reason}`,
  failed: (reason) => `Die Seite ist gescheitert: ${reason || "Ihr Worker lässt sich nicht starten"}`,
};

export const wrong_link_texts: typeof english.wrong_link_texts = {
  no_such_world: (name, worlds) =>
    `Welt: ${name} gibt es nicht, dieser Server hat ${worlds.length > 0 ? worlds.join(", ") : "keine Welt"}`,
  this_server: "dieser Server",
  world: (name) => `die Welt ${name}`,
  generation: (generation) => `Generation ${generation}`,
};
