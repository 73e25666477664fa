// What the page promises, seen in a browser.

import assert from 'node:assert/strict';
import { execFileSync } from 'node:child_process';
import { createHash } from 'node:crypto';
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from 'node:fs';
import { join } from 'node:path';
import { after, before, test } from 'node:test';
import { gzipSync } from 'node:zlib';
import validator from 'gltf-validator';
import { daemon, denoise, heapOf, keep, launch, openMesh, openTab, part, picture, startService, tool } from './browser.mjs';

const files = (name) => join(service.folder, name);
let service;
let browser;

before(async () => {
  service = await startService();
  browser = await launch();
  tool('sample', 'ring', files('ring.glb'), '--noise', '0.2');
  tool('sample', 'octahedron', files('octahedron.glb'), '--noise', '0.2');
  for (const format of ['ply', 'obj', 'stl', 'drc', 'gltf']) {
    tool('denoise', files('octahedron.glb'), files(`octahedron.${format}`), '--params', '{"method":"none","curvature":[]}', '--quiet');
  }
});

after(async () => {
  await browser?.close();
  await service?.stop();
});

/// A tab whose faults fail the test at its end.
async function withTab(options, use) {
  const { page, faults, context } = await openTab(browser, service.url, options);
  await use(page);
  assert.deepEqual(faults, []);
  await context.close();
}

test('the first view is small and asks nobody else', () =>
  withTab({}, async (page) => {
    await page.locator('.welcome').waitFor();
    await page.waitForLoadState('networkidle');
    const sizes = await page.evaluate(() =>
      performance.getEntries().filter((one) => one.transferSize).map((one) => [one.name, one.encodedBodySize]),
    );
    const total = sizes.reduce((sum, [, size]) => sum + size, 0);
    const interactive = await page.evaluate(() => performance.getEntriesByName('interactive')[0].startTime);
    console.log(`first view: ${sizes.length} files, ${total} bytes; interactive after ${interactive.toFixed(0)} ms`);
    assert.ok(sizes.length >= 4);
    assert.ok(total < 300e3, `${total} bytes`);
    await keep(page, 'welcome');
  }));

