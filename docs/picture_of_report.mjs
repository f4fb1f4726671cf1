// node docs/picture_of_report.mjs PAGE OUTPUT.png: the upper part of a report as a browser shows it.
import { pathToFileURL } from 'node:url';
import { chromium } from '../web/node_modules/playwright-core/index.mjs';

const [page_file, output] = process.argv.slice(2);
const browser = await chromium.launch({
  executablePath: process.env.CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader'],
});
const page = await browser.newPage({ viewport: { width: 1280, height: 1240 } });
await page.goto(pathToFileURL(page_file).href);
await page.waitForTimeout(4000);
await page.screenshot({ path: output });
await browser.close();
