// Tokens: with which token the page connects. The token of a link does not replace one that works until the user
// agrees: otherwise the author of the link would choose under which name the user works.

/** Where the token of this tab is stored. */
export interface TokenStore {
  get(key: "token"): string;
  set(key: "token", token: string): void;
}

export class Tokens {
  used = ""; // of the present or the last session; empty: none
  /** The token of a link while another one works. The user decides. */
  offered: string|null = null;
  #working: string|null =
    null; // the last token with which a session began; null: none did, or the server has refused it since

  readonly #store: TokenStore;

  constructor(store: TokenStore) {
    this.#store = store;
  }

  /** Returns the token with which a new page connects.
   *
   *  linked  the token of the address; null: it contains none */
  begin(linked: string|null): string {
    const stored = this.#store.get("token");
    if (stored === "" || linked === null || linked === stored) {
      return this.use(linked ?? stored);
    }
    this.use(stored);
    this.offered = linked;
    return stored;
  }

  /** Takes the token of a link that the user has followed. Returns the token to connect with; null: the session goes
   *  on. */
  follow(linked: string): string|null {
    const works = this.#working === this.used;
    this.offered = works && linked !== this.used ? linked : null;
    return works ? null : this.use(linked);
  }

  /** The page connects with this token. */
  use(token: string): string {
    this.used = token;
    this.offered = null;
    this.#store.set("token", token);
    return token;
  }

  /** The user keeps the present token. */
  decline(): void {
    this.offered = null;
  }

  /** A session has begun. token: the one of a new member of a class; empty: the session needs no other one. */
  opened(token = ""): void {
    if (token !== "") {
      this.use(token);
    }
    this.#working = this.used;
  }

  /** The server does not accept the token. Returns the token to connect with; null: the user has to enter one. */
  refused(): string|null {
    if (this.#working === this.used) {
      this.#working = null;
    }
    const other = this.offered ?? this.#working;
    if (other !== null) {
      return this.use(other);
    }
    this.#store.set("token", "");
    return null;
  }
}
