// Makes synthetic data for the report page: a city of boxes, a walk through its streets, the truth by rays through a grid,
// a culler that draws a bit too much and, if wanted, loses something. `node fixture.mjs [--objects N] [--frames N]
// [--methods N] [--stored N] [--lose] [--ceiling] [--no-verify] [--bare] > walk.json`; the same options give the same data.
import { deflateSync } from 'node:zlib';
import { fileURLToPath } from 'node:url';

const SIZE = [192, 108];
const FOV_Y = (60 * Math.PI) / 180;
const NEAR = 0.1, FAR = 2000;
const BLOCK = 60, STREET = 18;

/** A small generator of numbers in [0, 1) (mulberry32). */
function random_source(seed) {
  let state = seed >>> 0;
  return () => {
    state = (state + 0x6d2b79f5) >>> 0;
    let value = Math.imul(state ^ (state >>> 15), state | 1);
    value ^= value + Math.imul(value ^ (value >>> 7), value | 61);
    return ((value ^ (value >>> 14)) >>> 0) / 4294967296;
  };
}

/** Boxes as [x0, y0, z0, x1, y1, z1]: two thirds buildings in blocks, the rest things that stand in the streets. */
function city(objects, random, ceiling) {
  const blocks = Math.max(2, Math.round(Math.sqrt(objects / 13)));
  const boxes = [], span = BLOCK + STREET;
  while (boxes.length < objects) {
    const index = boxes.length % (blocks * blocks), bx = index % blocks, bz = Math.floor(index / blocks);
    const x0 = bx * span, z0 = bz * span, centre = Math.hypot(bx - blocks / 2, bz - blocks / 2) / blocks;
    if (boxes.length < (objects * 2) / 3) {
      const layer = Math.floor(boxes.length / (blocks * blocks)) % 9, cell = BLOCK / 3;
      const w = cell * (0.72 + 0.26 * random()), d = cell * (0.72 + 0.26 * random());
      const x = x0 + (layer % 3) * cell, z = z0 + Math.floor(layer / 3) * cell;
      const tall = (8 + 60 * random() ** 3) * (0.5 + 1.3 * Math.max(0, 1 - 2 * centre));
      boxes.push([x, 0, z, x + w, tall, z + d]);
    } else {
      const along = random() * BLOCK, side = random() < 0.5, big = random() < 0.3;
      const size = big ? [4.4, 1.5, 1.9] : [0.5 + random(), 1 + 4 * random(), 0.5 + random()];
      const across = BLOCK + (random() < 0.5 ? 1.2 : STREET - 3.4);
      const x = x0 + (side ? along : across), z = z0 + (side ? across : along);
      boxes.push([x, 0, z, x + size[side ? 0 : 2], size[1], z + size[side ? 2 : 0]]);
    }
  }
  if (ceiling) for (let i = 0; i < blocks * blocks; ++i) boxes[i] = roof_over((i % blocks) * span, Math.floor(i / blocks) * span, span);
  return { boxes, blocks, span };
}

const roof_over = (x, z, span) => [x, 5, z, x + span, 5.2, z + span];

/** Eyes along streets with rounded corners, looking along the way. */
function walk_path({ blocks, span }, frames) {
  const middle = (index) => index * span - STREET / 2;
  const first = Math.max(1, Math.floor(blocks / 4)), last = Math.max(first + 1, Math.floor((blocks * 3) / 4));
  const half = Math.floor((first + last) / 2);
  const turns = [[first, last], [first, half], [half, half], [half, first], [last, first], [last, half]].map(([x, z]) => [middle(x), middle(z)]);
  const points = [];
  for (let i = 0; i + 1 < turns.length; ++i)
    for (let step = 0; step < 200; ++step)
      points.push([0, 1].map((axis) => turns[i][axis] + ((turns[i + 1][axis] - turns[i][axis]) * step) / 200));
  const smooth = points.map((_, i) => {
    const near = points.slice(Math.max(0, i - 14), i + 15);
    return [0, 1].map((axis) => near.reduce((total, point) => total + point[axis], 0) / near.length);
  });
  return Array.from({ length: frames }, (_, frame) => {
    const at = (frame / Math.max(1, frames - 1)) * (smooth.length - 60), i = Math.floor(at);
    const here = smooth[i], ahead = smooth[Math.min(smooth.length - 1, i + 40)];
    const direction = normal([ahead[0] - here[0], 0.6 * Math.sin(frame / 9), ahead[1] - here[1]]);
    const right = normal([-direction[2], 0, direction[0]]);
    return { eye: [here[0], 1.7 + 0.3 * Math.sin(frame / 25), here[1]], direction, right, up: cross(right, direction) };
  });
}

