// Opens the built page from disk in a headless Chromium, with synthetic data of every kind, and checks what it says and
// does against the data. Pictures go to dist/*.png. CHROMIUM names the browser, /usr/bin/chromium without it.
// `node test.mjs freeze` runs the checks whose name holds that word.
import assert from 'node:assert/strict';
import { mkdirSync, readFileSync, statSync, writeFileSync } from 'node:fs';
import { pathToFileURL } from 'node:url';
import { chromium } from 'playwright-core';
import { fill, MARKER, MAX_PAGE_BYTES } from './fill.mjs';
import { make_fixture } from './fixture.mjs';

const dist = new URL('dist/', import.meta.url).pathname;
const template = readFileSync(`${dist}report.html`, 'utf8');
const SOFTWARE_GL = ['--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'];
mkdirSync(dist, { recursive: true });

const only = process.argv[2] ?? '';
let browser;

/** Opens a page with data and gives it to `check`; any console error, page error or request fails the test. */
async function with_page(name, data, check, { width = 1440, height = 900, scheme = 'light' } = {}) {
  if (!name.includes(only)) return;
  const file = `${dist}test-page.html`;
  writeFileSync(file, data === undefined ? template : fill(template, data));
  const context = await browser.newContext({ viewport: { width, height }, colorScheme: scheme, reducedMotion: 'reduce' });
  const page = await context.newPage(), faults = [];
  page.on('console', (message) => { if (['error', 'warning'].includes(message.type())) faults.push(`console: ${message.text()}`); });
  page.on('pageerror', (error) => faults.push(`page: ${error.stack}`));
  page.on('request', (request) => { if (!/^(file|data|blob):/.test(request.url())) faults.push(`request: ${request.url()}`); });
  await page.goto(pathToFileURL(file).href);
  await page.waitForTimeout(300);
  await check(page);
  assert.deepEqual(faults.filter((fault) => !/GPU stall due to ReadPixels/.test(fault)), [], `${name}: nothing may be complained about`);
  await context.close();
  console.log(`ok ${name}`);
}

const shot = (page, name) => page.screenshot({ path: `${dist}${name}.png` });
const to_space = (page) => page.evaluate(() => document.querySelector('#space-title').scrollIntoView());
const settle = (page) => page.waitForTimeout(700);
const heading = (page) => page.locator('h1').innerText();

/** How many objects of each state the legend tells of. */
const legend = (page) => page.evaluate(() =>
  Object.fromEntries([...document.querySelectorAll('.state')].map((item) =>
    [item.querySelector('input').dataset.state, Number(item.querySelector('.number').textContent.replaceAll(',', ''))])));

function tally(stored) {
  const counts = { 0: 0, 1: 0, 2: 0, 3: 0, 4: 0 };
  for (const state of Buffer.from(stored.state, 'base64')) ++counts[state];
  return counts;
}

async function scrub(page, frame) {
  await page.locator('.transport input').fill(String(frame));
  await settle(page);
}

async function check_views(page, data) {
  const losing = data.frames.findIndex((frame) => frame.missed > 0);
  const distinct = new Set(data.frames.flatMap((frame) => frame.missed_ids)).size;
  assert.match(await heading(page), new RegExp(`^[^\\d]*${distinct} objects were lost in`));
  assert.deepEqual(await legend(page), tally(data.report.frames[losing]), 'the page opens at the first loss');
  await shot(page, 'head');
  await to_space(page);
  await scrub(page, 40);
  assert.deepEqual(await legend(page), tally(data.report.frames[40]));
  await page.keyboard.press('ArrowRight');
  await page.keyboard.press('Shift+ArrowRight');
  assert.deepEqual(await legend(page), tally(data.report.frames[51]));
  await shot(page, 'overview');
  for (const camera of ['Top view', 'Follow camera', 'Through the eye']) {
    await page.getByRole('button', { name: camera }).click();
    await settle(page);
    await shot(page, camera.toLowerCase().replaceAll(' ', '-'));
  }
}

async function check_freeze(page, data) {
  await to_space(page);
  await scrub(page, 30);
  await page.getByRole('button', { name: 'Freeze culling and fly out' }).click();
  await settle(page);
  await scrub(page, 45);
  assert.deepEqual(await legend(page), tally(data.report.frames[30]), 'frozen states stay');
  assert.match(await page.locator('.banner').innerText(), /frozen at frame 30/);
  await shot(page, 'frozen');
  await page.getByRole('button', { name: 'Unfreeze' }).click();
  assert.deepEqual(await legend(page), tally(data.report.frames[45]), 'unfrozen states follow the scrubber');
}

/** Hiding a state must change both views, showing it again must bring the same picture back. */
async function check_toggles(page) {
  for (const view of ['.space canvas', '.plan canvas']) {
    const take = async () => { await settle(page); return (await page.locator(view).screenshot()).toString('base64'); };
    const hidden = page.locator('input[data-state="1"]');
    const before = await take();
    await hidden.click();
    const without = await take();
    await hidden.click();
    assert.ok(before !== without, `${view} must change without the hidden objects`);
    assert.ok(before === await take(), `${view} must look as before with them again`);
  }
}

