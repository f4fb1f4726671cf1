// The head: the verdict in words, what was walked and how, key figures, the command that made it.
import type { Walk } from './data.ts';
import { element } from './dom.ts';
import { figures, verdict } from './figures.ts';
import { count, percent, plural, short_count, significant } from './format.ts';
import type { Store } from './store.ts';

const MARKS = { clean: '✓', lost: '✕', approximate: '≈', unchecked: '?', empty: '–' };

export function head(walk: Walk, store: Store): HTMLElement {
  const mark = element('span', { class: 'mark', 'aria-hidden': 'true' });
  const sentence = element('span');
  const detail = element('p', { class: 'detail' });
  const tiles = element('dl', { class: 'tiles' });
  const root = element('header', {},
    element('div', { class: 'masthead' }, element('span', { class: 'brand' }, eye_mark(), 'sightline'), source(walk), scheme_button(store)),
    element('h1', {}, mark, sentence), detail, ...walk.complaints.map((text) => element('p', { class: 'complaint' }, text)),
    tiles, methods(walk, store), command(walk));
  store.on(['run'], () => {
    const run = walk.runs[store.get('run')];
    const said = verdict(run, walk.samples);
    root.dataset.outcome = said.outcome;
    mark.textContent = MARKS[said.outcome];
    sentence.textContent = said.sentence;
    detail.replaceChildren(said.detail);
    if (said.worst !== null) {
      const worst = said.worst;
      detail.append(' ', element('button', { type: 'button', class: 'link', onclick: () => store.set({ frame: worst }) }, 'Show that frame'));
    }
    document.title = `${said.sentence} · ${walk.scene_name} · sightline`;
    tiles.replaceChildren(...key_figures(walk, store.get('run')));
  });
  return root;
}

/** What was walked, in one line. */
function source(walk: Walk): HTMLElement {
  const parts = [
    walk.scene_name,
    walk.runs.length === 1 ? walk.runs[0].method : `${walk.runs.length} methods`,
    `${count(walk.frame_count)} ${plural(walk.frame_count, 'frame')}`,
    walk.size ? `${walk.size[0]} × ${walk.size[1]} pixels` : null,
    walk.date, walk.version && `version ${walk.version}`,
  ].filter((part) => part);
  return element('p', { class: 'source' }, ...parts.map((part, index) =>
    element(index === 0 ? 'strong' : 'span', index === 0 ? { title: walk.scene_path } : {}, part as string)));
}

function eye_mark(): Element {
  const holder = element('span', { class: 'eye', 'aria-hidden': 'true' });
  holder.innerHTML = '<svg viewBox="0 0 24 24" width="22" height="22"><path d="M2 12 L22 3 L22 21 Z" fill="currentColor" opacity=".28"/>' +
    '<circle cx="4" cy="12" r="3" fill="currentColor"/></svg>';
  return holder;
}

/** The scheme stands in the root's data-scheme: that of the system until somebody chooses another. */
function scheme_button(store: Store): HTMLElement {
  const root = document.documentElement, system = matchMedia('(prefers-color-scheme: dark)');
  const button = element('button', { type: 'button', class: 'quiet', title: 'Switch between light and dark' });
  const use = (dark: boolean) => {
    root.dataset.scheme = dark ? 'dark' : 'light';
    button.textContent = dark ? 'Light' : 'Dark';
    store.set({ theme: store.get('theme') + 1 });
  };
  button.addEventListener('click', () => use(root.dataset.scheme !== 'dark'));
  system.addEventListener('change', () => use(system.matches));
  use(system.matches);
  return button;
}

function key_figures(walk: Walk, run: number): HTMLElement[] {
  const figure = figures(walk, walk.runs[run]);
  return [
    tile('Objects', walk.object_count ? count(walk.object_count) : '–', 'in the scene'),
    tile('Triangles', short_count(walk.triangles), 'in the scene'),
    tile('Culled', percent(figure.culled), 'of the objects, on average'),
    tile('Drawn per seen', figure.overestimate === null ? '–' : `${significant(figure.overestimate)} ×`,
         figure.overestimate === null ? 'truth not measured' : '1 would be perfect'),
    tile('Cull time', figure.cull_ms === null ? '–' : `${significant(figure.cull_ms)} ms`, 'median frame'),
    tile('Triangles drawn', percent(figure.triangles), 'of the scene, per frame'),
  ];
}

function tile(name: string, value: string, note: string): HTMLElement {
  return element('div', { class: 'tile' }, element('dt', {}, name), element('dd', {}, value), element('dd', { class: 'note' }, note));
}

/** One row per method when several were compared; choosing a row shows that method everywhere. */
function methods(walk: Walk, store: Store): HTMLElement | null {
  if (walk.runs.length < 2) return null;
  const rows = walk.runs.map((run, index) => {
    const figure = figures(walk, run), said = verdict(run, walk.samples);
    const input = element('input', { type: 'radio', name: 'method', id: `method-${index}`, onchange: () => store.set({ run: index }) });
    store.on(['run'], () => { input.checked = store.get('run') === index; });
    return element('tr', { 'data-outcome': said.outcome, onclick: () => store.set({ run: index }) },
      element('td', {}, input),
      element('th', { scope: 'row' }, element('span', { class: 'swatch', style: `background: var(--run-${index % 6})` }),
              element('label', { for: `method-${index}` }, run.method)),
      element('td', { class: 'said' }, said.sentence),
      element('td', {}, percent(figure.culled)),
      element('td', {}, figure.overestimate === null ? '–' : `${significant(figure.overestimate)} ×`),
      element('td', {}, figure.cull_ms === null ? '–' : `${significant(figure.cull_ms)} ms`),
      element('td', {}, percent(figure.triangles)));
  });
  const names = ['', 'Method', 'Verdict', 'Culled', 'Drawn per seen', 'Cull time', 'Triangles drawn'];
  return element('table', { class: 'methods' }, element('caption', {}, 'Methods compared on the same frames'),
    element('thead', {}, element('tr', {}, ...names.map((name) => element('th', { scope: 'col' }, name)))),
    element('tbody', {}, ...rows));
}

function command(walk: Walk): HTMLElement | null {
  if (!walk.command) return null;
  const code = element('code', { tabindex: 0, 'aria-label': 'Command that made this page' }, walk.command);
  const button = element('button', { type: 'button', onclick: async () => {
    button.textContent = (await copy(walk.command, code)) ? 'Copied' : 'Selected';
    setTimeout(() => { button.textContent = 'Copy'; }, 1600);
  } }, 'Copy');
  return element('div', { class: 'command' }, element('span', { class: 'prompt', 'aria-hidden': 'true' }, '$'), code, button);
}

/** Copies the text, or, where a page from disk may not, selects it. */
async function copy(text: string, shown: HTMLElement): Promise<boolean> {
  try {
    await navigator.clipboard.writeText(text);
    return true;
  } catch {
    getSelection()?.selectAllChildren(shown);
    return document.execCommand('copy');
  }
}
