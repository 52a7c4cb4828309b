// measurements: what the worker measures and draws, for tests, benchmarks and the console of the browser.
import type {Figures, FromWorker, ToWorker} from "../core/messages";
import type {Snapshot} from "../core/snapshot";
import type {Server} from "./server";

let last_id = 0;

/** Figures of the worker. */
export async function figures(server: Server): Promise<Figures> {
  const id = ++last_id;
  return (await answer(server, "figures", {kind: "ask_figures", id})).figures;
}

/** The entities of the newest snapshot in a pane; null if there is none. */
export async function columns(server: Server, pane: number): Promise<Snapshot|null> {
  const id = ++last_id;
  return (await answer(server, "columns", {kind: "ask_columns", pane, id})).columns;
}

function answer<Kind extends "figures"|"columns">(
  server: Server, kind: Kind, question: ToWorker&{id: number}): Promise<Extract<FromWorker, {kind: Kind}>> {
  return new Promise((resolve) => {
    const end = server.messages.listen((message) => {
      if (message.kind === kind && "id" in message && message.id === question.id) {
        end();
        resolve(message as Extract<FromWorker, {kind: Kind}>);
      }
    });
    server.post(question);
  });
}
