// copy: puts a text on the clipboard, also on pages without TLS, for which browsers offer no clipboard to scripts.
import {Dialog} from "./controls";
import {h} from "./dom";

/** Returns whether the text is on the clipboard; if not, a dialog shows it. */
export async function copy_text(text: string, title: string): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    // There is no clipboard, or the browser forbids it.
  }
  const focused = document.activeElement, field = h("textarea", {class: "visually-hidden", readonly: true});
  field.value = text;
  document.body.append(field);
  field.select();
  const copied = document.execCommand("copy");
  field.remove();
  if (focused instanceof HTMLElement) {
    focused.focus();
  }
  if (!copied) {
    show(text, title);
  }
  return copied;
}

function show(text: string, title: string): void {
  const dialog = new Dialog(title);
  const field = h("input", {class: "field copied", readonly: true, value: text, "aria-label": title});
  dialog.body.append(field);
  dialog.element.addEventListener("close", () => dialog.element.remove());
  dialog.open();
  field.select();
}
