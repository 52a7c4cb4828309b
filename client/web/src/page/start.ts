// Start: what the page shows while there is nothing to watch: connecting, a token is needed, the server refuses or is
// not there.
import type {JoinForm} from "../class/join_form";
import {start_texts as texts} from "../texts/start";
import {h, set_text} from "../widgets/dom";
import type {Server} from "../world/server";
import type {Tokens} from "../world/tokens";

/** Takes a token or a code out of the address at once, so that it does not appear in the history, in a bookmark or in a
 *  shared link. Returns null if the address contains none. */
export function take_secret(name: "token"|"join"): string|null {
  const fields = new URLSearchParams(location.hash.slice(1)), secret = fields.get(name);
  if (secret !== null) {
    fields.delete(name);
    const rest = fields.toString();
    history.replaceState(null, "", location.pathname + location.search + (rest ? "#" + rest : ""));
  }
  return secret;
}

export class Start {
  readonly element: HTMLElement;
  readonly #title = h("h1", {}, texts.title);
  readonly #text = h("p", {role: "status"});
  readonly #token =
    h("input", {class: "field grow", type: "password", id: "token", autocomplete: "off", spellcheck: "false"});
  readonly #form: HTMLFormElement;
  readonly #again: HTMLButtonElement;
  readonly #join = h("div", {hidden: true});
  #join_form: Promise<JoinForm>|null = null; // null until it is needed
  #asks = false; // the user is asked to join, and has not answered

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
      h("main", {class: "start"},
        h("div", {class: "start-card"}, this.#title, this.#text, this.#form, this.#join, this.#again));
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

  /** Asks the user for what joining a class needs. code: of the link; empty: none. */
  async ask_to_join(server: Server, code: string): Promise<void> {
    this.#asks = true;
    this.#form.hidden = this.#again.hidden = true;
    const form = await this.#shown_join_form(server);
    this.say("");
    form.begin(code);
  }

  async #shown_join_form(server: Server): Promise<JoinForm> {
    this.#join_form ??= import("../panels/loaded_later").then(({JoinForm: Loaded}) => new Loaded((join) => {
                                                                this.#asks = false;
                                                                server.connect("", join);
                                                              }));
    const form = await this.#join_form;
    this.#join.replaceChildren(form.element);
    this.#join.hidden = false;
    return form;
  }

  /** The server has refused the session. */
  async #show_refusal(server: Server, is_known_member: boolean): Promise<void> {
    const form = await this.#shown_join_form(server);
    if (server.state.phase === "refused") {
      form.take_refusal(server.state, server.is_joining);
      this.say(
        server.is_joining ?
          "" :
          form.sentence(server.state) || (is_known_member ? server.state.message : texts.token_required));
    }
  }

  #refresh(server: Server, tokens: Tokens): void {
    const {phase, message, code} = server.state, is_refused = phase === "refused";
    if (this.#asks) {
      return;
    }
    const wants_token = is_refused && code === "CODE_UNAUTHENTICATED" && !server.is_joining;
    const was_hidden = this.#form.hidden;
    this.#form.hidden = !wants_token;
    this.#again.hidden = !is_refused || wants_token || server.is_joining;
    this.#join.hidden = true;
    if (is_refused && (wants_token || server.is_joining)) {
      void this.#show_refusal(server, tokens.used !== "");
    }
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
