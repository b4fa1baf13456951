import { readFileSync } from "node:fs";
import { defineConfig } from "vite";

/** The licences of the libraries in the script, which their copies have to hold. */
function notices(): string {
  const of = (name: string) => `${name}: ${readFileSync(`node_modules/${name}/LICENSE`, "utf8").replaceAll("*/", "").trim()}`;
  return `/*!\n${["preact", "uplot"].map(of).join("\n\n")}\n*/`;
}

// One script and one style with fixed names, which the server embeds; no source is split or inlined.
export default defineConfig({
  base: "./",
  oxc: { jsx: { runtime: "automatic", importSource: "preact" } },
  build: {
    outDir: "built",
    emptyOutDir: true,
    modulePreload: false,
    cssCodeSplit: false,
    assetsInlineLimit: 0,
    rollupOptions: {
      output: { entryFileNames: "page.js", assetFileNames: "page[extname]", postBanner: notices(), chunkFileNames: "page-[name].js" },
    },
  },
});
