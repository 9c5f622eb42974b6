import { readFile } from "node:fs/promises";

import { makeApi } from "./core.js";

export const { reconstruct, openResult, openLink, formats, version } = makeApi(
  () => readFile(new URL("./wasm/snellius_bg.wasm", import.meta.url)),
);