test('a noisy ring becomes smooth, is compared, coloured, run again and downloaded', () =>
  withTab({}, async (page) => {
    await openMesh(page, files('ring.glb'));
    await page.getByText(/Noise of about 0\.\d+ edge lengths/).waitFor();
    const noisy = await picture(page);
    await keep(page, 'opened');

    assert.equal(await denoise(page), 'succeeded');
    assert.match(await part(page, 'report').textContent(), /Noise about 0\.\d+ edge lengths, removed (at strength|by a low pass)/);
    assert.match(await part(page, 'report').textContent(), /\d feature vertices kept sharp/);
    const smooth = await picture(page);
    assert.ok(!smooth.equals(noisy), 'the picture shows the run');
    await keep(page, 'denoised');

    // The split: by mouse, and by keyboard.
    const divider = part(page, 'divider');
    const box = await divider.boundingBox();
    await page.mouse.move(box.x + box.width / 2, box.y + 200);
    await page.mouse.down();
    await page.mouse.move(box.x - 200, box.y + 220, { steps: 4 });
    await page.mouse.up();
    const moved = Number(await divider.getAttribute('aria-valuenow'));
    assert.ok(moved < 35, `the split is at ${moved} %`);
    assert.ok(!(await picture(page)).equals(smooth));
    await divider.press('ArrowRight');
    assert.equal(Number(await divider.getAttribute('aria-valuenow')), moved + 2);

    // Curvature with its scale, of both sides.
    await page.selectOption('.tools select', 'mean');
    const legend = part(page, 'legend');
    await legend.waitFor();
    assert.match(await legend.textContent(), /Mean curvature \(1\/length\)/);
    await page.waitForFunction(async () => (await (await fetch('/v1/jobs')).json()).jobs.some((job) => job.parameters.method === 'none' && job.state === 'succeeded'));
    const coloured = await picture(page);
    await keep(page, 'curvature');
    const ends = await legend.locator('.ends').textContent();
    await legend.getByLabel('Highest value shown as colour').focus();
    for (let i = 0; i < 40; ++i) await page.keyboard.press('ArrowLeft');
    assert.notEqual(await legend.locator('.ends').textContent(), ends);
    assert.ok(!(await picture(page)).equals(coloured), 'another range, other colours');
    await legend.getByRole('button', { name: 'Reset' }).click();
    assert.equal(await legend.locator('.ends').textContent(), ends);

    // Overlays and layouts, by keys.
    await page.locator('body').press('2');
    await page.locator('body').press('f');
    await page.locator('body').press('d');
    await picture(page);
    await keep(page, 'side-by-side');
    for (const key of ['w', 's', 'f', 'd']) {
      const seen = await picture(page);
      await page.locator('body').press(key);
      assert.ok(!(await picture(page)).equals(seen), `${key} changes the picture`);
    }
    await page.locator('body').press('w');

    // Another run with other parameters, compared with the first one.
    await page.getByText('All parameters').click();
    await page.locator('#parameter-steps').fill('7');
    await page.getByRole('radio', { name: 'cad' }).check();
    await keep(page, 'parameters');
    assert.equal(await denoise(page), 'succeeded');
    assert.match(await part(page, 'report').textContent(), /treated in 7 steps/);
    assert.match(await part(page, 'result').textContent(), /Run 2: cad, steps 7/);
    await page.getByLabel('Left').selectOption({ label: 'Run 1: automatic' });
    await page.locator('.caption.left', { hasText: 'Run 1' }).waitFor();
    await picture(page);
    await keep(page, 'two-runs');

    // Downloads are the files that the service makes, in every format.
    for (const label of await page.locator('.downloads button').allTextContents()) {
      const coming = page.waitForEvent('download');
      await page.locator('.downloads').getByRole('button', { name: label, exact: true }).click();
      const download = await coming;
      const path = files(`download-${label.replace(/\W+/g, '-')}-${download.suggestedFilename()}`);
      await download.saveAs(path);
      assert.match(tool('inspect', path), /12320 vertices/, label);
      if (/\.(glb|gltf)$/.test(path)) {
        const told = await validator.validateBytes(new Uint8Array(readFileSync(path)));
        assert.equal(told.issues.numErrors, 0, `${label}: ${JSON.stringify(told.issues.messages[0])}`);
      }
      if (label === 'GLB') assert.ok(readFileSync(path).includes('_CURVATURE_MEAN'));
    }

    // The line for a shell makes the same file.
    await page.getByText('This run for a shell').click();
    const line = await page.locator('#curl').textContent();
    const folder = files('shell');
    mkdirSync(folder);
    copyFileSync(files('ring.glb'), join(folder, 'ring.glb'));
    execFileSync('sh', ['-c', line], { cwd: folder });
    const digest = (path) => createHash('sha256').update(readFileSync(path)).digest('hex');
    assert.equal(digest(join(folder, 'ring-denoised.glb')), digest(files('download-GLB-ring-denoised.glb')));
  }));

test('every format that the service reads is shown at once', () =>
  withTab({}, async (page) => {
    await page.locator('.welcome').waitFor();
    const empty = await picture(page);
    for (const format of ['glb', 'gltf', 'ply', 'obj', 'stl', 'drc']) {
      await openMesh(page, files(`octahedron.${format}`));
      await page.getByText(/\d component/).waitFor();
      assert.ok((await picture(page)).length > empty.length + 5000, `${format} is seen`);
      assert.equal(await denoise(page), 'succeeded', format);
      assert.equal(await part(page, 'error').count(), 0, format);
    }
  }));

