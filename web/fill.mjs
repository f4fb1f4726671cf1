// Puts data into the built page: what `sightline walk --report` does, for tests and for trying the page by hand.

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
