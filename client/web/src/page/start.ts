// Start: what the page shows while there is nothing to watch: connecting, a token is needed, the server refuses or is not there.
import { h, set_text } from "./dom";
import { of_tab } from "./storage";
import type { Server } from "./server";

/** Takes the token out of the address at once, so that it does not appear in the history, in a bookmark or in a shared link. */
export function take_token(): string {
  const fields = new URLSearchParams(location.hash.slice(1)), token = fields.get("token");
  if (token !== null) {
    fields.delete("token");
    const rest = fields.toString();
    history.replaceState(null, "", location.pathname + location.search + (rest ? "#" + rest : ""));
    of_tab.set("token", token);
  }
  return of_tab.get("token");
}

export class Start {
  readonly element: HTMLElement;
  #title = h("h1", {}, "evod");
  #text = h("p", { role: "status" });
  #token = h("input", { class: "field grow", type: "password", id: "token", autocomplete: "off", spellcheck: "false", required: true });
  #form: HTMLFormElement;
  #again: HTMLButtonElement;

  constructor() {
    this.#form = h("form", { hidden: true },
      h("label", { for: "token" }, "Token"),
      h("div", { class: "row" }, this.#token, h("button", { type: "submit", class: "button button-primary" }, "Connect")),
      h("p", { class: "hint" }, "The administrator of the server creates tokens with evod token add. The page keeps the token until this tab is closed."));
    this.#again = h("button", { type: "button", class: "button button-primary", hidden: true, onclick: () => location.reload() }, "Try again");
    this.element = h("main", { class: "start" }, h("div", { class: "start-card" }, this.#title, this.#text, this.#form, this.#again));
    this.say("Connecting to the server …");
  }

  say(text: string): void {
    set_text(this.#text, text);
  }

  /** The page cannot go on by itself. */
  fail(text: string): void {
    this.say(text);
    this.#again.hidden = false;
  }

  follow(server: Server): void {
    this.#form.addEventListener("submit", (event) => {
      event.preventDefault();
      const token = this.#token.value.trim();
      of_tab.set("token", token);
      this.#token.value = "";
      server.connect(token);
    });
    server.on_change(() => this.#refresh(server));
  }

  #refresh(server: Server): void {
    const { phase, message, code } = server.state, wants_token = phase === "refused" && code === "CODE_UNAUTHENTICATED";
    const was_hidden = this.#form.hidden;
    this.#form.hidden = !wants_token;
    this.#again.hidden = !(phase === "refused" && !wants_token);
    if (wants_token) {
      this.say(of_tab.get("token") ? message : "The server requires a token.");
      if (was_hidden && this.element.isConnected) {
        this.#token.focus();
      }
    } else if (phase === "connecting") {
      this.say("Connecting to the server …");
    } else {
      this.say(phase === "lost" ? `${message}. Trying again …` : message);
    }
  }
}
