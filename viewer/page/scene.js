"use strict";

/** Four by four matrices, column by column, and what a camera needs of them. */
const matrix = {
  times(a, b) {
    const product = new Float32Array(16);
    for (let column = 0; column < 4; column++)
      for (let row = 0; row < 4; row++)
        for (let k = 0; k < 4; k++) product[4 * column + row] += a[4 * k + row] * b[4 * column + k];
    return product;
  },
  perspective(aspect, near, far) {
    const f = 1 / Math.tan(Math.PI / 9);
    const depth = near - far;
    return new Float32Array([f / aspect, 0, 0, 0, 0, f, 0, 0, 0, 0, (far + near) / depth, -1, 0, 0, (2 * far * near) / depth, 0]);
  },
  /** The world as seen from `eye`, with the camera's axes right, up and back. */
  view(eye, right, up, back) {
    const t = [right, up, back].map((axis) => -vector.dot(axis, eye));
    return new Float32Array([
      right[0], up[0], back[0], 0, right[1], up[1], back[1], 0, right[2], up[2], back[2], 0, t[0], t[1], t[2], 1,
    ]);
  },
};

const vector = {
  dot: (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2],
  cross: (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]],
  add: (a, b, times = 1) => [0, 1, 2].map((i) => a[i] + times * b[i]),
  scaled: (a, by) => a.map((part) => part * by),
  length: (a) => Math.hypot(...a),
  unit(a, otherwise) {
    const length = Math.hypot(...a);
    return length > 1e-6 ? a.map((part) => part / length) : otherwise;
  },
};

/**
 * The picture in 3-D: what is to be drawn is handed over as flat lists of places and colours; it is drawn when
 * something has changed, and only then.
 */
class Scene {
  /** @param sides up, and towards the rig, three numbers each */
  constructor(canvas, sides) {
    const gl = canvas.getContext("webgl2", { antialias: true, alpha: false });
    if (!gl) throw new Error("no WebGL 2");
    this.canvas = canvas;
    this.gl = gl;
    this.up = vector.unit(sides.slice(0, 3), [0, 1, 0]);
    const back = vector.add(sides.slice(3), this.up, -vector.dot(sides.slice(3), this.up));
    this.front = vector.unit(back, vector.unit(vector.cross(this.up, [0.6, 0, 0.8]), [1, 0, 0]));
    this.side = vector.cross(this.up, this.front);
    this.target = [0, 0, 0];
    this.distance = 500;
    this.size = 100;
    this.look("front");
    this.pointProgram = program(gl, POINT_VERTEX, POINT_FRAGMENT);
    this.plainProgram = program(gl, PLAIN_VERTEX, PLAIN_FRAGMENT);
    this.parts = {};
    this.places = [];
    this.background = [0, 0, 0];
    this.onPick = () => {};
    this.listen();
  }

  /** Sets one of the parts: `kind` is points, lines or triangles; places xyz..., colours rgba... */
  set(name, kind, places, colours, size = 1) {
    const { gl } = this;
    const old = this.parts[name];
    const part = old ?? { place: gl.createBuffer(), colour: gl.createBuffer(), array: gl.createVertexArray() };
    gl.bindVertexArray(part.array);
    for (const [slot, buffer, numbers, count] of [
      [0, part.place, places, 3],
      [1, part.colour, colours, 4],
    ]) {
      gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
      gl.bufferData(gl.ARRAY_BUFFER, new Float32Array(numbers), gl.DYNAMIC_DRAW);
      gl.enableVertexAttribArray(slot);
      gl.vertexAttribPointer(slot, count, gl.FLOAT, false, 0, 0);
    }
    this.parts[name] = Object.assign(part, { kind, size, count: Math.floor(places.length / 3) });
    this.drawSoon();
  }

  /** The places that can be picked, and that are fitted into the picture. */
  setPlaces(places) {
    this.places = places;
  }