const normal = (v) => v.map((value) => value / Math.hypot(...v));
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];

/** Boxes by the square of the ground they stand on. */
function ground_grid(boxes, cell) {
  const width = Math.ceil(Math.max(...boxes.map((box) => Math.max(box[3], box[5]))) / cell) + 1;
  const squares = Array.from({ length: width * width }, () => []);
  boxes.forEach((box, id) => {
    for (let x = Math.floor(box[0] / cell); x <= Math.floor(box[3] / cell); ++x)
      for (let z = Math.floor(box[2] / cell); z <= Math.floor(box[5] / cell); ++z) squares[z * width + x].push(id);
  });
  return { squares, cell, width };
}

/** The first box along a ray, and how far: a walk over the squares of the ground. */
function first_hit(boxes, grid, origin, direction) {
  const { cell, squares, width } = grid;
  let x = Math.floor(origin[0] / cell), z = Math.floor(origin[2] / cell);
  const step_x = Math.sign(direction[0]), step_z = Math.sign(direction[2]);
  const slope_x = Math.abs(cell / direction[0]), slope_z = Math.abs(cell / direction[2]);
  let next_x = ((x + (step_x > 0 ? 1 : 0)) * cell - origin[0]) / direction[0] || Infinity;
  let next_z = ((z + (step_z > 0 ? 1 : 0)) * cell - origin[2]) / direction[2] || Infinity;
  let nearest = FAR, found = -1;
  while (x >= 0 && z >= 0 && x < width && z < width) {
    for (const id of squares[z * width + x]) {
      const t = enter_box(boxes[id], origin, direction);
      if (t < nearest) { nearest = t; found = id; }
    }
    const leave = Math.min(next_x, next_z);
    if (nearest <= leave || leave > FAR) break;
    if (next_x < next_z) { x += step_x; next_x += slope_x; } else { z += step_z; next_z += slope_z; }
  }
  return { id: found, distance: nearest };
}

function enter_box(box, origin, direction) {
  let enter = 0, leave = FAR;
  for (let axis = 0; axis < 3; ++axis) {
    const a = (box[axis] - origin[axis]) / direction[axis], b = (box[axis + 3] - origin[axis]) / direction[axis];
    enter = Math.max(enter, Math.min(a, b));
    leave = Math.min(leave, Math.max(a, b));
    if (enter > leave) return Infinity;
  }
  return enter;
}

/** Every pixel's first box and distance. */
function look(boxes, grid, view) {
  const [width, height] = SIZE, half_y = Math.tan(FOV_Y / 2), half_x = (half_y * width) / height;
  const ids = new Int32Array(width * height), depth = new Float32Array(width * height), direction = [0, 0, 0];
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) {
      const u = ((x + 0.5) / width * 2 - 1) * half_x, v = (1 - (y + 0.5) / height * 2) * half_y;
      for (let axis = 0; axis < 3; ++axis) direction[axis] = view.direction[axis] + u * view.right[axis] + v * view.up[axis];
      const hit = first_hit(boxes, grid, view.eye, direction);
      ids[y * width + x] = hit.id;
      depth[y * width + x] = hit.distance;
    }
  return { ids, depth };
}

function in_frustum(box, view) {
  const half_y = Math.tan(FOV_Y / 2), half_x = (half_y * SIZE[0]) / SIZE[1];
  const planes = [[view.right, half_x], [view.right.map((v) => -v), half_x], [view.up, half_y], [view.up.map((v) => -v), half_y]]
    .map(([side, half]) => view.direction.map((value, axis) => value * half - side[axis]));
  return [...planes, view.direction].every((plane) =>
    plane.reduce((total, value, axis) => total + value * ((value > 0 ? box[axis + 3] : box[axis]) - view.eye[axis]), 0) > 0);
}

