// node example.mjs scan.zip object.las [las]

import { readFile, writeFile } from "node:fs/promises";

import { reconstruct } from "snellius";

const [scan, output, format = "las"] = process.argv.slice(2);
const reconstruction = await reconstruct(await readFile(scan), {
  onProgress: (done, views) => process.stderr.write(`\r${done} of ${views} views`),
});
const { views, media, warnings } = reconstruction.result;
const measured = views.filter((view) => view.status === "ok").length;
console.log(`\n${measured} of ${views.length} views have an object point; index ${media.inside.value}`);
for (const warning of warnings) console.log(`warning: ${warning}`);
await writeFile(output, reconstruction.write(format));
