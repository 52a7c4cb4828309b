// rows: the rows of a table whose first cell is a button that chooses the row.
import {h, set_text} from "../widgets/dom";

export interface TableRow {
  name: string;
  chosen: boolean;
  act: () => void;
  cells: string[];
}

/** The heading. Columns from `numbers_from` on are numbers. */
export function table_head(texts: readonly string[], numbers_from: number): HTMLElement {
  return h(
    "thead", {},
    h("tr", {}, ...texts.map((text, i) => h("th", {scope: "col", class: i < numbers_from ? null : "number"}, text))));
}

/** Updates the rows. Cells from column `numbers_from` on are numbers. */
export function update_rows(body: HTMLElement, wanted: readonly TableRow[], numbers_from: number): void {
  while (body.children.length > wanted.length) {
    body.lastElementChild!.remove();
  }
  wanted.forEach(({name, chosen, cells, act}, i) => {
    let row = body.children[i] as HTMLElement | undefined;
    if (!row) {
      row =
        h("tr", {}, h("th", {scope: "row"}, h("button", {type: "button", class: "link"})),
          ...cells.map((_, column) => h("td", {class: column >= numbers_from ? "number" : null})));
      body.append(row);
    }
    const button = row.querySelector("button")!;
    set_text(button, name);
    button.onclick = act;
    if (chosen) {
      row.setAttribute("aria-current", "true");
    } else {
      row.removeAttribute("aria-current");
    }
    cells.forEach((cell, column) => set_text(row!.children[column + 1]!, cell));
  });
}
