// Keeps the page for visits without a network. Nothing passes through here but what the page itself is made of;
// scans are never fetched, kept or sent.

// Both are filled in by the build.
const FILES = [/* files */];
const CACHE = "snellius-/* build */";

self.addEventListener("install", (event) => {
  // A new build takes over at once: its files have other names than those of the build before.
  event.waitUntil(
    caches
      .open(CACHE)
      .then((cache) => cache.addAll(["./", ...FILES.filter((file) => file !== "index.html")]))
      .then(() => self.skipWaiting()),
  );
});

self.addEventListener("activate", (event) => {
  const isOld = (name) => name.startsWith("snellius-") && name !== CACHE;
  event.waitUntil(
    caches
      .keys()
      .then((names) => Promise.all(names.filter(isOld).map((name) => caches.delete(name))))
      .then(() => self.clients.claim()),
  );
});

self.addEventListener("fetch", (event) => {
  const { request } = event;
  const address = new URL(request.url);
  const isOurs = request.method === "GET" && address.href.startsWith(self.registration.scope);
  if (!isOurs) return;
  event.respondWith(request.mode === "navigate" ? page(request) : file(request, address));
});

// The newest page there is: the host's, else the one kept.
async function page(request) {
  try {
    return await fetch(request);
  } catch {
    return (await caches.match("./")) ?? Response.error();
  }
}

// Files of the page never change under one name, within a build. Samples and the viewer of one-file pages are kept
// once somebody has asked for them.
async function file(request, address) {
  const kept = await caches.match(request);
  if (kept) return kept;
  const answer = await fetch(request);
  const isKept = address.pathname.includes("/samples/") || /\/viewer\.(html|wasm)$/.test(address.pathname);
  if (answer.ok && isKept) {
    const cache = await caches.open(CACHE);
    await cache.put(request, answer.clone());
  }
  return answer;
}