  fit(extent) {
    const low = [Infinity, Infinity, Infinity];
    const high = [-Infinity, -Infinity, -Infinity];
    for (const place of extent)
      for (let i = 0; i < 3; i++) {
        if (!Number.isFinite(place[i])) continue;
        low[i] = Math.min(low[i], place[i]);
        high[i] = Math.max(high[i], place[i]);
      }
    if (!Number.isFinite(low[0])) return;
    this.target = [0, 1, 2].map((i) => (low[i] + high[i]) / 2);
    this.size = Math.max(1, Math.hypot(...[0, 1, 2].map((i) => high[i] - low[i])));
    const narrow = Math.min(1, this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight));
    this.distance = (1.5 * this.size) / Math.max(0.3, narrow);
    this.drawSoon();
  }

  look(from) {
    [this.yaw, this.pitch] = { front: [0.75, 0.3], side: [Math.PI / 2, 0.05], above: [0, 1.5] }[from];
    this.drawSoon();
  }

  /** The camera's axes and place. */
  camera() {
    const [s, c] = [Math.sin(this.yaw), Math.cos(this.yaw)];
    const level = vector.add(vector.scaled(this.front, c), this.side, s);
    const back = vector.add(vector.scaled(level, Math.cos(this.pitch)), this.up, Math.sin(this.pitch));
    const right = vector.unit(vector.cross(this.up, back), this.side);
    const up = vector.cross(back, right);
    return { right, up, back, eye: vector.add(this.target, back, this.distance) };
  }

  matrix() {
    const { right, up, back, eye } = this.camera();
    const aspect = this.canvas.clientWidth / Math.max(1, this.canvas.clientHeight);
    const near = Math.max(this.distance - 4 * this.size, this.distance / 100);
    return matrix.times(matrix.perspective(aspect, near, this.distance + 6 * this.size), matrix.view(eye, right, up, back));
  }

  drawSoon() {
    if (this.asked) return;
    this.asked = requestAnimationFrame(() => {
      this.asked = 0;
      this.draw();
    });
  }

  draw() {
    const { gl, canvas } = this;
    const ratio = window.devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight].map((side) => Math.max(1, Math.round(side * ratio)));
    if (canvas.width !== width || canvas.height !== height) Object.assign(canvas, { width, height });
    gl.viewport(0, 0, width, height);
    gl.clearColor(...this.background, 1);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    gl.enable(gl.DEPTH_TEST);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    const seen = this.matrix();
    const kinds = { points: gl.POINTS, lines: gl.LINES, triangles: gl.TRIANGLES };
    // What one sees through comes last and hides nothing.
    for (const name of ["object", "vessel", "light", "marks", "edges", "wall"]) {
      const part = this.parts[name];
      if (!part?.count) continue;
      const used = part.kind === "points" ? this.pointProgram : this.plainProgram;
      gl.useProgram(used);
      gl.uniformMatrix4fv(gl.getUniformLocation(used, "seen"), false, seen);
      if (part.kind === "points") {
        gl.uniform1f(gl.getUniformLocation(used, "size"), part.size * ratio);
        gl.uniform1i(gl.getUniformLocation(used, "ring"), name === "marks" ? 1 : 0);
      }
      gl.depthMask(name !== "wall");
      if (name === "marks") gl.disable(gl.DEPTH_TEST);
      else gl.enable(gl.DEPTH_TEST);
      gl.bindVertexArray(part.array);
      gl.drawArrays(kinds[part.kind], 0, part.count);
    }
    gl.depthMask(true);
  }

  /** Where a place stands on the canvas, CSS px; nothing behind the camera. */
  seenAt(place, seen = this.matrix()) {
    const clip = [0, 1, 2, 3].map((row) => seen[row] * place[0] + seen[4 + row] * place[1] + seen[8 + row] * place[2] + seen[12 + row]);
    if (!(clip[3] > 0)) return undefined;
    return [(clip[0] / clip[3] / 2 + 0.5) * this.canvas.clientWidth, (0.5 - clip[1] / clip[3] / 2) * this.canvas.clientHeight];
  }

  /** The number of the place nearest to a place of the canvas, if one is near. */
  near(x, y) {
    const seen = this.matrix();
    let [best, reach] = [undefined, 14];
    this.places.forEach((place, number) => {
      const at = this.seenAt(place, seen);
      const off = at ? Math.hypot(at[0] - x, at[1] - y) : Infinity;
      if (off < reach) [best, reach] = [number, off];
    });
    return best;
  }

  turn(across, down) {
    this.yaw += across;
    this.pitch = Math.max(-1.55, Math.min(1.55, this.pitch + down));
    this.drawSoon();
  }

  shift(x, y) {
    const { right, up } = this.camera();
    const step = (this.distance * 2 * Math.tan(Math.PI / 9)) / Math.max(1, this.canvas.clientHeight);
    this.target = vector.add(vector.add(this.target, right, -x * step), up, y * step);
    this.drawSoon();
  }

  zoom(factor) {
    this.distance = Math.max(this.size / 200, Math.min(this.size * 50, this.distance * factor));
    this.drawSoon();
  }

  listen() {
    const { canvas } = this;
    const fingers = new Map();
    let way = 0;
    canvas.addEventListener("pointerdown", (event) => {
      canvas.setPointerCapture(event.pointerId);
      fingers.set(event.pointerId, event);
      way = fingers.size > 1 ? Infinity : 0;
    });
    canvas.addEventListener("pointermove", (event) => {
      const before = fingers.get(event.pointerId);
      if (!before) return;
      const [x, y] = [event.clientX - before.clientX, event.clientY - before.clientY];
      way += Math.hypot(x, y);
      const other = [...fingers.values()].find((finger) => finger.pointerId !== event.pointerId);
      fingers.set(event.pointerId, event);
      if (other) {
        const apart = (finger) => Math.hypot(finger.clientX - other.clientX, finger.clientY - other.clientY);
        this.zoom(apart(before) / Math.max(1, apart(event)));
        this.shift(x / 2, y / 2);
      } else if (event.buttons === 2 || event.shiftKey) this.shift(x, y);
      else this.turn(-x / 180, y / 180);
    });
    const end = (event) => {
      if (!fingers.delete(event.pointerId)) return;
      if (event.type === "pointerup" && way < 4) {
        const box = canvas.getBoundingClientRect();
        this.onPick(this.near(event.clientX - box.x, event.clientY - box.y));
      }
    };
    canvas.addEventListener("pointerup", end);
    canvas.addEventListener("pointercancel", end);
    canvas.addEventListener("contextmenu", (event) => event.preventDefault());
    canvas.addEventListener(
      "wheel",
      (event) => {
        event.preventDefault();
        this.zoom(Math.exp(Math.sign(event.deltaY) * Math.min(0.4, Math.abs(event.deltaY) / 600)));
      },
      { passive: false },
    );
    canvas.addEventListener("keydown", (event) => {
      const keys = {
        ArrowLeft: () => this.turn(-0.1, 0),
        ArrowRight: () => this.turn(0.1, 0),
        ArrowUp: () => this.turn(0, 0.1),
        ArrowDown: () => this.turn(0, -0.1),
        "+": () => this.zoom(0.9),
        "-": () => this.zoom(1 / 0.9),
        f: () => document.getElementById("fit").click(),
      };
      const act = keys[event.key];
      if (!act || event.ctrlKey || event.metaKey || event.altKey) return;
      event.preventDefault();
      act();
    });
    new ResizeObserver(() => this.drawSoon()).observe(canvas);
  }
}