async function check_table(page, data) {
  const first = await page.locator('.frames tbody tr').first().locator('td').allInnerTexts();
  assert.equal(Number(first[1]), Math.max(...data.frames.map((frame) => frame.missed)), 'the table begins with the worst frame');
  await page.getByRole('button', { name: 'Cull, ms' }).click();
  const slowest = await page.locator('.frames tbody tr').first().locator('td').first().innerText();
  const most = Math.max(...data.frames.map((frame) => frame.cull_ms));
  assert.equal(Number(slowest), data.frames.find((frame) => frame.cull_ms === most).frame);
  await page.locator('.frames tbody tr').first().click();
  assert.match(await page.locator('.frame-said').innerText(), new RegExp(`Frame ${slowest} `));
  await page.locator('.scroller').evaluate((scroller) => { scroller.scrollTop = 1e6; });
  await settle(page);
  assert.ok((await page.locator('.frames tbody tr').count()) < 60, 'only rows in sight are built');
}

async function check_pictures_and_plots(page, data) {
  await page.locator('.thumb').nth(2).click();
  assert.ok(await page.locator('dialog').isVisible());
  await shot(page, 'picture');
  await page.getByRole('button', { name: 'Go to this frame' }).click();
  const frame = [...new Set(data.report.pictures.map((picture) => picture.frame))].sort((a, b) => a - b)[2];
  assert.match(await page.locator('.frame-said').innerText(), new RegExp(`Frame ${frame} `));
  const plot = page.locator('.u-over').first();
  await plot.scrollIntoViewIfNeeded();
  const box = await plot.boundingBox();
  await page.mouse.click(box.x + box.width / 2, box.y + 40);
  const middle = Number((await page.locator('.frame-said strong').innerText()).replace('Frame ', ''));
  assert.ok(Math.abs(middle - (data.frames.length - 1) / 2) <= 1, `a press in the middle of a plot goes to the middle, not to ${middle}`);
  await page.mouse.move(0, 0);
  await settle(page);
  const drawn = await page.locator('.u-legend').first().locator('.u-series', { hasText: 'drawn' }).locator('.u-value').innerText();
  assert.equal(Number(drawn), data.frames[middle].visible, 'without a pointer the plot tells of the frame of the scrubber');
  await shot(page, 'plots');
}

async function check_object(page, data) {
  await to_space(page);
  await scrub(page, data.frames.findIndex((frame) => frame.missed > 0));
  await page.locator('.lost-list .chip').first().click();
  await settle(page);
  const id = Number((await page.locator('.card strong').innerText()).replace('Object ', ''));
  const lost = data.report.frames.filter((stored) => Buffer.from(stored.state, 'base64')[id] === 4).length;
  assert.match(await page.locator('.card .note').innerText(), new RegExp(`lost in ${lost}\\b`));
  await shot(page, 'lost-object');
}

async function check_play(page) {
  await scrub(page, 0);
  await page.locator('h2').first().click();
  await page.keyboard.press('Space');
  await page.waitForFunction(() => Number(document.querySelector('.transport input').value) > 2);
  await page.keyboard.press('Space');
}

