// Bundles web/src into one page, web/dist/report.html, that needs no network: script and style are inlined, and a content
// security policy forbids any request. `sightline walk --report` puts its data where the marker stands; see README.md.
import { build } from 'esbuild';
import { mkdirSync, readFileSync, renameSync, writeFileSync } from 'node:fs';
import { dirname, join } from 'node:path';
import { fileURLToPath } from 'node:url';
import { MARKER, MAX_PAGE_BYTES } from './fill.mjs';

const here = dirname(fileURLToPath(import.meta.url));

async function bundle(entry) {
  const result = await build({
    entryPoints: [join(here, 'src', entry)],
    bundle: true,
    minify: true,
    write: false,
    format: 'iife',
    target: ['chrome100', 'firefox100', 'safari16'],
    legalComments: 'none',
    logLevel: 'warning',
  });
  return result.outputFiles[0].text;
}

/** The licences of what is bundled ask that their notice travels with it. */
function notices() {
  const packages = ['three', 'uplot'].map((name) => {
    const folder = join(here, 'node_modules', name);
    const version = JSON.parse(readFileSync(join(folder, 'package.json'), 'utf8')).version;
    return `${name} ${version}\n${readFileSync(join(folder, 'LICENSE'), 'utf8').trim()}`;
  });
  return packages.join('\n\n').replaceAll('--', '- -');
}

const [script, style] = await Promise.all([bundle('main.ts'), bundle('style.css')]);
if (/<\/script/i.test(script) || /<\/style/i.test(style)) throw new Error('the bundle would close its own element');

const page = readFileSync(join(here, 'src', 'template.html'), 'utf8')
  .replace('<!--NOTICES-->', () => `<!--\n${notices()}\n-->`)
  .replace('/*STYLE*/', () => style)
  .replace('/*SCRIPT*/', () => script);

const markers = page.split(MARKER).length - 1;
if (markers !== 1) throw new Error(`the page must hold the data marker once, not ${markers} times`);
if (Buffer.byteLength(page) > MAX_PAGE_BYTES) throw new Error(`the page is over ${MAX_PAGE_BYTES} bytes`);

const target = join(here, 'dist', 'report.html');
mkdirSync(dirname(target), { recursive: true });
writeFileSync(`${target}.part`, page);
renameSync(`${target}.part`, target);
console.log(`${target}: ${(Buffer.byteLength(page) / 1024).toFixed(0)} KiB`);
