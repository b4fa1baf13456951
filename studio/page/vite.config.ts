import { defineConfig } from "vite";

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
      output: { entryFileNames: "page.js", assetFileNames: "page[extname]", chunkFileNames: "page-[name].js" },
    },
  },
});
