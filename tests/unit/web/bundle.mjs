// Support of the tests of the page's modules without DOM: bundles modules of client/web/src into one.
import { execFileSync } from "node:child_process";
import { mkdtempSync, readdirSync, rmSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";

const sources = path.resolve(path.dirname(fileURLToPath(import.meta.url)), "../../../client/web/src");
const made = mkdtempSync(path.join(tmpdir(), "evod-web-"));
process.on("exit", () => rmSync(made, { recursive: true }));

/** Returns the exports of modules below client/web/src.
 *
 *  modules  "world/link", or "breeding": all modules of the folder */
export async function bundle(...modules) {
  return bundle_of(sources, modules);
}

/** As bundle(), with the German texts. */
export async function german_bundle(...modules) {
  const copy = path.join(made, "german");
  execFileSync(path.join(sources, "../language_sources"), ["de", copy]);
  return bundle_of(path.join(copy, "client/web/src"), modules);
}

function bundle_of(folder, modules) {
  const files = modules.flatMap((module) => module.includes("/") ? [module]
    : readdirSync(path.join(folder, module)).map((file) => `${module}/${file.replace(/\.ts$/, "")}`));
  const out = path.join(made, `${folder === sources ? "" : "german."}${modules.join("+").replaceAll("/", ".")}.mjs`);
  execFileSync("esbuild", ["--bundle", "--format=esm", "--loader=ts", "--loader:.glsl=text", "--log-level=warning", `--outfile=${out}`],
    { cwd: folder, input: files.map((file) => `export * from "./${file}";\n`).join("") });
  return import(out);
}
