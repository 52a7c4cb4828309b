// Start: what the page shows while there is nothing to watch: connecting, a token is needed, the server refuses or is not there.
import {h, set_text} from "../widgets/dom";
import type {Server} from "../world/server";
import type {Tokens} from "../world/tokens";

/** Takes the token out of the address at once, so that it does not appear in the history, in a bookmark or in a shared link.
 *  Returns null if the address contains none. */
export function take_token(): string|null {
  const fields = new URLSearchParams(location.hash.slice(1)), token = fields.get("token");
  if (token !== null) {
    fields.delete("token");
    const rest = fields.toString();
    history.replaceState(null, "", location.pathname + location.search + (rest ? "#" + rest : ""));
  }
  return token;
}

export class Start {
  readonly element: HTMLElement;
  #title = h("h1", {}, "evod");
  #text = h("p", {role: "status"});
  #token = h("input", {class: "field grow", type: "password", id: "token", autocomplete: "off", spellcheck: "false"});
  #form: HTMLFormElement;
  #again: HTMLButtonElement;

  constructor() {
    this.#form = h(
      "form", {hidden: true},
      h("label",
        { for: "token"
        },
        "Token"),
      h("div", {class: "row"}, this.#token, h("button", {type: "submit", class: "button button-primary"}, "Connect")),
      h("p", {class: "hint"},
        "The administrator of the server creates tokens with evod token add. The page keeps the token until this tab is closed. Leave the field empty if the server needs no token."));
    this.#again =
      h("button", {type: "button", class: "button button-primary", hidden: true, onclick: () => location.reload()},
        "Try again");
    this.element =
      h("main", {class: "start"}, h("div", {class: "start-card"}, this.#title, this.#text, this.#form, this.#again));
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

  follow(server: Server, tokens: Tokens): void {
    this.#form.addEventListener("submit", (event) => {
      event.preventDefault();
      const token = this.#token.value.trim();
      this.#token.value = "";
      server.connect(tokens.use(token));
    });
    server.on_change(() => this.#refresh(server, tokens));
  }

  #refresh(server: Server, tokens: Tokens): void {
    const {phase, message, code} = server.state, wants_token = phase === "refused" && code === "CODE_UNAUTHENTICATED";
    const was_hidden = this.#form.hidden;
    this.#form.hidden = !wants_token;
    this.#again.hidden = !(phase === "refused" && !wants_token);
    if (wants_token) {
      this.say(tokens.used ? message : "The server requires a token.");
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