test('a glTF finds its side files, and says which is missing', () =>
  withTab({}, async (page) => {
    const folder = files('parts');
    mkdirSync(folder, { recursive: true });
    const scene = JSON.parse(readFileSync(files('octahedron.gltf'), 'utf8'));
    const data = Buffer.from(scene.buffers[0].uri.split(',')[1], 'base64');
    scene.buffers[0].uri = 'data/mesh%20data.bin';
    writeFileSync(join(folder, 'scene.gltf'), JSON.stringify(scene));
    writeFileSync(join(folder, 'mesh data.bin'), data);
    await openMesh(page, [join(folder, 'mesh data.bin'), join(folder, 'scene.gltf')]);
    assert.equal(await denoise(page), 'succeeded');
    await page.setInputFiles('#files', [join(folder, 'scene.gltf')]);
    await part(page, 'error').waitFor();
    assert.match(await part(page, 'error').textContent(), /mesh%20data\.bin/);
  }));

test('errors are told with their remedy', () =>
  withTab({}, async (page) => {
    writeFileSync(files('noise.glb'), Buffer.alloc(2000, 'x'));
    await page.setInputFiles('#files', files('noise.glb'));
    await part(page, 'error').waitFor();
    assert.match(await part(page, 'error').textContent(), /Unsupported format.*Send GLB as/s);
    await keep(page, 'error');

    await openMesh(page, files('octahedron.glb'));
    await page.getByText('All parameters').click();
    await page.locator('#parameter-feature_angle').fill('500');
    assert.equal(await denoise(page), 'failed');
    const field = page.locator('.field', { has: page.locator('#parameter-feature_angle') });
    assert.match(await field.locator('.error').textContent(), /180/);
    await page.locator('#parameter-fixed_vertices').fill('3, 17');
    await part(page, 'denoise').click();
    assert.match(await part(page, 'error').textContent(), /\[0, 3, 17\]/);
  }));

