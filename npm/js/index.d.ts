// What the package offers. The types of results and settings are in schema.d.ts, which is made from the
// core's own schemas.

import type { ReconstructionResult, Settings } from "./schema.js";

export type * from "./schema.js";

/** Bytes, or something that has them: a `File`, a `Blob`, a `Response`. */
export type Data = Uint8Array | ArrayBuffer | { arrayBuffer(): Promise<ArrayBuffer> };

export interface Options {
  /** How to measure; what is left out is as the program has it. */
  settings?: Settings;
  /** Called before the first view and after each one. */
  onProgress?: (done: number, views: number) => void;
  /** Ends the work between two views; the promise then rejects with the signal's reason. */
  signal?: AbortSignal;
}

export type Format =
  | "json" | "ply" | "vessel-ply" | "csv" | "object-csv" | "pcd" | "las" | "e57" | "glb" | "stl" | "obj"
  | "html";

export interface Reconstruction {
  /** What `result.json` holds. */
  readonly result: ReconstructionResult;
  /** The bytes of a file, the same that the companion program writes. Throws where the format cannot hold the result. */
  write(format: Format): Uint8Array;
  /** The reconstruction as the fragment of the page's address, without the `#`. Throws if it is too long. */
  link(): string;
  /** Gives its memory back; it is not to be used afterwards. */
  free(): void;
}

/** Measures a scan archive. Rejects with an `Error` that names the place where the archive is at fault. */
export function reconstruct(archive: Data, options?: Options): Promise<Reconstruction>;

/** Opens a `result.json`. */
export function openResult(json: Data | string): Promise<Reconstruction>;

/** Opens a link that carries a reconstruction, or its fragment. */
export function openLink(link: string): Promise<Reconstruction>;

/** The formats there are. */
export function formats(): Promise<Format[]>;

/** The core's version. */
export function version(): Promise<string>;