/** An 8-bit RGB PNG. */
function png(width, height, pixel) {
  const rows = Buffer.alloc(height * (1 + 3 * width));
  for (let y = 0; y < height; ++y)
    for (let x = 0; x < width; ++x) pixel(x, y).forEach((value, channel) => { rows[y * (1 + 3 * width) + 1 + 3 * x + channel] = Math.max(0, Math.min(255, value)); });
  const head = Buffer.alloc(13);
  head.writeUInt32BE(width, 0);
  head.writeUInt32BE(height, 4);
  head.set([8, 2, 0, 0, 0], 8);
  const chunks = [['IHDR', head], ['IDAT', deflateSync(rows)], ['IEND', Buffer.alloc(0)]].map(([name, body]) => {
    const named = Buffer.concat([Buffer.from(name), body]), framed = Buffer.alloc(named.length + 8);
    framed.writeUInt32BE(body.length, 0);
    named.copy(framed, 4);
    framed.writeUInt32BE(checksum(named), named.length + 4);
    return framed;
  });
  return Buffer.concat([Buffer.from([137, 80, 78, 71, 13, 10, 26, 10]), ...chunks]).toString('base64');
}

function checksum(bytes) {
  let value = ~0;
  for (const byte of bytes) {
    value ^= byte;
    for (let bit = 0; bit < 8; ++bit) value = (value >>> 1) ^ (value & 1 ? 0xedb88320 : 0);
  }
  return ~value >>> 0;
}

const tint = (id) => [0, 1, 2].map((channel) => 70 + ((Math.imul(id + 1, 2654435761) >>> (8 * channel + 3)) & 0x7f) + 40);

function pictures_of(frame, { ids, depth }) {
  const [width, height] = SIZE, at = (x, y) => y * width + x;
  const shaded = (x, y) => {
    const i = at(x, y);
    if (ids[i] < 0) return y > height / 2 ? [96, 100, 104] : [150 + y, 185 + y / 2, 225];
    const light = Math.exp(-depth[i] / 300), edge = x > 0 && ids[i] !== ids[i - 1] ? 0.7 : 1;
    return [190, 184, 172].map((value, channel) => edge * (value * light + (1 - light) * [170, 195, 220][channel]) * (0.8 + (ids[i] % 7) / 30));
  };
  const kinds = {
    shaded,
    object: (x, y) => (ids[at(x, y)] < 0 ? [16, 18, 22] : tint(ids[at(x, y)])),
    depth: (x, y) => Array(3).fill(255 * Math.exp(-depth[at(x, y)] / 120)),
    overdraw: (x, y) => [60 + 30 * (ids[at(x, y)] % 6), 40 + 10 * (ids[at(x, y)] % 6), 70],
  };
  return Object.entries(kinds).map(([kind, pixel]) => ({ frame, kind, png: png(width, height, pixel) }));
}

/** What one method makes of the truth: everything seen, some of the hidden, and on two frames a loss if it is sloppy. */
function judge(truth, frustum, frame, method, random, { lose, verify }) {
  const state = new Uint8Array(truth.length), keep = [0.1, 0.45, 1][method % 3], missed = [];
  for (let id = 0; id < truth.length; ++id) {
    if (!frustum[id] && !truth[id]) continue;
    const steady = random_source(id * 31 + Math.floor((frame + id % 12) / 12) * 7919 + method)();
    state[id] = truth[id] ? 2 : steady < keep ? (verify ? 3 : 2) : 1;
    if (lose && method === 0 && truth[id] && (frame % 50 === 17 || frame % 50 === 18) && missed.length < 3 && random() < 0.1) {
      state[id] = 4;
      missed.push(id);
    }
  }
  return { state, missed };
}

const METHODS = ['occlusion_masked', 'occlusion_queries', 'frustum'];

