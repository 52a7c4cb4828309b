// lesson_link: the lesson that the fragment of the address names: "#world=default&lesson=drift".

const field = "lesson";

/** The name of a lesson; empty: none. */
export function lesson_in(hash: string): string {
  return new URLSearchParams(hash.replace(/^#/, "")).get(field) ?? "";
}

/** A link with a lesson. Empty: the link is empty, or names none. */
export function with_lesson(link: string, lesson: string): string {
  return link === "" || lesson === "" ?
    link :
    `${link}${link.includes("#") ? "&" : "#"}${field}=${encodeURIComponent(lesson)}`;
}

/** The lesson of this tab; empty: none. */
export function chosen_lesson(): string {
  return lesson_in(location.hash);
}

/** Sets the lesson in the address of this tab; empty: removes it. */
export function choose_lesson(lesson: string): void {
  const fields = location.hash.slice(1).split("&").filter((one) => one !== "" && !one.startsWith(`${field}=`));
  const rest = fields.length > 0 ? `#${fields.join("&")}` : "";
  history.replaceState(null, "", with_lesson(location.pathname + location.search + rest, lesson));
}
