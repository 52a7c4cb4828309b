// Who changed something, and who uses this page.
import type * as english from "../texts/users";

export const actor_text: typeof english.actor_text = (by) => {
  switch (by?.kind) {
    case "ACTOR_KIND_SCHEDULE":
      return "dem Zeitplan";
    case "ACTOR_KIND_GOAL":
      return "einem Ziel";
    case "ACTOR_KIND_SERVER":
      return "evod";
    case "ACTOR_KIND_CLIENT":
    case "ACTOR_KIND_UNSPECIFIED":
    case undefined: {
      const named = [by?.user, by?.client].filter(Boolean).join(": ");
      return named + (by?.address ? ` ${by.address}` : "") || "einem Programm auf dem Server";
    }
  }
};

const roles: {readonly [role: string]: string|undefined} = {
  ROLE_VIEWER: "Zuschauer",
  ROLE_CONTROLLER: "Steuerung",
  ROLE_ADMIN: "Verwaltung"
};

export const session_text: typeof english.session_text = (welcome) => {
  const role = roles[welcome?.role ?? "ROLE_VIEWER"] ?? "";
  return welcome?.user ? `${welcome.user} (${role})` : role;
};
