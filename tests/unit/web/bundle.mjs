// Support of the tests of the page's modules without DOM: bundles modules of a folder of client/web/src into one.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";

const sources = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../../../client/web/src");
const made = mkdtempSync(path.join(tmpdir(), "evod-web-"));
process.on("exit", () => rmSync(made, { recursive: true }));

/** Returns the exports of the modules in a folder: "breeding".
 *
 *  names  "plot_layout"; absent: all modules of the folder */
export async function bundle(folder, names) {
  const cwd = path.join(sources, folder);
  const input = (names ?? readdirSync(cwd).map((file) => file.replace(/\.ts$/, "")))
    .map((name) => `export * from "./${name}";\n`).join("");
  execFileSync("esbuild", ["--bundle", "--format=esm", "--loader=ts", "--loader:.glsl=text", "--log-level=warning",
    `--outfile=${made}/${folder}.mjs`], { cwd, input });
  return import(`${made}/${folder}.mjs`);
}
