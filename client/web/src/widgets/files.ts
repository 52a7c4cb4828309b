// files: files that the user saves from the page, and files that the user opens or drops.
import {h} from "./dom";

const revoked_after_ms = 10_000; // the browser has begun to save by then

/** Lets the browser save a file. */
export function save_file(content: Blob, name: string): void {
  const url = URL.createObjectURL(content);
  h("a", {href: url, download: name}).click();
  setTimeout(() => URL.revokeObjectURL(url), revoked_after_ms);
}

/** A button that lets the user choose files, with the invisible field that it needs.
 *
 *  accept  as in <input type=file>: ".csv,text/csv" */
export function open_button(
  label: string, accept: string, multiple: boolean, act: (files: File[]) => void): [HTMLButtonElement, HTMLElement] {
  const field = h("input", {
                  type: "file",
                  accept,
                  multiple,
                  class: "visually-hidden",
                  tabindex: -1,
                  "aria-label": label,
                  onchange: () => {
                    const files = [...field.files ?? []];
                    field.value = ""; // so that the same file can be chosen again
                    act(files);
                  }
                }) as HTMLInputElement;
  return [h("button", {type: "button", class: "button", onclick: () => field.click()}, label), field];
}

/** Calls `act` with the files that the user drops on an element. */
export function accept_drops(element: HTMLElement, act: (files: File[]) => void): void {
  const has_files = (event: DragEvent): boolean => event.dataTransfer?.types.includes("Files") ?? false;
  element.addEventListener("dragover", (event) => {
    if (has_files(event)) {
      event.preventDefault();
    }
  });
  element.addEventListener("drop", (event) => {
    if (has_files(event)) {
      event.preventDefault();
      act([...event.dataTransfer!.files]);
    }
  });
}
