// text: the small Markdown of lessons: paragraphs, lists, emphasis and code. Pure functions.

export interface Span {
  mark: ""|"em"|"strong"|"code";
  text: string;
}

/** A paragraph, or the items of a list. */
export type Block = {
  kind: "paragraph"; spans: Span[]
}|{
  kind: "list";
  items: Span[][]
};

const marked = /\*\*([^*]+)\*\*|\*([^*]+)\*|`([^`]+)`/g;

/** Divides a line at its marks. A mark without an end is text. */
export function spans_of(line: string): Span[] {
  const spans: Span[] = [];
  let end = 0;
  for (const found of line.matchAll(marked)) {
    const [all, strong, em, code] = found, text = strong ?? em ?? code ?? "";
    spans.push({mark: "", text: line.slice(end, found.index!)});
    spans.push({mark: strong !== undefined ? "strong" : em !== undefined ? "em" : "code", text});
    end = found.index! + all.length;
  }
  spans.push({mark: "", text: line.slice(end)});
  return spans.filter(({text}) => text !== "");
}

export function blocks_of(text: string): Block[] {
  const blocks: Block[] = [];
  for (const part of text.split(/\n\s*\n/)) {
    let lines: string[] = [];
    const end_paragraph = (): void => {
      if (lines.length > 0) {
        blocks.push({kind: "paragraph", spans: spans_of(lines.join(" "))});
        lines = [];
      }
    };
    let items: Span[][]|null = null;
    for (const line of part.split("\n").filter((one) => one.trim() !== "")) {
      if (line.startsWith("- ")) {
        end_paragraph();
        if (items === null) {
          items = [];
          blocks.push({kind: "list", items});
        }
        items.push(spans_of(line.slice(2)));
      } else {
        items = null;
        lines.push(line);
      }
    }
    end_paragraph();
  }
  return blocks;
}
