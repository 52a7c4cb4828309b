// What a student reads who joins a class.
import type * as english from "../texts/join";

export const join_texts: typeof english.join_texts = {
  title: "Einer Klasse beitreten",
  code: "Code",
  code_help: "Die sechs Buchstaben, die deine Lehrkraft zeigt, oder die zehn Buchstaben deines eigenen Codes.",
  name: "Dein Name in der Klasse",
  name_help: "Lass das Feld leer, dann bekommst du einen. Nimm nicht deinen echten Namen.",
  join: "Beitreten",
  no_code: "Gib den Code ein, den deine Lehrkraft zeigt.",
};

export const join_refusals: typeof english.join_refusals = {
  REASON_CODE_UNKNOWN:
    "Diesen Code hat gerade keine Klasse. Prüfe die Buchstaben, oder bitte deine Lehrkraft um einen neuen Code.",
  REASON_MEMBERS_MAX: "Die Klasse ist voll. Sag es deiner Lehrkraft.",
  REASON_MEMBER_NAME_TAKEN: "Diesen Namen hat schon jemand. Wähle einen anderen, oder lass das Feld leer.",
  REASON_MEMBER_REMOVED: "Deine Lehrkraft hat dich aus der Klasse entfernt. Sie kann dich wieder hereinlassen.",
  REASON_JOINS_TOO_FAST: "Gerade werden zu viele Codes probiert. Warte ein paar Sekunden und versuche es noch einmal.",
  REASON_SERVER_BUSY: "Der Server ist gerade beschäftigt. Warte ein paar Sekunden und versuche es noch einmal.",
  REASON_SESSIONS_MAX: "Der Server hat gerade zu viele Besucher. Sag es deiner Lehrkraft.",
  REASON_WORLDS_MAX: "Der Server hat keinen Platz für eine weitere Welt. Sag es deiner Lehrkraft.",
  REASON_FIELD_INVALID: "Dieser Name ist nicht möglich: höchstens 24 Buchstaben, Ziffern und Leerzeichen.",
};
