// Puts the report page of `sightline walk --report` together from the data that stands in window.SIGHTLINE.
import { comparison } from './comparison.ts';
import { Walk } from './data.ts';
import { element } from './dom.ts';
import { frame_table } from './frame_table.ts';
import { head } from './head.ts';
import { legend } from './legend.ts';
import { object_card } from './object_card.ts';
import { pictures } from './pictures.ts';
import { Placement } from './placement.ts';
import { plots } from './plots.ts';
import { count, significant } from './format.ts';
import { space_view } from './space_view.ts';
import { Store } from './store.ts';
import { top_view } from './top_view.ts';
import { transport } from './transport.ts';

declare global {
  interface Window {
    SIGHTLINE: unknown;
  }
}

function build(page: HTMLElement): void {
  if (!window.SIGHTLINE) {
    page.append(element('header', {}, element('h1', {}, 'This page holds no walk'),
      element('p', { class: 'detail' }, 'It is the empty template. Make a full one with: sightline walk SCENE --report DIR')));
    return;
  }
  const walk = new Walk(window.SIGHTLINE as ConstructorParameters<typeof Walk>[0]);
  const store = new Store(walk.frame_count);
  const worst = walk.runs[0].frames.findIndex((frame) => (frame.missed ?? 0) > 0);
  store.set({ frame: worst >= 0 ? worst : Math.floor(walk.frame_count / 3) });
  read_address(walk, store);
  store.on(['run'], () => {
    document.documentElement.toggleAttribute('data-unchecked', !walk.runs[store.get('run')].frames.some((frame) => typeof frame.truth === 'number'));
    store.set({ theme: store.get('theme') + 1 });
  });
  page.append(head(walk, store));
  if (walk.frame_count === 0) return;
  const compared = comparison(walk.comparison);
  if (compared) page.append(compared);
  page.append(space(walk, store), plots(walk, store), pictures(walk, store), frame_table(walk, store), foot(), transport(walk, store));
}

/** The two views with what belongs to both. */
function space(walk: Walk, store: Store): HTMLElement {
  const root = element('section', { 'aria-labelledby': 'space-title' }, element('h2', { id: 'space-title' }, 'What was drawn, what was culled'));
  if (!walk.bounds) {
    root.append(element('p', { class: 'absent' }, 'The bounds of the objects were not stored, so there is nothing to show in space.'));
    return root;
  }
  const place = new Placement(walk);
  if (place.roof !== null) store.set({ cut: place.roof + place.centre[1] });
  const side = element('div', { class: 'side' },
    legend(walk, store), cut_slider(place, store), object_card(walk, place, store), top_view(walk, place, store));
  const views = element('div', { class: 'spaces flat' }, side);
  const reason = element('p', { class: 'absent' });
  const show = (anyway: boolean) => {
    const made = space_view(walk, place, store, anyway);
    views.classList.toggle('flat', !('panel' in made));
    reason.hidden = 'panel' in made;
    if ('panel' in made) views.prepend(made.panel);
    else if (made.missing === 'no WebGL') reason.textContent = 'This browser draws no WebGL; the plan shows the same from above.';
    else reason.replaceChildren(`This browser draws 3-D without a graphics card: ${count(place.count)} objects would be slow, the plan shows the same from above. `,
      element('button', { type: 'button', class: 'link', onclick: () => show(true) }, 'Show 3-D anyway'));
  };
  show(false);
  root.append(reason, views);
  return root;
}

/** Lowers the roof: objects are drawn up to a height. */
function cut_slider(place: Placement, store: Store): HTMLElement {
  const low = place.frame.lo[1] + place.centre[1], high = place.frame.hi[1] + place.centre[1];
  const said = element('output');
  const slider = element('input', { type: 'range', min: 0, max: 1000, step: 1, id: 'cut', oninput: () =>
    store.set({ cut: slider.value === '1000' ? Infinity : low + ((high - low) * Number(slider.value)) / 1000 }) });
  store.on(['cut'], () => {
    const cut = store.get('cut');
    slider.value = String(Number.isFinite(cut) ? Math.round(((cut - low) / (high - low)) * 1000) : 1000);
    said.textContent = Number.isFinite(cut) ? `${significant(cut)} m` : 'off';
  });
  return element('div', { class: 'cut' }, element('label', { for: 'cut' }, 'Cut at height'), slider, said);
}

/** #frame=17 opens the page at the frame of that number. */
function read_address(walk: Walk, store: Store): void {
  const asked = /frame=(\d+)/.exec(location.hash);
  const index = asked ? walk.runs[0].frames.findIndex((frame) => frame.frame === Number(asked[1])) : -1;
  if (index >= 0) store.set({ frame: index });
}

function foot(): HTMLElement {
  const key = (text: string) => element('kbd', {}, text);
  return element('footer', {}, element('p', {}, key('space'), ' plays, ', key('←'), ' ', key('→'), ' step (with ', key('shift'), ' by ten), ',
    key('Home'), ' and ', key('End'), ' jump. Double click an object to see its history.'));
}

build(document.getElementById('page') as HTMLElement);
