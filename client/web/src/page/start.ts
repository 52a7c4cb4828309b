// Start: what the page shows while there is nothing to watch: connecting, a token is needed, the server refuses or is
// not there.
import {start_texts as texts} from "../texts/start";
import {h, set_text} from "../widgets/dom";
import type {Server} from "../world/server";
import type {Tokens} from "../world/tokens";

/** Takes the token out of the address at once, so that it does not appear in the history, in a bookmark or in a shared
 *  link. Returns null if the address contains none. */
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
  readonly #title = h("h1", {}, texts.title);
  readonly #text = h("p", {role: "status"});
  readonly #token =
    h("input", {class: "field grow", type: "password", id: "token", autocomplete: "off", spellcheck: "false"});
  readonly #form: HTMLFormElement;
  readonly #again: HTMLButtonElement;

  constructor() {
    this.#form =
      h("form", {hidden: true},
        h("label",
          { for: "token"
          },
          texts.token),
        h("div", {class: "row"}, this.#token,
          h("button", {type: "submit", class: "button button-primary"}, texts.connect)),
        h("p", {class: "hint"}, texts.token_help));
    this.#again =
      h("button", {type: "button", class: "button button-primary", hidden: true, onclick: () => location.reload()},
        texts.try_again);
    this.element =
      h("main", {class: "start"}, h("div", {class: "start-card"}, this.#title, this.#text, this.#form, this.#again));
    this.say(texts.connecting);
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
    server.changes.listen(() => this.#refresh(server, tokens));
  }

  #refresh(server: Server, tokens: Tokens): void {
    const {phase, message, code} = server.state, wants_token = phase === "refused" && code === "CODE_UNAUTHENTICATED";
    const was_hidden = this.#form.hidden;
    this.#form.hidden = !wants_token;
    this.#again.hidden = !(phase === "refused" && !wants_token);
    if (wants_token) {
      this.say(tokens.used ? message : texts.token_required);
      if (was_hidden && this.element.isConnected) {
        this.#token.focus();
      }
    } else if (phase === "connecting") {
      this.say(texts.connecting);
    } else {
      this.say(phase === "lost" ? texts.lost(message) : message);
    }
  }
}
