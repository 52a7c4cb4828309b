// storage: what the page remembers in this browser. A browser may forbid it; the page then begins with its defaults.

/** For this tab only: the token, and whether the user takes part. */
export const of_tab = {
  get: (key: string): string => get("sessionStorage", key),
  set: (key: string, value: string): void => set("sessionStorage", key, value)
};

/** For all visits: look, theme and layout. */
export const of_browser = {
  get: (key: string): string => get("localStorage", key),
  set: (key: string, value: string): void => set("localStorage", key, value)
};

type Place = "sessionStorage"|"localStorage";

function get(place: Place, key: string): string {
  try {
    return window[place].getItem("evod." + key) ?? "";
  } catch {
    return "";
  }
}

function set(place: Place, key: string, value: string): void {
  try {
    if (value === "") {
      window[place].removeItem("evod." + key);
    } else {
      window[place].setItem("evod." + key, value);
    }
  } catch {
    // The browser forbids it, or its storage is full.
  }
}
