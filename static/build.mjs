// Builds the dashboard: src/ → dist/ with hashed names, index.html, and the licences of what was
// bundled.

import { createHash } from "node:crypto";
import { mkdirSync, readdirSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { dirname, join, relative } from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "esbuild";

const here = dirname(fileURLToPath(import.meta.url));
const dist = join(here, "dist");

/** Folders of the packages that ended up in the bundle. */
function bundledPackages(metafile) {
  const folders = new Set();
  for (const input of Object.keys(metafile.inputs)) {
    const match = /^(.*node_modules\/(?:@[^/]+\/)?[^/]+)\//.exec(input);
    if (match) folders.add(match[1]);
  }
  return [...folders].sort();
}

function licenceText(folder) {
  const files = readdirSync(folder, { withFileTypes: true })
    .filter((entry) => /^(licen[cs]e|notice|copying)/i.test(entry.name))
    .sort((a, b) => (a.name < b.name ? -1 : 1))
    .flatMap((entry) =>
      entry.isDirectory()
        ? readdirSync(join(folder, entry.name)).map((name) => join(entry.name, name))
        : [entry.name],
    );
  return files.map((name) => readFileSync(join(folder, name), "utf8").trim()).join("\n\n");
}

function licences(metafile) {
  return bundledPackages(metafile)
    .map((path) => {
      const folder = join(here, path);
      const about = JSON.parse(readFileSync(join(folder, "package.json"), "utf8"));
      const text = licenceText(folder) || "(the package carries no licence file)";
      return `${about.name} ${about.version} · ${about.license}\n${"-".repeat(72)}\n${text}\n`;
    })
    .join("\n\n");
}

function page(script, style) {
  return `<!doctype html>
<html lang="en">
  <head>
    <meta charset="utf-8">
    <meta name="viewport" content="width=device-width, initial-scale=1">
    <meta name="color-scheme" content="light dark">
    <title>trackloom</title>
    <link rel="icon" href="/assets/${icon()}" type="image/svg+xml">
    <link rel="stylesheet" href="/${style}">
    <script type="module" src="/${script}"></script>
  </head>
  <body>
    <div id="app"></div>
    <noscript>
      <p>
        The dashboard needs JavaScript. The same data is at <a href="/v1/jobs">/v1/jobs</a>; the
        API is described at <a href="/docs">/docs</a>.
      </p>
    </noscript>
  </body>
</html>
`;
}

function icon() {
  const bytes = readFileSync(join(here, "src/icon.svg"));
  const digest = createHash("sha256").update(bytes).digest("hex");
  const name = `icon-${digest.slice(0, 8).toUpperCase()}.svg`;
  writeFileSync(join(dist, "assets", name), bytes);
  return name;
}

function output(metafile, entry, ending) {
  const found = Object.entries(metafile.outputs).find(
    ([path, about]) => about.entryPoint === entry && path.endsWith(ending),
  );
  if (!found) throw new Error(`no ${ending} came out of ${entry}`);
  return relative("dist", found[0]);
}

/** What an upload may say of its file, with the parts that it is made of: a schema of its own. */
function uploadSchema() {
  const { schemas } = JSON.parse(
    readFileSync(join(here, "../openapi/openapi.json"), "utf8"),
  ).components;
  const parts = {};
  const add = (schema) => {
    for (const [, name] of JSON.stringify(schema).matchAll(/"#\/components\/schemas\/(\w+)"/g)) {
      if (name in parts) continue;
      parts[name] = schemas[name];
      add(schemas[name]);
    }
  };
  add(schemas.DatasetMeta);
  return { ...schemas.DatasetMeta, $defs: parts };
}

/** The page of one job as a file: script and style stand in it, and it may load nothing. */
async function reportPage() {
  const { outputFiles } = await build({
    ...shared,
    entryPoints: ["src/report/main.tsx", "src/report/report.css"],
    format: "iife",
    // The chart library is for charts that this page has not.
    external: ["*/twin"],
    write: false,
    metafile: false,
    define: { ...CONSTANTS, STREAM_WORKER: '""', UPLOAD_SCHEMA: "{}" },
  });
  const text = (ending) => outputFiles.find(({ path }) => path.endsWith(ending)).text;
  const script = text(".js").replaceAll("</script", "<\\/script");
  const digest = createHash("sha256").update(script).digest("base64");
  const sources = "style-src 'unsafe-inline'; img-src data: blob:";
  const policy = `default-src 'none'; script-src 'sha256-${digest}'; ${sources}`;
  return `<!doctype html>
<html lang="en">
  <head>
    <meta charset="utf-8">
    <meta http-equiv="Content-Security-Policy" content="${policy}">
    <meta name="viewport" content="width=device-width, initial-scale=1">
    <meta name="color-scheme" content="light dark">
    <title>trackloom report</title>
    <style>${text(".css")}</style>
  </head>
  <body>
    <div id="app"></div>
    <noscript>The page draws its tables and pictures with the script that it carries.</noscript>
    <script type="application/json" id="data"><!--DATA--></script>
    <script>${script}</script>
  </body>
</html>
`;
}

rmSync(dist, { recursive: true, force: true });
mkdirSync(join(dist, "assets"), { recursive: true });
const CONSTANTS = { "process.env.NODE_ENV": '"production"' };
const shared = {
  absWorkingDir: here,
  bundle: true,
  target: ["es2022"],
  minify: true,
  outdir: "dist/assets",
  entryNames: "[name]-[hash]",
  metafile: true,
  legalComments: "none",
  logLevel: "warning",
};
// A script of its own, whose name the page has to know.
const worker = await build({
  ...shared,
  entryPoints: ["src/state/stream-worker.ts"],
  format: "iife",
});
const workerPath = `/${output(worker.metafile, "src/state/stream-worker.ts", ".js")}`;
const { metafile } = await build({
  ...shared,
  entryPoints: ["src/main.tsx", "src/styles/main.css"],
  splitting: true,
  format: "esm",
  chunkNames: "[name]-[hash]",
  define: {
    ...CONSTANTS,
    STREAM_WORKER: JSON.stringify(workerPath),
    UPLOAD_SCHEMA: JSON.stringify(uploadSchema()),
  },
});
writeFileSync(
  join(dist, "index.html"),
  page(output(metafile, "src/main.tsx", ".js"), output(metafile, "src/styles/main.css", ".css")),
);
writeFileSync(join(dist, "licenses.txt"), licences(metafile));
writeFileSync(join(dist, "report.html"), await reportPage());
