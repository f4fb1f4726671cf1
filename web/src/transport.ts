// The scrubber at the foot of the window: play, step, slide; above the slider the number of drawn objects over the walk,
// with a mark wherever something was lost. Space and the arrow keys work from anywhere on the page.
import type { Walk } from './data.ts';
import { colour, element } from './dom.ts';
import { count } from './format.ts';
import type { Store } from './store.ts';

const WALK_SECONDS = 14;  // how long playing a walk takes, within 4 to 30 frames per second

export function transport(walk: Walk, store: Store): HTMLElement {
  const last = walk.frame_count - 1;
  const slider = element('input', {
    type: 'range', min: 0, max: last, step: 1, 'aria-label': 'Frame', oninput: () => store.set({ frame: Number(slider.value), playing: false }),
  });
  const profile = element('canvas', { 'aria-hidden': 'true' });
  const play = element('button', { type: 'button', class: 'play', onclick: () => toggle_play(store) });
  const step = (by: number) => store.set({ frame: store.get('frame') + by, playing: false });
  const said = element('output', { class: 'frame-said' });
  const root = element('div', { class: 'transport', role: 'region', 'aria-label': 'Frame' },
    element('button', { type: 'button', title: 'Frame before (←)', 'aria-label': 'Frame before', onclick: () => step(-1) }, '‹'), play,
    element('button', { type: 'button', title: 'Frame after (→)', 'aria-label': 'Frame after', onclick: () => step(1) }, '›'),
    element('div', { class: 'track' }, profile, slider), said);

  store.on(['frame', 'run'], () => {
    const frame = walk.frame(store.get('run'), store.get('frame'));
    slider.value = String(store.get('frame'));
    slider.setAttribute('aria-valuetext', `frame ${frame?.frame ?? store.get('frame')}`);
    said.replaceChildren(element('strong', {}, `Frame ${count(frame?.frame ?? store.get('frame'))}`), ` of ${count(walk.frame_count)}`);
  });
  store.on(['playing'], () => {
    play.textContent = store.get('playing') ? '❚❚' : '►';
    play.setAttribute('aria-label', store.get('playing') ? 'Pause' : 'Play');
    play.title = store.get('playing') ? 'Pause (space)' : 'Play (space)';
    if (store.get('playing')) run_clock(store, last);
  });
  const redraw = () => draw_profile(profile, walk, store.get('run'));
  store.on(['run', 'theme'], redraw);
  new ResizeObserver(redraw).observe(profile);
  document.addEventListener('keydown', (event) => handle_key(event, store, last));
  return root;
}

export function toggle_play(store: Store): void {
  const at_end = store.get('frame') === store.frame_count - 1;
  store.set({ playing: !store.get('playing'), ...(at_end && !store.get('playing') ? { frame: 0 } : {}) });
}

function run_clock(store: Store, last: number): void {
  const per_second = Math.max(4, Math.min(30, (last + 1) / WALK_SECONDS));
  let from = performance.now(), first = store.get('frame'), shown = first;
  const tick = (now: number) => {
    if (!store.get('playing')) return;
    if (store.get('frame') !== shown) {  // somebody scrubbed meanwhile
      from = now;
      first = store.get('frame');
    }
    shown = Math.min(last, first + Math.floor(((now - from) / 1000) * per_second));
    store.set({ frame: shown });
    if (shown === last) store.set({ playing: false });
    else requestAnimationFrame(tick);
  };
  requestAnimationFrame(tick);
}

function handle_key(event: KeyboardEvent, store: Store, last: number): void {
  const target = event.target as HTMLElement;
  if (event.ctrlKey || event.metaKey || event.altKey || document.querySelector('dialog[open]')) return;
  const typing = target.matches('select, textarea, input:not([type=range]):not([type=checkbox])');
  const pressing = event.key === ' ' && target.matches('button, input, a, summary, [role=button], tr');
  if (typing || pressing) return;
  if (target.matches('input[type=range]') && !target.closest('.transport')) return;
  const stride = event.shiftKey ? 10 : 1;
  if (event.key === 'ArrowRight') store.set({ frame: store.get('frame') + stride, playing: false });
  else if (event.key === 'ArrowLeft') store.set({ frame: store.get('frame') - stride, playing: false });
  else if (event.key === 'Home') store.set({ frame: 0 });
  else if (event.key === 'End') store.set({ frame: last });
  else if (event.key === ' ') toggle_play(store);
  else return;
  event.preventDefault();
}

function draw_profile(canvas: HTMLCanvasElement, walk: Walk, run: number): void {
  const scale = devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight;
  const context = canvas.getContext('2d');
  if (!context || width === 0) return;
  canvas.width = Math.round(width * scale);
  canvas.height = Math.round(height * scale);
  context.scale(scale, scale);
  const frames = walk.runs[run].frames;
  const most = frames.reduce((value, frame) => Math.max(value, frame.visible ?? 0), 1);
  const x = (index: number) => (frames.length > 1 ? (index / (walk.frame_count - 1)) * width : width / 2);
  context.beginPath();
  context.moveTo(x(0), height);
  frames.forEach((frame, index) => context.lineTo(x(index), height - ((frame.visible ?? 0) / most) * (height - 6)));
  context.lineTo(x(frames.length - 1), height);
  context.fillStyle = colour('--profile');
  context.fill();
  context.fillStyle = colour('--lost');
  frames.forEach((frame, index) => {
    if (frame.missed) context.fillRect(x(index) - 1, 0, 2.5, height);
  });
}
