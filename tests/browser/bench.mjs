// What the page costs: bytes and time of the first view, pictures a second while a large mesh is turned.
// Drawn by software; prints a table. Not a test: times depend on the machine.

import { join } from 'node:path';
import { denoise, launch, openMesh, openTab, startService, tool } from './browser.mjs';

const service = await startService();
const browser = await launch();

async function firstView() {
  const { page, context } = await openTab(browser, service.url);
  await page.locator('.welcome').waitFor();
  await page.waitForLoadState('networkidle');
  const view = await page.evaluate(() => ({
    bytes: performance.getEntries().reduce((sum, one) => sum + (one.encodedBodySize ?? 0), 0),
    interactive: performance.getEntriesByName('interactive')[0].startTime,
  }));
  await context.close();
  return view;
}

/// Turns the mesh by mouse for some seconds. Pictures a second, and the median and 95 % of their distances in ms.
async function turn(page, seconds) {
  const box = await page.locator('.stage > canvas').boundingBox();
  const [x, y] = [box.x + box.width * 0.7, box.y + box.height * 0.5];
  await page.mouse.move(x, y);
  await page.mouse.down();
  await page.evaluate(() => (globalThis.pictures = []));
  const end = Date.now() + 1000 * seconds;
  for (let i = 0; Date.now() < end; ++i) {
    await page.mouse.move(x - 150 * Math.sin(i / 40), y - 60 * Math.sin(i / 23));
    await new Promise((resolve) => setTimeout(resolve, 8));
  }
  const times = await page.evaluate(() => globalThis.pictures);
  await page.mouse.up();
  const gaps = times.slice(1).map((time, i) => time - times[i]).sort((a, b) => a - b);
  return {
    rate: (1000 * gaps.length) / (times.at(-1) - times[0]),
    median: gaps[gaps.length >> 1],
    late: gaps[Math.floor(gaps.length * 0.95)],
  };
}

try {
  const views = [];
  for (let i = 0; i < 5; ++i) views.push(await firstView());
  const times = views.map((view) => view.interactive).sort((a, b) => a - b);
  console.log(`first view     ${views[0].bytes} bytes as sent; interactive after ${times[2].toFixed(0)} ms (median of 5, ${times[0].toFixed(0)} to ${times[4].toFixed(0)})`);

  const mesh = join(service.folder, 'torus.glb');
  tool('sample', 'torus', mesh, '--size', '255', '--noise', '0.2');
  const { page, context } = await openTab(browser, service.url);
  await page.evaluate(() => {
    const draw = WebGL2RenderingContext.prototype.clear;
    WebGL2RenderingContext.prototype.clear = function (mask) {
      globalThis.pictures?.push(performance.now());
      return draw.call(this, mask);
    };
  });
  await openMesh(page, mesh);
  await denoise(page);
  await page.selectOption('.tools select', 'predominant');
  await page.waitForTimeout(4000);
  for (const [key, name] of [['1', 'split'], ['2', 'side by side'], ['4', 'after alone']]) {
    await page.locator('body').press(key);
    const { rate, median, late } = await turn(page, 5);
    console.log(`turning 130 050 vertices, ${name.padEnd(13)} ${rate.toFixed(1)} pictures/s; ${median.toFixed(0)} ms between two (median), 95 %: ${late.toFixed(0)} ms`);
  }
  await context.close();
} finally {
  await browser.close();
  await service.stop();
}
