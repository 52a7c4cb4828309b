// What a student reads who joins a class.

export const join_texts = {
  title: "Join a class",
  code: "Code",
  code_help: "The six letters that your teacher shows, or the ten letters of your own code.",
  name: "Your name in the class",
  name_help: "Leave it empty and you get one. Do not use your real name.",
  join: "Join",
  no_code: "Type the code that your teacher shows.",
};

/** By the reason of the server. */
export const join_refusals: {readonly [reason: string]: string|undefined} = {
  REASON_CODE_UNKNOWN: "No class has this code now. Check the letters, or ask your teacher for a new code.",
  REASON_MEMBERS_MAX: "The class is full: ask your teacher.",
  REASON_MEMBER_NAME_TAKEN: "Another student has this name already. Choose another one, or leave the field empty.",
  REASON_MEMBER_REMOVED: "Your teacher has removed you from the class. Your teacher can let you in again.",
  REASON_JOINS_TOO_FAST: "Too many codes are being tried at the moment. Wait a few seconds and try again.",
  REASON_SERVER_BUSY: "The server is busy at the moment. Wait a few seconds and try again.",
  REASON_SESSIONS_MAX: "The server has too many visitors at the moment: ask your teacher.",
  REASON_WORLDS_MAX: "The server has no room for another world: ask your teacher.",
  REASON_FIELD_INVALID: "This name is not possible: use at most 24 letters, digits and spaces.",
};
