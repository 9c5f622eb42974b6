// The package as a program of other people's uses it, in Node: `node --test` with SNELLIUS_CLI (the companion
// program) and the package installed in node_modules.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtempSync, readFileSync } from "node:fs";
import { tmpdir } from "node:os";
import { join } from "node:path";
import test from "node:test";

import { formats, openLink, openResult, reconstruct, version } from "snellius";

const { SNELLIUS_CLI, SNELLIUS_SAMPLE } = process.env;
const sample = readFileSync(SNELLIUS_SAMPLE);

test("a scan is measured to the companion program's bytes in every format", async () => {
  const folder = mkdtempSync(join(tmpdir(), "snellius-npm-"));
  const names = await formats();
  execFileSync(SNELLIUS_CLI, ["reconstruct", SNELLIUS_SAMPLE, "-o", folder, "-f", names.join(",")], { stdio: "ignore" });
  const files = {
    json: "result.json", ply: "object.ply", "vessel-ply": "vessel.ply", csv: "points.csv", "object-csv": "object.csv",
    pcd: "object.pcd", las: "object.las", e57: "object.e57", glb: "scene.glb", stl: "surface.stl", obj: "surface.obj",
    html: "report.html",
  };
  assert.deepEqual(names, Object.keys(files));
  const reconstruction = await reconstruct(sample);
  for (const [format, file] of Object.entries(files)) {
    assert.ok(readFileSync(join(folder, file)).equals(reconstruction.write(format)), `${file} differs`);
  }
  const json = JSON.parse(readFileSync(join(folder, "result.json")));
  assert.deepEqual(reconstruction.result, json, "the object is what the file says");
  const again = await openResult(readFileSync(join(folder, "result.json")));
  assert.deepEqual(again.result, json);
});

test("progress counts the views, and a Blob will do", async () => {
  const told = [];
  const { result } = await reconstruct(new Blob([sample]), { onProgress: (...step) => told.push(step) });
  const views = result.views.length;
  assert.deepEqual(told, Array.from({ length: views + 1 }, (_, done) => [done, views]));
});

test("settings reach the core", async () => {
  const { result } = await reconstruct(sample, { settings: { index: 1.4, vessel: { outlier: 6 } } });
  assert.equal(result.media.inside.value, 1.4);
  await assert.rejects(reconstruct(sample, { settings: { index: "water" } }), /f64|number|invalid type/);
});

test("a signal ends the work between two views", async () => {
  const controller = new AbortController();
  let last = 0;
  const running = reconstruct(sample, {
    signal: controller.signal,
    onProgress: (done) => {
      last = done;
      if (done === 3) controller.abort(new Error("enough"));
    },
  });
  await assert.rejects(running, /enough/);
  assert.equal(last, 3);
  await assert.rejects(reconstruct(sample, { signal: AbortSignal.abort() }), { name: "AbortError" });
});

test("what is at fault is said", async () => {
  await assert.rejects(reconstruct(new Uint8Array([1, 2, 3])), Error);
  await assert.rejects(openResult("{}"), /format/);
  await assert.rejects(openLink("https://example.org/#r2=AAAA"), /version 2/);
  const reconstruction = await reconstruct(sample);
  assert.throws(() => reconstruction.write("docx"), /docx.*vessel-ply/);
  assert.match(await version(), /^\d+\.\d+\.\d+/);
});

test("a link carries a reconstruction", async () => {
  const reconstruction = await reconstruct(sample, { settings: { index: 1.35 } });
  const link = reconstruction.link();
  assert.ok(link.length < 2041);
  const opened = await openLink(`https://example.org/snellius/#${link}`);
  assert.equal(opened.result.media.inside.value, 1.35);
  assert.equal(opened.result.views.length, reconstruction.result.views.length);
  opened.free();
});
