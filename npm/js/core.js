// The package's functions. `browser.js` and `node.js` differ only in where they take the WebAssembly from.

import init, { Reconstruction, Scan, formats as formatNames, version as coreVersion } from "./wasm/snellius.js";

let loaded;

/** Loads the WebAssembly once; `source` gives it, or the promise of it. */
export const loadFrom = (source) => (loaded ??= init({ module_or_path: source() }));

export function makeApi(source) {
  const ready = () => loadFrom(source);

  async function reconstruct(archive, { settings, onProgress, signal } = {}) {
    signal?.throwIfAborted();
    const [bytes] = await Promise.all([bytesOf(archive), ready()]);
    const scan = new Scan(bytes, settings);
    try {
      onProgress?.(0, scan.views);
      for (let done = 0; done < scan.views; done += 1) {
        await turn();
        signal?.throwIfAborted();
        scan.observeNext();
        onProgress?.(done + 1, scan.views);
      }
      await turn();
      signal?.throwIfAborted();
      return published(scan.measure());
    } finally {
      scan.free();
    }
  }

  async function openResult(json) {
    const [bytes] = await Promise.all([bytesOf(json), ready()]);
    return published(Reconstruction.fromJson(bytes));
  }

  async function openLink(link) {
    await ready();
    return published(Reconstruction.fromLink(link.slice(link.indexOf("#") + 1)));
  }

  const formats = async () => (await ready(), formatNames());
  const version = async () => (await ready(), coreVersion());
  return { reconstruct, openResult, openLink, formats, version };
}

function published(reconstruction) {
  return {
    result: reconstruction.result(),
    write: (format) => reconstruction.write(format),
    link: () => reconstruction.link(),
    free: () => reconstruction.free(),
  };
}

async function bytesOf(data) {
  if (typeof data === "string") return new TextEncoder().encode(data);
  if (data instanceof Uint8Array) return data;
  if (data instanceof ArrayBuffer) return new Uint8Array(data);
  return new Uint8Array(await data.arrayBuffer());
}

/** Lets the program do something else: draw, hear a click on Cancel. */
const turn = () => new Promise((resume) => setTimeout(resume));
