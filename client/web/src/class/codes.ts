// codes: the codes with which students join a class, as text and as links. Pure functions.

const personal_letters = 10; // the code of a class has six

/** The letters that a user has typed: "ktr-mxb" → "KTRMXB". */
export function letters_of(typed: string): string {
  return typed.toUpperCase().replace(/[\s-]/g, "");
}

/** Whether it is the code of one member, who needs no name. */
export function is_personal(code: string): boolean {
  return code.length >= personal_letters;
}

/** page: the address of the page without a fragment. */
export function join_link(page: string, code: string): string {
  return `${page}#join=${code}`;
}

/** A code in groups of letters that are easy to read: "KTR MXB". */
export function spaced(code: string): string {
  return is_personal(code) ? code.replace(/(.{5})(?=.)/g, "$1 ") : code.replace(/(.{3})(?=.)/g, "$1 ");
}