export function make_fixture({ objects = 3000, frames = 120, methods = 1, lose = false, ceiling = false, verify = true, bare = false, stored = frames } = {}) {
  const random = random_source(7), town = city(objects, random, ceiling), { boxes } = town;
  const views = walk_path(town, frames), grid = ground_grid(boxes, 20);
  const triangles_of = boxes.map((_, id) => 200 + Math.floor(9000 * random_source(id)() ** 3));
  const triangles = triangles_of.reduce((a, b) => a + b, 0);
  const runs = Array.from({ length: methods }, (_, m) => ({ method: METHODS[m % 3], frames: [], summary: {} }));
  const kept = [], pictures = [], keep_every = frames / Math.min(frames, stored), picture_every = Math.ceil(frames / 12);
  views.forEach((view, frame) => {
    const seen = look(boxes, grid, view);
    const truth = new Uint8Array(objects);
    for (const id of seen.ids) if (id >= 0) truth[id] = 1;
    const frustum = boxes.map((box) => in_frustum(box, view));
    const keep = Math.floor(frame / keep_every) !== Math.floor((frame - 1) / keep_every);
    runs.forEach((run, m) => {
      const { state, missed } = judge(truth, frustum, frame, m, random, { lose, verify });
      const drawn = [...state.keys()].filter((id) => state[id] === 2 || state[id] === 3);
      run.frames.push({
        frame, eye: view.eye, candidates: objects, frustum: frustum.filter(Boolean).length, visible: drawn.length,
        truth: verify ? truth.reduce((a, b) => a + b, 0) : null, missed: verify ? missed.length : null, missed_ids: verify ? missed : null,
        cull_ms: [0.4, 1.1, 0.08][m % 3] * (1 + 0.3 * Math.sin(frame / 11) + 0.15 * random()) * (objects / 3000),
        truth_ms: verify ? 21 + 5 * random() : null,
        triangles_submitted: drawn.reduce((total, id) => total + triangles_of[id], 0),
      });
      kept.push({ frame, method: run.method, direction: view.direction, up: view.up, right: view.right, fov_y: FOV_Y, aspect: SIZE[0] / SIZE[1], near: NEAR, far: FAR,
                  ...(keep ? { state: Buffer.from(state).toString('base64') } : {}) });
    });
    if (frame % picture_every === 0) pictures.push(...pictures_of(frame, seen));
  });
  for (const run of runs) summarise(run, triangles, verify);
  const walk = { schema: 'sightline.walk/1', size: [1920, 1080], scene: { name: 'city (synthetic)', objects, triangles } };
  if (methods === 1) Object.assign(walk, runs[0]);
  else walk.runs = runs;
  if (bare) return walk;
  const command = `sightline walk city.glb --method ${runs.map((run) => run.method).join(',')} --frames ${frames} --size 1920x1080 --report out/walk`;
  const bounds = Buffer.from(Float32Array.from(boxes.flat()).buffer).toString('base64');
  walk.report = { command, version: '0.1.0', date: '2026-01-15', objects: { bounds }, frames: kept, pictures };
  return walk;
}

function summarise(run, triangles, verify) {
  const total = (read) => run.frames.reduce((sum, frame) => sum + read(frame), 0);
  const times = run.frames.map((frame) => frame.cull_ms).sort((a, b) => a - b);
  const missed = total((frame) => frame.missed ?? 0);
  run.summary = {
    missed: verify ? missed : null, overestimate: verify ? total((frame) => frame.visible) / total((frame) => frame.truth) : null,
    cull_ms_median: times[times.length >> 1], triangles_fraction: total((frame) => frame.triangles_submitted) / (run.frames.length * triangles),
    verdict: verify ? (missed ? 'fail' : 'pass') : 'unchecked',
  };
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const options = process.argv.slice(2), number = (name, standard) => (options.includes(name) ? Number(options[options.indexOf(name) + 1]) : standard);
  process.stdout.write(JSON.stringify(make_fixture({
    objects: number('--objects', 3000), frames: number('--frames', 120), methods: number('--methods', 1), stored: number('--stored', Infinity),
    lose: options.includes('--lose'), ceiling: options.includes('--ceiling'), verify: !options.includes('--no-verify'), bare: options.includes('--bare'),
  })));
}