async function run_all() {
  assert.ok(statSync(`${dist}report.html`).size <= MAX_PAGE_BYTES);
  assert.equal(template.split(MARKER).length, 2, 'one marker');

  const lose = make_fixture({ lose: true });
  await with_page('views', lose, (page) => check_views(page, lose));
  await with_page('freeze', lose, (page) => check_freeze(page, lose), { scheme: 'dark' });
  await with_page('toggles', lose, check_toggles);
  await with_page('table', lose, (page) => check_table(page, lose));
  await with_page('pictures and plots', lose, (page) => check_pictures_and_plots(page, lose), { scheme: 'dark' });
  await with_page('object', lose, (page) => check_object(page, lose));
  await with_page('play', lose, check_play, { width: 1000 });

  const small = { objects: 600, frames: 24 };
  await with_page('clean', make_fixture(small), async (page) => {
    assert.match(await heading(page), /Nothing visible was lost in 24 frames/);
    assert.equal(await page.locator('.lost-list').isVisible(), false);
  }, { width: 1600 });

  await with_page('not checked', make_fixture({ ...small, verify: false }), async (page) => {
    assert.match(await heading(page), /Not checked/);
    assert.match(await page.locator('.legend').innerText(), /not checked whether it is seen/);
    assert.doesNotMatch(await page.locator('.legend').innerText(), /really seen|lost/);
    await page.screenshot({ path: `${dist}not-checked.png`, fullPage: true });
  });

  await with_page('bare', make_fixture({ ...small, bare: true }), async (page) => {
    assert.match(await page.locator('#page').innerText(), /bounds of the objects were not stored/);
    assert.match(await page.locator('#page').innerText(), /No pictures were stored/);
    assert.equal(await page.locator('.u-over').count(), 3, 'the plots are there');
    await page.screenshot({ path: `${dist}bare.png`, fullPage: true });
  });

  await with_page('template', undefined, async (page) => assert.match(await heading(page), /holds no walk/));

  const several = make_fixture({ ...small, methods: 3, lose: true, stored: 6 });
  await with_page('several methods', several, async (page) => {
    assert.equal(await page.locator('.methods tbody tr').count(), 3);
    assert.match(await heading(page), /lost/);
    await page.getByLabel('occlusion_queries').click();
    assert.match(await heading(page), /Nothing visible was lost/);
    await scrub(page, 9);
    assert.match(await page.locator('.legend').innerText(), /Frame 9 has no stored states; those of frame 8 are shown/);
    const stored = several.report.frames.find((frame) => frame.frame === 8 && frame.method === 'occlusion_queries');
    assert.ok(!several.report.frames.find((frame) => frame.frame === 9).state);
    assert.deepEqual(await legend(page), tally(stored));
    await page.screenshot({ path: `${dist}several.png`, fullPage: true });
  }, { width: 1000 });

  const compared = make_fixture({ ...small, methods: 2 });
  compared.report.comparison = { units: { ms_per_triangle: 5e-5, ms_per_pixel: 1e-6, ms_per_byte: 1e-7 }, methods: compared.runs.map((run, i) => ({
    method: run.method, promise: i === 0 ? 'conservative' : 'approximate', culled: 0.9, found: null, missed: 2 * i, false_visible: 3.5, lost_pixels: 11 * i,
    cull_ms_median: 0.25, memory_bytes: i === 0 ? 2.5e6 : null, counters_per_frame: { queries: 1234 },
    stages_ms: { application: 0.25, geometry: 4, fill: i === 0 ? 8 : null, bus: 0.1 }, limited_by: i === 0 ? 'fill' : 'geometry' })) };
  await with_page('comparison', compared, async (page) => {
    const section = page.locator('.comparison');
    assert.equal(await section.locator('table').count(), 2);
    assert.match(await section.innerText(), /90\.0 %[^]*2\.50 MB[^]*11/);
    assert.deepEqual(await section.locator('[data-limits]').allInnerTexts(), ['8.00', '4.00']);
    await shot(page, 'comparison');
  });

  const ceiling = make_fixture({ ...small, ceiling: true });
  await with_page('roof cut away', ceiling, async (page) => {
    const height = Number((await page.locator('.cut output').innerText()).replace(' m', ''));
    assert.ok(height > 2 && height < 5, `cut between the eye and the roof, not at ${height}`);
  });

  const many = make_fixture({ ...small, frames: 3 }), copies = 120;
  const bounds = Buffer.from(many.report.objects.bounds, 'base64');
  many.scene.objects *= copies;
  many.report.objects.bounds = Buffer.concat(Array(copies).fill(bounds)).toString('base64');
  for (const stored of many.report.frames)
    stored.state = Buffer.concat(Array(copies).fill(Buffer.from(stored.state, 'base64'))).toString('base64');
  await with_page('very many objects in software', many, async (page) => {
    assert.match(await page.locator('#page').innerText(), /72,000 objects would be slow/);
    assert.deepEqual(await legend(page), tally(many.report.frames[1]));
    await page.getByRole('button', { name: 'Show 3-D anyway' }).click();
    await page.locator('.space canvas').waitFor();
  });

  const hostile = make_fixture(small);
  hostile.scene.name = '</script><img src=x onerror=alert(1)>';
  hostile.report.command = 'walk "</script><script>document.title = 1</script><!-- <script>" \u2028 --report x';
  hostile.report.frames[3].state = 'AAAA';
  await with_page('hostile and damaged data', hostile, async (page) => {
    assert.match(await page.locator('.source').innerText(), /script><img src=x/);
    assert.equal(await page.locator('.command code').innerText(), hostile.report.command);
    assert.match(await page.locator('.complaint').innerText(), /^1 of the stored frames/);
  });
}

async function run_without_webgl() {
  await with_page('without WebGL', make_fixture({ objects: 600, frames: 24 }), async (page) => {
    assert.match(await page.locator('#page').innerText(), /draws no WebGL/);
    assert.equal(await page.locator('.space').count(), 0);
    const box = await page.locator('.plan canvas').boundingBox();
    assert.ok(box.height > 500, 'the plan takes the place');
    await to_space(page);
    const inside = page.locator('.plan .tooltip');
    for (let x = 0.3; x < 0.7 && !(await inside.isVisible()); x += 0.01) await page.mouse.move(box.x + box.width * x, 400);
    assert.match(await inside.innerText(), /^Object \d+ · (seen|extra|hidden|outside|lost)/);
    await shot(page, 'without-webgl');
  });
}

const launch = (options) => chromium.launch({ executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium', args: options });
for (const [options, run] of [[SOFTWARE_GL, run_all], [['--disable-3d-apis'], run_without_webgl]]) {
  browser = await launch(options);
  try {
    await run();
  } finally {
    await browser.close();
  }
}
