import { readFileSync } from "node:fs";
import { defineConfig } from "vite";

// The licence of three.js asks to go with every copy, and the page holds one.
const kNotice = `<!-- Holds three.js:\n${readFileSync("node_modules/three/LICENSE", "utf8").trim()}\n-->\n`;

// Puts the one script and the one style sheet into the page, so that it is a single file.
function inOneFile() {
  const inline = (bundle, html) => {
    for (const [name, file] of Object.entries(bundle)) {
      if (name.endsWith(".js")) {
        const tag = new RegExp(`<script[^>]*src="[^"]*${file.fileName}"[^>]*></script>`);
        const code = file.code.replaceAll("</script", "<\\/script");
        html = html.replace(tag, "").replace("</body>", () => `<script type="module">${code}</script></body>`);
      } else if (name.endsWith(".css")) {
        const tag = new RegExp(`<link[^>]*href="[^"]*${file.fileName}"[^>]*>`);
        html = html.replace(tag, () => `<style>${file.source}</style>`);
      } else {
        continue;
      }
      delete bundle[name];
    }
    return html;
  };
  return {
    name: "in-one-file",
    enforce: "post",
    generateBundle(_, bundle) {
      const page = bundle["index.html"];
      page.source = inline(bundle, page.source).replace("<head>", () => `<head>\n    ${kNotice}`);
    },
  };
}

// With "npx vite" the page is served as it is edited, and asks a viewer at the usual port.
export default defineConfig({
  base: "./",
  build: { target: "es2022", modulePreload: false, cssCodeSplit: false, assetsInlineLimit: 0 },
  server: {
    proxy: Object.fromEntries(
      ["/scene", "/map", "/plan.png", "/images", "/registration", "/place", "/proposal", "/save", "/live", "/sites", "/maps"].map((path) => [
        path,
        { target: "http://localhost:8017", ws: path === "/live" },
      ]),
    ),
  },
  plugins: [inOneFile()],
});
