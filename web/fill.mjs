// Puts data into the built page: what `sightline walk --report` does, for tests and for trying the page by hand.
// `node fill.mjs walk.json page.html`
import { readFileSync, writeFileSync } from 'node:fs';
import { fileURLToPath } from 'node:url';

export const MARKER = '/*SIGHTLINE_DATA*/null';
export const MAX_PAGE_BYTES = 1_000_000;

/** JSON that may stand inside a script element: '<' is escaped, so neither </script> nor <!-- can appear in it. */
export function script_json(data) {
  return JSON.stringify(data).replaceAll('<', '\\u003c');
}

/** The page with the data in place of the marker. */
export function fill(page, data) {
  const at = page.indexOf(MARKER);
  if (at < 0) throw new Error('the page has no data marker');
  return page.slice(0, at) + script_json(data) + page.slice(at + MARKER.length);
}

if (process.argv[1] === fileURLToPath(import.meta.url)) {
  const [data, target] = process.argv.slice(2);
  const page = readFileSync(new URL('dist/report.html', import.meta.url), 'utf8');
  writeFileSync(target, fill(page, JSON.parse(readFileSync(data, 'utf8'))));
}
