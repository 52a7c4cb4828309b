// run_export: reads a table of a run from the server, line by line.
//
// The server sends the table in parts. A part may end within a line, and within a character. A session can have one
// export at a time. An export that is not read to its end ends after Limits.export_patience_s, or when the next begins.
import type {ExportRun} from "../core/protocol";
import type {Server} from "./server";

/** What was read. */
export interface ReadExport {
  bytes: number;
  generations_left_out: number; // the run file does not contain their organisms
}

/** Calls `take` with the lines of each part, without empty ones, until the table is complete or `is_enough` returns
 *  true. */
export async function read_export(
  server: Server, wanted: ExportRun, take: (lines: string[]) => void,
  is_enough: () => boolean = () => false): Promise<ReadExport> {
  const decoder = new TextDecoder(), read: ReadExport = {bytes: 0, generations_left_out: 0};
  let part = await server.request("export_run", wanted), rest = "";
  for (;;) {
    const {text = new Uint8Array(), last = false, generations_left_out = 0} = part;
    const lines = (rest + decoder.decode(text, {stream: !last})).split("\n");
    rest = last ? "" : lines.pop()!;
    read.bytes += text.length;
    read.generations_left_out = Math.max(read.generations_left_out, generations_left_out);
    take(lines.filter((line) => line !== ""));
    if (last || is_enough()) {
      return read;
    }
    part = await server.request("continue_export", {export_id: part.export_id});
  }
}
