// Why the user may not send a request now.
import type * as english from "../texts/access";

export const access_texts: typeof english.access_texts = {
  no_connection: "Es besteht keine Verbindung zum Server.",
  unknown_request: "Der Server kennt diese Anfrage nicht.",
  admin_only: "Nur die Rolle admin darf Welten erzeugen und löschen.",
  read_only: "Verbunden als Zuschauer: Ändern ist nicht erlaubt.",
  watching: "Nur zusehen ist eingestellt. „Mitmachen“ erlaubt Änderungen an Welten.",
  run_not_stored: "Der Lauf dieser Welt ist nicht gespeichert.",
};
