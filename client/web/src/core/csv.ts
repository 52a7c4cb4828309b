// csv: tables as text, with the quoting of RFC 4180: a cell that contains a comma, a quote or a line break is in
// quotes, and each quote inside it is doubled. Lines end with LF, as in the tables of evod; CRLF is read, too. Pure
// functions.

export interface CsvRecord {
  line: number; // of its beginning, from 1
  cells: string[];
}

/** A place where a text is not CSV. */
export class CsvError {
  constructor(readonly line: number, readonly wrong: "open quote"|"text after quote") {}
}

/** Returns the line of these cells, without its end. */
export function csv_line(cells: readonly(string | number)[]): string {
  return cells.map((cell) => (typeof cell === "number" ? cell : quoted(cell))).join(",");
}

function quoted(cell: string): string {
  return /[",\r\n]/.test(cell) ? `"${cell.replaceAll('"', '""')}"` : cell;
}

/** Returns what separates the cells of a text: a semicolon or tab if its first line contains one and no comma. */
export function separator_of(text: string): string {
  const heading = text.slice(0, end_of_line(text, 0));
  return [",", ";", "\t"].find((separator) => heading.includes(separator)) ?? ",";
}

/** Returns the records of a text one after another, because those of a long text need much memory; ends with an error
 *  if the text is not CSV. Empty lines are skipped, and so are lines with # before the first record, which are
 *  comments. */
export function* csv_records(text: string, separator = ","): Generator<CsvRecord|CsvError, void> {
  let is_first = true;
  let at = text.startsWith("\ufeff") ? 1 : 0;
  for (let line = 1; at < text.length;) {
    const end = end_of_line(text, at);
    const whole = text.slice(at, text[end - 1] === "\r" ? end - 1 : end);
    if (whole === "" || (is_first && whole.startsWith("#"))) {
      at = end + 1;
      ++line;
    } else if (!whole.includes('"')) {
      is_first = false;
      yield {line, cells: whole.split(separator)};
      at = end + 1;
      ++line;
    } else {
      const read = quoted_record(text, at, line, separator);
      if (read instanceof CsvError) {
        yield read;
        return;
      }
      is_first = false;
      yield {line, cells: read.cells};
      at = read.at;
      line = read.line;
    }
  }
}

function end_of_line(text: string, at: number): number {
  const end = text.indexOf("\n", at);
  return end < 0 ? text.length : end;
}

/** Reads a record with quotes that begins at an index. Returns its cells, and where the next record begins. */
function quoted_record(text: string, at: number, line: number, separator: string):
  {cells: string[]; at: number; line: number}|CsvError {
  const cells: string[] = [];
  for (;;) {
    let cell = "";
    if (text[at] === '"') {
      const begun = line;
      for (++at;; ++at) {
        if (at >= text.length) {
          return new CsvError(begun, "open quote");
        }
        if (text[at] === '"' && text[++at] !== '"') {
          break;
        }
        line += text[at] === "\n" ? 1 : 0;
        cell += text[at];
      }
    } else {
      const end = new RegExp(`[${separator}\\r\\n]|$`, "g");
      end.lastIndex = at;
      const to = end.exec(text)!.index;
      cell = text.slice(at, to);
      at = to;
    }
    cells.push(cell);
    if (text[at] === separator) {
      ++at;
      continue;
    }
    at += text[at] === "\r" ? 1 : 0;
    if (at < text.length && text[at] !== "\n") {
      return new CsvError(line, "text after quote");
    }
    return {cells, at: at + 1, line: line + 1};
  }
}
