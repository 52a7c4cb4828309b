// collecting: the archive of a class: the run file of each student's world, and a CSV file with one row per student.
import type {ParameterSet} from "../core/protocol";
import {csv_line} from "../core/csv";
import type {Server} from "../world/server";
import {value_text} from "../world/parameter_values";

import type {Student} from "./class_model";
import {changed_since, type Values, values_of} from "./compare";
import {type ArchivedFile, tar_of} from "./tar";

/** The columns of the CSV file. They are the same in all languages. */
const columns =
  ["name", "world", "run_id", "generation", "fitness_best", "fitness_mean", "changed_parameters", "notes"];

export interface Collected {
  archive: Blob;
  problems: string[]; // what is missing in the archive, as sentences
}

/** Reads the run files one after the other: a session can have one export at a time.
 *
 *  start        the parameters of the template
 *  on_progress  called with the number of students that have been read */
export async function collect(
  server: Server, of_class: string, students: readonly Student[], start: Values|null,
  on_progress: (done: number) => void): Promise<Collected> {
  const files: ArchivedFile[] = [], rows: string[][] = [columns], problems: string[] = [];
  for (const [i, student] of students.entries()) {
    on_progress(i);
    let notes = "";
    const attempt = async(what: () => Promise<void>): Promise<void> => {
      try {
        await what();
      } catch (error) {
        problems.push(`${student.name}: ${(error as Error).message}`);
      }
    };
    await attempt(async () => {
      files.push({name: `${of_class}/${student.world}.evod`, content: await run_file(server, student.world)});
    });
    await attempt(async () => {
      notes = String(await note_count(server, student.world));
    });
    let set: ParameterSet = {};
    await attempt(async () => {
      set = await server.request("get_parameters", {world: student.world});
    });
    rows.push(row_of(student, start, values_of(set), notes));
  }
  on_progress(students.length);
  const table = rows.map((row) => csv_line(row) + "\n").join("");
  files.push({name: `${of_class}/students.csv`, content: new TextEncoder().encode(table)});
  const archive = new Blob(tar_of(files, Date.now() / 1000), {type: "application/x-tar"});
  return {archive, problems};
}

/** One row of the CSV file. Numbers have a decimal point in all languages. */
export function row_of(
  {name, world, info, standing}: Student, start: Values|null, now: Values, notes: string): string[] {
  const number = (value: number): string => Number.isFinite(value) ? String(value) : "";
  const changed = start === null ? [] : changed_since(start, now);
  const text = (parameter: string): string => {
    const {real, count, flag, choice} = now.get(parameter) ?? {};
    return String(real ?? count ?? flag ?? choice ?? value_text({}));
  };
  return [
    plain(name), world, info?.run_id ?? "", String(info?.generation ?? ""), number(standing.best),
    number(standing.mean), changed.map((parameter) => `${parameter}=${text(parameter)}`).join(" "), notes
  ];
}

/** A name that a spreadsheet does not take for a formula. */
function plain(name: string): string {
  return /^[=+\-@\t]/.test(name) ? "'" + name : name;
}

async function run_file(server: Server, world: string): Promise<Uint8Array> {
  return joined(await exported(server, world, "RUN_TABLE_FILE"));
}

/** The number of rows of the table without its head. */
async function note_count(server: Server, world: string): Promise<number> {
  const text = new TextDecoder().decode(joined(await exported(server, world, "RUN_TABLE_NOTES")));
  return text.split("\n").filter((line) => line.trim() !== "").length;
}

async function exported(
  server: Server, world: string, table: "RUN_TABLE_FILE"|"RUN_TABLE_NOTES"): Promise<Uint8Array[]> {
  const parts: Uint8Array[] = [];
  const format = table === "RUN_TABLE_NOTES" ? {format: "TEXT_FORMAT_JSON_LINES" as const} : {};
  let part = await server.request("export_run", {world, table, ...format});
  for (;;) {
    parts.push(part.text ?? new Uint8Array());
    if (part.last) {
      return parts;
    }
    part = await server.request("continue_export", {export_id: part.export_id});
  }
}

function joined(parts: readonly Uint8Array[]): Uint8Array {
  const bytes = new Uint8Array(parts.reduce((sum, part) => sum + part.length, 0));
  let at = 0;
  for (const part of parts) {
    bytes.set(part, at);
    at += part.length;
  }
  return bytes;
}
