// Refusals of the server as sentences.
import type {Reason, Status} from "../core/protocol";
import type * as english from "../texts/refusals";

import {capitalised} from "./numbers";
import {allowed_words, parameter_labels} from "./registry";

const fields: {readonly [field: string]: string|undefined} = {
  world: "Welt",
  name: "Name",
  seed: "Startwert",
  island: "Insel",
  organism: "Organismus",
  generation: "Generation",
  tick: "Tick",
};

const sentences: {readonly[reason in Reason]?: string} = {
  REASON_FIELD_INVALID: "Eine Angabe ist nicht möglich",
  REASON_FIELD_UNKNOWN: "Der Server kennt eine Angabe nicht; vielleicht ist er älter als die Seite",
  REASON_REQUEST_UNKNOWN: "Der Server kennt diese Anfrage nicht; vielleicht ist er älter als die Seite",
  REASON_MESSAGE_UNREADABLE: "Der Server konnte die Anfrage nicht lesen",
  REASON_REQUEST_TOO_OLD: "Die Antwort ist nicht mehr vorhanden; die Änderung kann wirksam sein oder nicht",
  REASON_ROLE_TOO_LOW: "Die Rolle dieser Sitzung erlaubt das nicht",
  REASON_REQUESTS_IN_FLIGHT_MAX: "Zu viele Anfragen zugleich: Auf eine Antwort warten",
  REASON_SERVER_BUSY: "Der Server ist beschäftigt: Noch einmal versuchen",
  REASON_SERVER_GOING_AWAY: "Der Server wird beendet",
  REASON_STORAGE_FAILING: "Der Server kann nicht auf seinen Datenträger schreiben: Später noch einmal versuchen",
  REASON_ANSWER_TOO_LARGE: "Die Antwort ist zu groß",
  REASON_WORLD_NOT_FOUND: "Diese Welt gibt es nicht",
  REASON_WORLD_EXISTS: "Eine Welt mit diesem Namen gibt es schon",
  REASON_WORLDS_MAX: "Es gibt schon so viele Welten wie erlaubt: Zuerst eine löschen",
  REASON_WORLD_IS_REPLAY: "Eine Wiedergabe kann nicht geändert werden; eine Abzweigung davon schon",
  REASON_WORLD_IS_LIVE: "Das geht nur in einer Wiedergabe",
  REASON_RUN_ENDED: "Der Lauf ist zu Ende; Zurücksetzen der Welt beginnt ihn neu",
  REASON_NOTHING_TO_RESUME: "Es gibt nichts fortzusetzen",
  REASON_REVISION_CHANGED: "Gleichzeitig hat ein anderes Programm Parameter geändert",
  REASON_PLANNED_CHANGES_MAX: "Es gibt schon so viele geplante Änderungen wie erlaubt: Zuerst eine aufheben",
  REASON_PLANNED_CHANGE_NOT_FOUND: "Diese geplante Änderung gibt es nicht mehr",
  REASON_RESET_IMPOSSIBLE: "Mit diesen Parametern kann der Lauf nicht beginnen",
  REASON_ISLAND_NOT_FOUND: "Diese Insel gibt es nicht",
  REASON_ORGANISM_NOT_FOUND: "Diesen Organismus gibt es nicht",
  REASON_GENERATION_OVER: "Die Generation ist zu Ende; die nächste beginnt mit dem nächsten Tick",
  REASON_GENERATION_CHANGED: "Inzwischen hat eine andere Generation begonnen",
  REASON_NO_BODIES: "In dieser Welt gibt es keine Körper: Die Fitness hängt nur von den Genen ab",
  REASON_PLACED_MAX: "In dieser Generation wurde schon so viel eingesetzt wie erlaubt",
  REASON_FITNESS_NOT_AWAITED: "Die Welt wartet nicht auf diese Fitness",
  REASON_WORLD_DAMAGED: "Die Laufdatei der Welt ist beschädigt",
  REASON_RUNS_NOT_KEPT: "Der Server speichert keine Läufe",
  REASON_MOMENT_NOT_FOUND: "Diesen Moment enthält der Lauf nicht",
  REASON_SEEK_SUPERSEDED: "Ein neuerer Sprung hat diesen ersetzt",
  REASON_REPLAYS_MAX: "Es gibt schon so viele Wiedergaben wie erlaubt: Zuerst eine schließen",
  REASON_EXPORTS_MAX: "Zu viele Ausgaben zugleich: Später noch einmal versuchen",
  REASON_NOT_BRED_YET: "Noch hat sich keine Generation des Laufs fortgepflanzt",
  REASON_MODEL_VERSION_DIFFERS: "Der Lauf wurde mit einer anderen Version des Modells berechnet",
  REASON_RUN_FILE_DAMAGED: "Die Laufdatei ist beschädigt",
  REASON_SUBSCRIPTIONS_MAX: "Es werden schon so viele Inseln gezeigt wie erlaubt",
  REASON_TLS_REQUIRED: "Der Server verlangt eine verschlüsselte Verbindung",
  REASON_TOKEN_MISSING: "Der Server verlangt ein Token",
  REASON_TOKEN_UNKNOWN: "Der Server kennt dieses Token nicht",
  REASON_TOKEN_REVOKED: "Dieses Token gilt nicht mehr",
  REASON_LOGIN_TOO_SOON: "Zu viele Versuche mit falschem Token: Etwas warten",
  REASON_AUTHENTICATION_UNAVAILABLE: "Der Server kann seine Tokens nicht lesen",
  REASON_WORLD_FROZEN: "Die Lehrkraft hat die Klasse angehalten: Bitte warten",
  REASON_OWNER_WORLDS_MAX: "Es gibt schon so viele eigene Welten wie erlaubt: Zuerst eine löschen",
  REASON_CLASS_NOT_FOUND: "Diese Klasse gibt es nicht",
  REASON_CLASS_EXISTS: "Eine Klasse mit diesem Namen gibt es schon",
  REASON_MEMBER_NOT_FOUND: "Dieses Mitglied gibt es nicht",
  REASON_MEMBERS_MAX: "Die Klasse ist voll",
  REASON_CLASSES_MAX: "Es gibt schon so viele Klassen wie erlaubt: Zuerst eine löschen",
  REASON_CODE_UNKNOWN: "Diesen Code hat keine offene Klasse",
  REASON_MEMBER_NAME_TAKEN: "Diesen Namen hat schon jemand",
  REASON_MEMBER_REMOVED: "Die Lehrkraft hat dieses Mitglied aus der Klasse entfernt",
  REASON_JOINS_TOO_FAST: "Zu viele unbekannte Codes: Etwas warten",
  REASON_SESSIONS_MAX: "Der Server hat schon so viele Verbindungen wie erlaubt",
};

export const reason_text: typeof english.reason_text = (reason) => sentences[reason as Reason] ?? "";

function violation_text({field = "", got = "", allowed = ""}: NonNullable<Status["violations"]>[number]): string {
  const name = field.slice(field.lastIndexOf(".") + 1);
  return `${parameter_labels[name] ?? fields[name] ?? name}: ${
    got === "" ? "" : `${allowed_words(got)} ist nicht möglich, `}erlaubt: ${allowed_words(allowed)}`;
}

export const refusal_text: typeof english.refusal_text = ({message = "", reason, violations = []}) => {
  const sentence = reason_text(reason), wrong = violations.map(violation_text).join("; ");
  return sentence === ""              ? capitalised(message.replace("\n  ", ": ").replaceAll("\n  ", "; ")) :
    wrong === ""                      ? sentence :
    reason === "REASON_FIELD_INVALID" ? wrong :
                                        `${sentence}: ${wrong}`;
};
