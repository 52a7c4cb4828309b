// Why the user may not send a request now.
import type * as english from "../texts/access";

export const access_texts: typeof english.access_texts = {
  no_connection: "Es besteht keine Verbindung zum Server.",
  unknown_request: "Der Server kennt diese Anfrage nicht.",
  admin_only: "Nur die Rolle admin darf Welten erzeugen und löschen.",
  read_only: "Verbunden als Zuschauer: Ändern ist nicht erlaubt.",
  own_worlds: "Ändern kannst du nur deine eigenen Welten.",
  own_classes: "Lehrkräfte können nur die Welten ihrer Klassen ändern.",
  frozen: "Deine Lehrkraft hat die Klasse angehalten.",
  first_world: "Das ist deine erste Welt: Sie lässt sich nicht löschen.",
  watching: "Nur zusehen ist eingestellt. „Mitmachen“ erlaubt Änderungen an Welten.",
  run_not_stored: "Der Lauf dieser Welt ist nicht gespeichert.",
};
