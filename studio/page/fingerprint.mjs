// Records what the built page was made from, so that a test without Node can tell whether it is stale.
// 64-bit FNV-1a over the names and bytes of all sources in the order of their names, line ends as in Unix; studio/tests/fresh.rs computes
// the same.
import { readFileSync, readdirSync, writeFileSync } from "node:fs";
import { join } from "node:path";

const named = ["index.html", "package-lock.json", "package.json", "tsconfig.json", "vite.config.ts"];
const sources = [...named, ...readdirSync("src").map((name) => join("src", name))].map((name) => name.replaceAll("\\", "/")).sort();

let hash = 0xcbf29ce484222325n;
const take = (bytes) => {
  for (const byte of bytes) hash = BigInt.asUintN(64, (hash ^ BigInt(byte)) * 0x100000001b3n);
};
for (const name of sources) {
  take(Buffer.from(`${name}\n`));
  take(Buffer.from(readFileSync(name, "utf8").replaceAll("\r\n", "\n")));
}
writeFileSync("built/sources", `${hash.toString(16).padStart(16, "0")}\n`);
