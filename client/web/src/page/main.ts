// main: starts the page: loads the protocol, starts the worker, connects, and shows the worlds when the session is
// open.
import {language} from "../texts/language";
import {start_texts} from "../texts/start";
import {columns, figures} from "../world/measurements";
import {Server} from "../world/server";
import {of_tab} from "../world/storage";
import {Tokens} from "../world/tokens";

import {App} from "./app";
import {Start, take_token} from "./start";

declare const trustedTypes:
  {createPolicy(name: string, rules: {createScriptURL(url: string): string}): {createScriptURL(url: string): string}}|
  undefined;

const worker_file = `${language.folder}worker.js`;

/** The browser starts a worker only from an address that the policy has allowed; this one allows no other. */
function start_worker(): Worker {
  const policy = typeof trustedTypes === "undefined" ? null : trustedTypes.createPolicy("evod", {
    createScriptURL: (url) => {
      if (url !== worker_file) {
        throw new TypeError(`the page starts only ${worker_file}`);
      }
      return url;
    },
  });
  return new Worker(policy ? policy.createScriptURL(worker_file) : worker_file, {type: "module"});
}

async function run(): Promise<void> {
  const linked = take_token(), tokens = new Tokens(of_tab), start = new Start();
  document.body.append(start.element);
  if (typeof OffscreenCanvas === "undefined") {
    start.fail(start_texts.too_old);
    return;
  }
  const worker = start_worker();
  let descriptor: ArrayBuffer;
  try {
    const answer = await fetch("protocol.bin");
    if (!answer.ok) {
      throw new Error(`${answer.status} ${answer.statusText}`);
    }
    descriptor = await answer.arrayBuffer();
  } catch (error) {
    start.fail(start_texts.no_protocol((error as Error).message));
    return;
  }
  const url = `${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/session`;
  const server = new Server(worker, descriptor, url);
  let app: App|null = null, state = server.state;
  server.changes.listen(() => {
    if (server.state === state) {
      return;
    }
    state = server.state;
    if (state.phase === "open") {
      tokens.opened();
    } else if (state.phase === "refused" && state.code === "CODE_UNAUTHENTICATED") {
      const other = tokens.refused();
      if (other !== null) {
        app?.notify(state.message);
        server.connect(other);
      }
    }
  });
  start.follow(server, tokens);
  worker.addEventListener("error", (event) => start.fail(start_texts.failed(event.message)));
  const show_visibility = (): void => server.post({kind: "visible", visible: document.visibilityState !== "hidden"});
  document.addEventListener("visibilitychange", show_visibility);
  show_visibility();
  server.changes.listen(() => {
    if (server.state.phase === "open" && server.worlds.are_known) {
      app ??= new App(server, tokens);
      Object.assign(globalThis, {
        evod: {server, app, figures: () => figures(server), columns: (pane: number) => columns(server, pane)}
      }); // for tests and for the console of the browser
      if (!app.element.isConnected) {
        start.element.replaceWith(app.element);
      }
    } else if (server.state.phase === "refused" && app) {
      app.element.replaceWith(start.element);
    }
  });
  addEventListener("hashchange", () => {
    const followed = take_token(), token = followed === null ? null : tokens.follow(followed);
    if (token !== null) {
      server.connect(token);
    }
    app?.follow_link(location.hash);
    app?.refresh();
  });
  server.connect(tokens.begin(linked));
}

void run();
