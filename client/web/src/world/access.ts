// Access: what the user may send now. It depends on the session, the role, and the replays that this page has opened.
// The page opens watching: until the user takes part, he may send only requests that change nothing for others.
import type {ConnectionState, RequestKind} from "../core/messages";
import type {RequestRules, Role} from "../core/protocol";
import {access_texts} from "../texts/access";
import {of_tab} from "./storage";

/** Requests that change something for other clients. */
const changing_kinds: ReadonlySet<string> =
  new Set(["REQUEST_KIND_COMMAND", "REQUEST_KIND_LEASE", "REQUEST_KIND_SERVER"]);

export class Access {
  rules: ReadonlyMap<RequestKind, RequestRules> = new Map();
  roles: readonly string[] = []; // in rising order
  #taking_part = of_tab.get("take_part") === "yes";
  readonly #state: () => ConnectionState;
  readonly #is_own_replay: (world: string) => boolean;
  readonly #on_change: () => void;

  /** state          of the connection
   *  is_own_replay  whether the world is a replay that this session has opened */
  constructor(state: () => ConnectionState, is_own_replay: (world: string) => boolean, on_change: () => void) {
    this.#state = state;
    this.#is_own_replay = is_own_replay;
    this.#on_change = on_change;
  }

  get role(): Role {
    return this.#state().welcome?.role ?? "ROLE_UNSPECIFIED";
  }

  get taking_part(): boolean {
    return this.#taking_part && this.may_take_part;
  }

  /** Whether the role of the session allows any change. */
  get may_take_part(): boolean {
    return this.role === "ROLE_CONTROLLER" || this.role === "ROLE_ADMIN";
  }

  set_taking_part(taking_part: boolean): void {
    this.#taking_part = taking_part;
    of_tab.set("take_part", taking_part ? "yes" : "");
    this.#on_change();
  }

  /** Whether such requests change something for other clients. */
  changes_others(kind: RequestKind): boolean {
    return changing_kinds.has(this.rules.get(kind)?.kind ?? "");
  }

  /** Why the user may not send this request now, as a sentence; empty if he may. */
  why_not(kind: RequestKind, world?: string): string {
    if (this.#state().phase !== "open") {
      return access_texts.no_connection;
    }
    const rule = this.rules.get(kind);
    if (!rule) {
      return access_texts.unknown_request;
    }
    if (world !== undefined && this.#is_own_replay(world) && rule.viewer_in_own_replay) {
      return "";
    }
    if (this.roles.indexOf(this.role) < this.roles.indexOf(rule.role ?? "ROLE_UNSPECIFIED")) {
      return rule.role === "ROLE_ADMIN" && this.role !== "ROLE_VIEWER" ? access_texts.admin_only :
                                                                         access_texts.read_only;
    }
    return this.changes_others(kind) && !this.taking_part ? access_texts.watching : "";
  }
}
