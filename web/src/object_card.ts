// What happened to one object: its state in every stored frame, as a strip. Choosing a place in the strip moves the
// scrubber. Objects are selected by a double click in either view.
import { STATE_NAMES, state_words, UNKNOWN, type Walk } from './data.ts';
import { colour, element } from './dom.ts';
import { significant } from './format.ts';
import type { Placement } from './placement.ts';
import type { Store } from './store.ts';

export function object_card(walk: Walk, place: Placement, store: Store): HTMLElement {
  const title = element('strong');
  const said = element('p', { class: 'note' });
  const strip = element('canvas', { class: 'history', 'aria-hidden': 'true' });
  const root = element('div', { class: 'card', hidden: true, role: 'status' }, element('div', { class: 'bar' }, title,
    element('button', { type: 'button', class: 'quiet', 'aria-label': 'Close', onclick: () => store.set({ selected: null }) }, '✕')), said, strip);
  let history = new Uint8Array(0);
  const stored = () => walk.state_frames(store.get('run'));
  const draw = () => draw_history(strip, history, stored().findIndex((frame) => frame.frame === walk.state_camera(store.get('run'), store.get('frame'))?.frame));
  store.on(['selected', 'run'], () => {
    const id = store.get('selected');
    root.hidden = id === null;
    if (id === null) return;
    history = Uint8Array.from(stored(), (frame) => walk.states(store.get('run'), frame.frame)?.[id] ?? UNKNOWN);
    title.textContent = `Object ${id}`;
    said.textContent = `${place.size(id).map((length) => significant(length)).join(' × ')} m. ${tally(history, walk.checked(store.get('run'), store.state_frame))}`;
    draw();
  });
  store.on(['frame', 'theme'], () => { if (!root.hidden) draw(); });
  new ResizeObserver(() => { if (!root.hidden) draw(); }).observe(root);
  strip.addEventListener('pointerdown', (event) => {
    const frames = stored(), at = Math.floor((event.offsetX / strip.clientWidth) * frames.length);
    if (frames[at]) store.set({ frame: frames[at].frame, playing: false });
  });
  return root;
}

function tally(history: Uint8Array, checked: boolean): string {
  const counts = STATE_NAMES.map((_, state) => ({ name: state_words(state, checked).name, number: history.reduce((sum, value) => sum + Number(value === state), 0) }));
  const said = counts.filter(({ number }) => number > 0).sort((a, b) => b.number - a.number).map(({ name, number }) => `${name} in ${number}`);
  return said.length ? `Of ${history.length} stored frames: ${said.join(', ')}.` : 'No states are stored.';
}

function draw_history(canvas: HTMLCanvasElement, history: Uint8Array, current: number): void {
  const ratio = devicePixelRatio || 1, width = canvas.clientWidth, height = canvas.clientHeight, context = canvas.getContext('2d');
  if (!context || width === 0) return;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  const x = (index: number) => Math.round((index * canvas.width) / Math.max(1, history.length));
  const fill = (index: number, top: number, bottom: number) =>
    context.fillRect(x(index), top * ratio, Math.max(1, x(index + 1) - x(index)), (bottom - top) * ratio);
  const tints = STATE_NAMES.map((name) => colour(`--${name}`));
  history.forEach((state, index) => {
    context.fillStyle = tints[state] ?? tints[UNKNOWN];
    fill(index, 0, height - 5);
  });
  context.fillStyle = colour('--ink');
  if (current >= 0) fill(current, height - 4, height);
}
