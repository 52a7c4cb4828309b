// LazyPanel: a panel whose code is loaded when it is first shown, so that the page itself loads faster.
import {panels_texts} from "../texts/panels";
import {h} from "../widgets/dom";
import type {Panel} from "../world/panel_context";

export class LazyPanel implements Panel {
  readonly element = h("div", {class: "lazy-panel"});
  #panel: Panel|null = null;
  #loading = false;
  #subject: {[key: string]: unknown}|null = null; // of a show() before the code was loaded

  constructor(readonly name: string, readonly title: string, readonly load: () => Promise<Panel>) {}

  refresh(): void {
    if (this.#panel) {
      this.#panel.refresh();
    } else if (!this.#loading) {
      this.#loading = true;
      this.element.textContent = panels_texts.loading;
      this.load().then((panel) => this.#show_loaded(panel), (error) => {
        this.#loading = false; // the next refresh() tries again
        this.element.textContent = panels_texts.not_loaded(error instanceof Error ? error.message : String(error));
      });
    }
  }

  show(subject: {[key: string]: unknown}): void {
    if (this.#panel) {
      this.#panel.show?.(subject);
    } else {
      this.#subject = subject;
    }
  }

  #show_loaded(panel: Panel): void {
    this.#panel = panel;
    this.element.replaceChildren(panel.element);
    panel.refresh();
    if (this.#subject) {
      panel.show?.(this.#subject);
    }
  }
}
