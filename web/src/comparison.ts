// The comparison of methods that `sightline compare` adds: what each finds, loses and costs, and which stage of the
// pipeline limits a frame that draws what the method reports.
import type { Comparison, ComparedMethod } from './data.ts';
import { element } from './dom.ts';
import { count, percent, short_count, significant } from './format.ts';

const STAGES = ['application', 'geometry', 'fill', 'bus'] as const;

export function comparison(data: Comparison | null): HTMLElement | null {
  if (!data || data.methods.length === 0) return null;
  return element('section', { 'aria-labelledby': 'comparison-title', class: 'comparison' },
    element('h2', { id: 'comparison-title' }, 'Methods compared'), table(data.methods), stages(data));
}

function table(methods: ComparedMethod[]): HTMLElement {
  const names = ['Method', 'Promise', 'Culled', 'Hidden found', 'Missed', 'False-visible', 'Lost pixels', 'Median time', 'Memory'];
  const rows = methods.map((row) => {
    const broken = row.broken ?? (row.missed > 0 && row.promise !== 'approximate');
    return element('tr', { 'data-outcome': broken ? 'lost' : row.missed > 0 ? 'approximate' : 'clean' },
      element('th', { scope: 'row', title: counters(row) }, row.method), element('td', { class: 'said' }, row.promise),
      element('td', {}, percent(row.culled)), element('td', {}, percent(row.found)), element('td', {}, count(row.missed)),
      element('td', {}, significant(row.false_visible)), element('td', {}, count(row.lost_pixels)),
      element('td', {}, `${significant(row.cull_ms_median)} ms`),
      element('td', {}, typeof row.memory_bytes === 'number' ? `${significant(row.memory_bytes / 1e6)} MB` : '–'));
  });
  return element('table', { class: 'methods' },
    element('caption', {}, 'False-visible: reported though nobody sees it, objects a frame. Lost pixels: where something missed is seen, over all frames.'),
    element('thead', {}, element('tr', {}, ...names.map((name) => element('th', { scope: 'col' }, name)))),
    element('tbody', {}, ...rows));
}

function counters(row: ComparedMethod): string {
  return Object.entries(row.counters_per_frame ?? {}).map(([name, value]) => `${name.replaceAll('_', ' ')}: ${short_count(value)}`).join('\n');
}

/** One bar a method, all on one scale: the longest stage is the frame's time, since stages work side by side. */
function stages(data: Comparison): HTMLElement {
  const longest = Math.max(...data.methods.map((row) => Math.max(...STAGES.map((stage) => row.stages_ms[stage] ?? 0))), 1e-9);
  const rows = data.methods.map((row) => element('tr', {},
    element('th', { scope: 'row' }, row.method),
    ...STAGES.map((stage) => {
      const ms = row.stages_ms[stage];
      const share = typeof ms === 'number' ? (100 * ms) / longest : 0;
      return element('td', { 'data-stage': stage, 'data-limits': row.limited_by === stage },
        element('span', { class: 'bar', style: `width: ${share.toFixed(2)}%` }), element('span', {}, typeof ms === 'number' ? significant(ms) : '–'));
    }),
    element('td', { class: 'said' }, row.limited_by)));
  return element('table', { class: 'methods stages' },
    element('caption', {}, `Cost model, ms a frame: the slowest stage limits. One triangle ${significant(1e6 * data.units.ms_per_triangle)} ns, one pixel ` +
      `${significant(1e6 * data.units.ms_per_pixel)} ns (software renderer), bus ${significant(1e-6 / data.units.ms_per_byte)} GB/s.`),
    element('thead', {}, element('tr', {}, ...['Method', ...STAGES, 'limited by'].map((name) => element('th', { scope: 'col' }, name)))),
    element('tbody', {}, ...rows));
}
