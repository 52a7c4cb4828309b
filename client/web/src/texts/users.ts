// Who changed something, and who uses this page.
import type {Actor, Welcome} from "../core/protocol";

/** "anna: evoview 127.0.0.1:51234". */
export function actor_text(by: Actor|undefined): string {
  switch (by?.kind) {
    case "ACTOR_KIND_SCHEDULE":
      return "the schedule";
    case "ACTOR_KIND_GOAL":
      return "a goal";
    case "ACTOR_KIND_SERVER":
      return "evod";
    case "ACTOR_KIND_CLIENT":
    case "ACTOR_KIND_UNSPECIFIED":
    case undefined: {
      const named = [by?.user, by?.client].filter(Boolean).join(": ");
      return named + (by?.address ? ` ${by.address}` : "") || "a local client";
    }
  }
}

/** The user and the role of a session: "vera (viewer)"; only the role if it has no token. */
export function session_text(welcome: Welcome|null): string {
  const role = (welcome?.role ?? "ROLE_VIEWER").replace("ROLE_", "").toLowerCase();
  return welcome?.user ? `${welcome.user} (${role})` : role;
}
