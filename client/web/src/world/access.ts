// Access: what the user may send now. It depends on the session, the role, and the replays that this page has opened.
// The page opens watching: until the user takes part, he may send only requests that change nothing for others. A
// member of a class takes part from the start: he changes only his own worlds.
import type {ConnectionState, RequestKind} from "../core/messages";
import type {Membership, RequestRules, Role, WorldInfo} from "../core/protocol";
import {access_texts} from "../texts/access";
import {of_tab} from "./storage";

/** Requests that change something for other clients. */
const changing_kinds: ReadonlySet<string> =
  new Set(["REQUEST_KIND_COMMAND", "REQUEST_KIND_LEASE", "REQUEST_KIND_SERVER"]);

interface KnownWorlds {
  find(name: string): WorldInfo|null;
  /** Whether the world is a replay that this session has opened. */
  is_own_replay(name: string): boolean;
}

export class Access {
  rules: ReadonlyMap<RequestKind, RequestRules> = new Map();
  roles: readonly string[] = []; // in rising order
  #taking_part = of_tab.get("take_part") === "yes";
  readonly #state: () => ConnectionState;
  /** The classes of this teacher, by name. */
  classes: ReadonlySet<string> = new Set();
  readonly #worlds: KnownWorlds;
  readonly #on_change: () => void;

  /** state  of the connection */
  constructor(state: () => ConnectionState, worlds: KnownWorlds, on_change: () => void) {
    this.#state = state;
    this.#worlds = worlds;
    this.#on_change = on_change;
  }

  /** The class in which the user is a member; null: none. */
  get membership(): Membership|null {
    return this.#state().welcome?.membership ?? null;
  }

  /** Whether the user may create classes. */
  get may_teach(): boolean {
    return this.#why_not_role("ROLE_TEACHER") === "";
  }

  get role(): Role {
    return this.#state().welcome?.role ?? "ROLE_UNSPECIFIED";
  }

  get taking_part(): boolean {
    return this.may_take_part && (this.#taking_part || this.membership !== null);
  }

  /** Whether the user may change any world. */
  get may_take_part(): boolean {
    return this.membership !== null || this.may_teach;
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

  /** Why the user may not send this request now, as a sentence; empty if he may. world: the one that it names */
  why_not(kind: RequestKind, world?: string): string {
    if (this.#state().phase !== "open") {
      return access_texts.no_connection;
    }
    const rule = this.rules.get(kind);
    if (!rule) {
      return access_texts.unknown_request;
    }
    if (world !== undefined && this.#worlds.is_own_replay(world) && rule.viewer_in_own_replay) {
      return "";
    }
    const of_world = world === undefined ? null : this.#owned(world);
    const why = this.#why_not_role(rule.role ?? "ROLE_UNSPECIFIED");
    if (why !== "" && !(rule.by_owner && of_world && this.#owns(of_world))) {
      return why;
    }
    const changes = this.changes_others(kind);
    return changes && !this.taking_part                           ? access_texts.watching :
      changes && of_world?.frozen && this.membership !== null     ? access_texts.frozen :
      kind === "delete_world" && world === this.membership?.world ? access_texts.first_world :
                                                                    "";
  }

  #why_not_role(needed: Role): string {
    return this.roles.indexOf(this.role) >= this.roles.indexOf(needed) ? "" :
      this.membership !== null                                         ? access_texts.own_worlds :
      needed === "ROLE_ADMIN" && this.role === "ROLE_CONTROLLER"       ? access_texts.admin_only :
      this.role === "ROLE_TEACHER"                                     ? access_texts.own_classes :
                                                                         access_texts.read_only;
  }

  /** Whether the user owns the world, or is the teacher of its class. */
  #owns({owner = "", class: of_class = ""}: WorldInfo): boolean {
    return (owner !== "" && owner === this.#state().welcome?.user) || this.classes.has(of_class);
  }

  /** The world to which a world or a replay of it belongs. */
  #owned(name: string): WorldInfo|null {
    const world = this.#worlds.find(name), origin = world?.replay?.replay_of;
    return origin === undefined || world?.owner ? world : this.#worlds.find(origin);
  }
}
