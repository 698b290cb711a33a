import { defineConfig } from "vite";

export default defineConfig({
  base: "/",
  build: {
    outDir: "../bundle",
    emptyOutDir: true,
    rollupOptions: { input: { index: "index.html", researcher: "researcher.html" } },
  },
});
