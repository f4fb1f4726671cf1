// The legend of the object states: what each colour means, how many objects have it in the frame shown, and a switch.
import { EXTRA, LOST, STATES, STATE_NAMES, state_words, type Walk } from './data.ts';
import { element } from './dom.ts';
import { count } from './format.ts';
import type { Store } from './store.ts';

export function legend(walk: Walk, store: Store): HTMLElement {
  const items = STATES.map((state) => {
    const number = element('span', { class: 'number' }, '–');
    const name = element('span', { class: 'name' }), meaning = element('span', { class: 'meaning' });
    const input = element('input', { type: 'checkbox', 'data-state': state, onchange: () =>
      store.set({ shown: store.get('shown').map((shown, index) => (index === state ? input.checked : shown)) }) });
    store.on(['shown'], () => { input.checked = store.get('shown')[state]; });
    const root = element('label', { class: 'state' }, input,
      element('span', { class: 'swatch', style: `background: var(--${STATE_NAMES[state]})` }), element('span', {}, name, ' ', number, meaning));
    return { state, root, number, name, meaning };
  });
  const lost = element('p', { class: 'lost-list', hidden: true });
  const note = element('p', { class: 'note' });
  store.on(['frame', 'frozen', 'run'], () => {
    const camera = walk.state_camera(store.get('run'), store.state_frame);
    const states = camera && walk.states(store.get('run'), camera.frame);
    const tally = new Array<number>(6).fill(0);
    if (states) for (const state of states) ++tally[state < 6 ? state : 5];
    const checked = walk.checked(store.get('run'), store.state_frame);
    for (const { state, root, number, name, meaning } of items) {
      const words = state_words(state, checked);
      name.textContent = words.name;
      meaning.textContent = words.meaning;
      number.textContent = states ? count(tally[state]) : '–';
      root.hidden = !checked && (state === LOST || state === EXTRA) && tally[state] === 0;
    }
    say_source(note, walk, store, states && camera ? camera.frame : null);
    list_lost(lost, states, tally[LOST], store);
  });
  return element('div', { class: 'legend' }, element('fieldset', {}, element('legend', {}, 'Objects'), ...items.map(({ root }) => root)), note, lost);
}

/** Says whose states are shown when they are not those of the frame of the scrubber. */
function say_source(note: HTMLElement, walk: Walk, store: Store, stored: number | null): void {
  const run = store.get('run'), name = (index: number) => count(walk.frame(run, index)?.frame ?? index);
  if (stored === null) note.textContent = `No object states were stored for ${walk.runs[run].method}.`;
  else if (store.get('frozen') !== null) note.textContent = `Frozen: the colours stay those of frame ${name(stored)}.`;
  else if (stored !== store.get('frame')) note.textContent = `Frame ${name(store.get('frame'))} has no stored states; those of frame ${name(stored)} are shown.`;
  else note.textContent = '';
}

function list_lost(list: HTMLElement, states: Uint8Array | null, number: number, store: Store): void {
  list.hidden = number === 0;
  if (!states || number === 0) return;
  const ids: number[] = [];
  for (let id = 0; id < states.length && ids.length < 12; ++id)
    if (states[id] === LOST) ids.push(id);
  list.replaceChildren(element('strong', {}, 'Lost here: '), ...ids.map((id) =>
    element('button', { type: 'button', class: 'chip', onclick: () => store.set({ selected: id }) }, `object ${id}`)),
    number > ids.length ? ` and ${count(number - ids.length)} more` : '');
}
