// The declarations, as a TypeScript program of other people's meets them: checked by `tsc`, never run.

import {
  type Format,
  type Reconstruction,
  type ReconstructionResult,
  formats,
  openLink,
  openResult,
  reconstruct,
  version,
} from "snellius";

const controller = new AbortController();
const reconstruction: Reconstruction = await reconstruct(new Uint8Array(), {
  settings: { index: 1.333, vessel: { shape: "plane" } },
  onProgress: (done: number, views: number) => done / views,
  signal: controller.signal,
});
const result: ReconstructionResult = reconstruction.result;
const index: number | null | undefined = result.media.inside.value;
const first = result.views[0];
if (first?.status === "ok") first.id.toUpperCase();
if (result.vessel.shape === "cylinder") result.vessel.radius.toFixed(2);
const bytes: Uint8Array = reconstruction.write("e57");
const link: string = reconstruction.link();
const again: Reconstruction[] = [await openLink(link), await openResult(bytes), await openResult("{}")];
const names: Format[] = await formats();
const number: string = await version();
again.forEach((one) => one.free());
export { index, names, number };

// What is no use of it is told so.
// @ts-expect-error no such format
reconstruction.write("dxf");
// @ts-expect-error an archive is no number
await reconstruct(7);
// @ts-expect-error an index is a number
await reconstruct(new Uint8Array(), { settings: { index: "1.33" } });
// @ts-expect-error no such result
result.views[0]?.colour;
// @ts-expect-error not every wall has a radius
result.vessel.radius;
