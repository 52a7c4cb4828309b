// main: starts the page: loads the protocol, starts the worker, connects, and shows the worlds when the session is
// open.
import {language} from "../texts/language";
import {start_texts} from "../texts/start";
import {columns, figures} from "../world/measurements";
import {Server} from "../world/server";
import {of_tab} from "../world/storage";
import {Tokens} from "../world/tokens";

import {App} from "./app";
import {Start, take_secret} from "./start";

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
  const linked = take_secret("token"), code = take_secret("join"), tokens = new Tokens(of_tab), start = new Start();
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
      tokens.opened(state.welcome?.membership?.token ?? "");
    } else if (state.phase === "refused" && state.code === "CODE_UNAUTHENTICATED" && !server.is_joining) {
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
    const followed = take_secret("token"), followed_code = take_secret("join"),
          token = followed === null ? null : tokens.follow(followed);
    if (token !== null) {
      server.connect(token);
    }
    if (followed_code !== null && app?.element.isConnected) {
      app.class_mode.offer(() => join(followed_code));
    } else if (followed_code !== null) {
      join(followed_code);
    }
    app?.follow_link(location.hash);
    app?.refresh();
  });
  const join = (of_class: string): void => {
    tokens.use("");
    app?.element.replaceWith(start.element);
    void start.ask_to_join(server, of_class);
  };
  if (code === null || of_tab.get("token") !== "") { // the link of a class is not followed twice
    server.connect(tokens.begin(linked));
  } else {
    join(code);
  }
}

void run();
