// Help: the dialog that lists the keys and gestures of the page.
import {app_texts} from "../texts/app";
import {gesture_help, key_help, key_names} from "../texts/help";
import {introduction_texts} from "../texts/introduction";
import {key_texts} from "../texts/keys";
import {Dialog} from "../widgets/controls";
import {h} from "../widgets/dom";

/** A key, or several names of one that are divided by three blanks, and the name of what it does. */
export interface KeyLine {
  keys: string;
  help: keyof typeof key_help;
}

export class Help {
  readonly #dialog = new Dialog(app_texts.help, "help");

  /** panels: titles of those that have a key; introduce: shows the introduction again. */
  constructor(keys: readonly KeyLine[], panels: readonly string[], introduce: () => void) {
    const lines: (readonly[string, string])[] = [
      ...keys.map(({keys: of, help}) => [of, key_help[help]] as const),
      ...panels.map((title, i) => [String(i + 1), key_texts.panel(title)] as const),
      ...gesture_help,
    ];
    const again = (): void => {
      this.#dialog.close();
      introduce();
    };
    this.#dialog.body.append(
      h("button", {type: "button", class: "button", onclick: again}, introduction_texts.again),
      h("dl", {class: "keys"},
        ...lines.map(
          ([of, help]) =>
            h("div", {}, h("dt", {}, ...of.split("   ").map((key) => h("kbd", {}, key_names[key] ?? key))),
              h("dd", {}, help)))));
  }

  toggle(): void {
    if (this.#dialog.is_open) {
      this.#dialog.close();
    } else {
      this.#dialog.open();
    }
  }
}
