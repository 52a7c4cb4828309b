// What the worker says about its connection: each begins a sentence, which the page completes.
import type * as english from "../texts/worker";

export const worker_texts: typeof english.worker_texts = {
  lost: (host) => `die Verbindung zu ${host} ist abgebrochen`,
  unreachable: (host) => `der Server ${host} ist nicht erreichbar`,
  silent: (host, seconds) => `der Server ${host} hat seit ${seconds} s nichts gesendet`,
  no_connection: "es besteht keine Verbindung",
  snapshots_refused: "Der Server verweigert Momentaufnahmen",
};
