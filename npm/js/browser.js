import { makeApi } from "./core.js";

export const { reconstruct, openResult, openLink, formats, version } = makeApi(
  () => new URL("./wasm/snellius_bg.wasm", import.meta.url),
);