const POINT_VERTEX = `#version 300 es
layout(location = 0) in vec3 place;
layout(location = 1) in vec4 colour;
uniform mat4 seen;
uniform float size;
out vec4 tint;
void main() {
  gl_Position = seen * vec4(place, 1.0);
  gl_PointSize = size;
  tint = colour;
}`;

const POINT_FRAGMENT = `#version 300 es
precision mediump float;
in vec4 tint;
uniform bool ring;
out vec4 shown;
void main() {
  float off = 2.0 * length(gl_PointCoord - 0.5);
  if (off > 1.0 || (ring && off < 0.7)) discard;
  shown = vec4(ring || off < 0.75 ? tint.rgb : 0.7 * tint.rgb, tint.a);
}`;

const PLAIN_VERTEX = `#version 300 es
layout(location = 0) in vec3 place;
layout(location = 1) in vec4 colour;
uniform mat4 seen;
out vec4 tint;
void main() {
  gl_Position = seen * vec4(place, 1.0);
  tint = colour;
}`;

const PLAIN_FRAGMENT = `#version 300 es
precision mediump float;
in vec4 tint;
out vec4 shown;
void main() { shown = tint; }`;

function program(gl, ...sources) {
  const made = gl.createProgram();
  [gl.VERTEX_SHADER, gl.FRAGMENT_SHADER].forEach((kind, number) => {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, sources[number]);
    gl.compileShader(shader);
    gl.attachShader(made, shader);
  });
  gl.linkProgram(made);
  if (!gl.getProgramParameter(made, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(made) ?? "no shader");
  return made;
}