test('a run can be cancelled, and the jobs of the service are listed and opened again', () =>
  withTab({}, async (page) => {
    await openMesh(page, files('ring.glb'));
    await page.getByText('All parameters').click();
    await page.locator('#parameter-steps').fill('10000');
    await page.locator('#parameter-integration').selectOption('semi_implicit');
    await part(page, 'denoise').click();
    const row = part(page, 'run').first();
    await page.waitForFunction(() => document.querySelector('[data-test="run"]')?.dataset.state === 'running');
    await page.waitForFunction(() => document.querySelector('[data-test="run"] progress')?.value > 0);
    await keep(page, 'running');
    await row.getByRole('button', { name: 'Cancel' }).click();
    await page.waitForFunction(() => document.querySelector('[data-test="run"]')?.dataset.state === 'canceled');

    await page.locator('#parameter-steps').fill('5');
    assert.equal(await denoise(page), 'succeeded');
    await page.getByText('Jobs on this service').click();
    await page.locator('.panel li', { hasText: 'canceled' }).first().waitFor();

    // The address of a run is the run.
    assert.match(page.url(), /#job=/);
    await page.reload();
    await page.locator('.caption.right', { hasText: 'Run 1' }).waitFor();
    assert.match(await part(page, 'report').textContent(), /treated in 5 steps/);
    await keep(page, 'opened-again');
  }));

test('ten runs later the memory is what it was', () =>
  withTab({}, async (page) => {
    await openMesh(page, files('ring.glb'));
    await page.selectOption('.tools select', 'mean');
    await page.getByText('All parameters').click();
    const run = async (steps) => {
      await page.locator('#parameter-steps').fill(String(steps));
      assert.equal(await denoise(page), 'succeeded');
      await picture(page);
    };
    for (const steps of [1, 2]) await run(steps);
    const heap = await heapOf(page);
    const buffers = await page.evaluate(() => globalThis.liveBuffers);
    for (let steps = 3; steps <= 12; ++steps) await run(steps);
    const grown = (await heapOf(page)) - heap;
    console.log(`memory: ${heap} bytes after two runs, ${grown} more after ten others; ${buffers} buffers`);
    assert.ok(grown < 1.5e6, `${grown} bytes more`);
    assert.equal(await page.evaluate(() => globalThis.liveBuffers), buffers);
  }));

test('the page fits a telephone, and the dark', async () => {
  await withTab({ viewport: { width: 390, height: 844 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true }, async (page) => {
    await page.locator('.welcome').waitFor();
    await keep(page, 'phone-welcome');
    await openMesh(page, files('ring.glb'));
    assert.equal(await denoise(page), 'succeeded');
    await page.selectOption('.tools select', 'predominant');
    await part(page, 'legend').waitFor();
    await picture(page);
    await keep(page, 'phone');
    await page.screenshot({ path: 'screenshots/phone-whole.png', fullPage: true });
    const wide = await page.evaluate(() => [document.documentElement.scrollWidth, innerWidth]);
    assert.ok(wide[0] <= wide[1], `${wide[0]} in ${wide[1]} pixels`);
  });
  await withTab({ colorScheme: 'dark' }, async (page) => {
    await openMesh(page, files('octahedron.glb'));
    assert.equal(await denoise(page), 'succeeded');
    await page.selectOption('.tools select', 'predominant');
    await picture(page);
    await keep(page, 'dark');
  });
});

test('keys of the keyboard are explained, and a click on a sample is enough', () =>
  withTab({}, async (page) => {
    await page.locator('.welcome').waitFor();
    await page.keyboard.press('?');
    await page.getByRole('dialog').waitFor();
    await page.keyboard.press('Escape');
    await page.locator('[data-sample="sheet.glb"]').click();
    await page.getByText('1 boundary loop').waitFor();
    await page.locator('body').press('Enter');
    await part(page, 'report').waitFor();
    assert.doesNotMatch(await part(page, 'report').textContent(), /volume/);
    await picture(page);
    await keep(page, 'sheet');
  }));

test('where a key is wanted the page asks for it, and works with it', async () => {
  const guarded = await startService('--auth', 'keys');
  try {
    const data = join(guarded.folder, 'data');
    const key = /fw_\S+|[A-Za-z0-9_-]{30,}/.exec(daemon('keys', 'add', '--label', 'page', '--data', data))?.[0];
    assert.ok(key);
    const { page, faults, context } = await openTab(browser, guarded.url);
    await page.setInputFiles('#files', files('octahedron.glb'));
    await page.getByRole('dialog').waitFor();
    await keep(page, 'key');
    await page.locator('#key').fill(key);
    await page.getByRole('button', { name: 'Use it' }).click();
    await page.getByText(/Noise of about/).waitFor();
    assert.equal(await denoise(page), 'succeeded');
    assert.match(await page.locator('#curl').textContent(), /Authorization: Bearer \$FAIRWAY_KEY/);
    const coming = page.waitForEvent('download');
    await page.locator('.downloads').getByRole('button', { name: 'PLY' }).click();
    assert.match((await coming).suggestedFilename(), /octahedron-denoised\.ply/);
    assert.deepEqual(faults, []);
    await context.close();
  } finally {
    await guarded.stop();
  }
});

test('what was sent compressed is what was built', async () => {
  const text = await (await fetch(service.url)).text();
  for (const [, path] of text.matchAll(/(?:src|href)="(\/assets\/[^"]+)"/g)) {
    const plain = await fetch(service.url + path, { headers: { 'Accept-Encoding': 'identity' } });
    const packed = await fetch(service.url + path, { headers: { 'Accept-Encoding': 'gzip' } });
    const bytes = Buffer.from(await plain.arrayBuffer());
    assert.deepEqual(Buffer.from(await packed.arrayBuffer()), bytes);
    assert.ok(Number(packed.headers.get('content-length')) <= gzipSync(bytes, { level: 9 }).length * 1.02);
    assert.match(plain.headers.get('cache-control'), /immutable/);
  }
});
