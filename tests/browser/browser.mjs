// A service of its own and a browser that looks at it.

import assert from 'node:assert/strict';
import { execFileSync, spawn } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import { join } from 'node:path';
import { chromium } from 'playwright-core';

const bin = process.env.FAIRWAY_BIN;
export const tool = (...words) => execFileSync(join(bin, 'fairway'), words, { encoding: 'utf8' });
export const daemon = (...words) => execFileSync(join(bin, 'fairwayd'), words, { encoding: 'utf8' });

/// Starts fairwayd on a free port. { url, folder, stop }
export async function startService(...words) {
  const folder = mkdtempSync(join(tmpdir(), 'fairway-page-'));
  const child = spawn(join(bin, 'fairwayd'), ['--data', join(folder, 'data'), '--listen', '127.0.0.1:0', '--min-free', '0', ...words]);
  let log = '';
  child.stderr.on('data', (text) => (log += text));
  child.stdout.on('data', (text) => (log += text));
  const url = await new Promise((resolve, reject) => {
    const look = setInterval(() => {
      const found = /listening on (http\S+)/.exec(log);
      if (found) resolve(found[1]);
      if (child.exitCode !== null) reject(new Error(log));
      if (found || child.exitCode !== null) clearInterval(look);
    }, 50);
  });
  const stop = () =>
    new Promise((resolve) => {
      child.on('exit', () => {
        rmSync(folder, { recursive: true, force: true });
        resolve();
      });
      child.kill('SIGTERM');
    });
  return { url, folder, stop };
}

export const launch = () =>
  chromium.launch({
    executablePath: process.env.CHROMIUM,
    args: ['--no-sandbox', '--use-gl=angle', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--enable-precise-memory-info'],
  });

/// A tab that must not complain, nor ask anybody but the service. `faults` collects what it does wrong.
export async function openTab(browser, url, options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, acceptDownloads: true, ...options });
  const page = await context.newPage();
  page.setDefaultTimeout(30000);
  const faults = [];
  page.on('pageerror', (error) => faults.push(error.message));
  page.on('console', (message) => {
    // A refusal of the service is told on the page; the browser logs it, too.
    if (message.type() === 'error' && !/Failed to load resource/.test(message.text())) faults.push(message.text());
  });
  page.on('request', (request) => {
    const asked = request.url();
    if (!asked.startsWith(url) && !/^(blob|data):/.test(asked)) faults.push(`asks ${asked}`);
  });
  await page.addInitScript(() => {
    // Buffers on the graphics side that are alive.
    globalThis.liveBuffers = 0;
    const { createBuffer, deleteBuffer } = WebGL2RenderingContext.prototype;
    WebGL2RenderingContext.prototype.createBuffer = function () {
      globalThis.liveBuffers += 1;
      return createBuffer.call(this);
    };
    WebGL2RenderingContext.prototype.deleteBuffer = function (buffer) {
      if (buffer) globalThis.liveBuffers -= 1;
      return deleteBuffer.call(this, buffer);
    };
  });
  await page.goto(url);
  return { page, faults, context };
}

export const part = (page, name) => page.locator(`[data-test="${name}"]`);

/// Opens files, as a drop or the dialog would, and waits until they are shown.
export async function openMesh(page, files) {
  await page.setInputFiles('#files', files);
  await page.waitForFunction(() => /triangle/.test(document.querySelector('[data-test="file"]')?.textContent ?? ''));
}

/// Presses Denoise and waits for the end of the run. Returns its state.
export async function denoise(page) {
  const before = await part(page, 'run').count();
  await part(page, 'denoise').click();
  const row = part(page, 'run').nth(before);
  await row.waitFor();
  await page.waitForFunction(
    (n) => ['succeeded', 'failed', 'canceled'].includes(document.querySelectorAll('[data-test="run"]')[n]?.dataset.state),
    before,
  );
  const state = await row.getAttribute('data-state');
  if (state === 'succeeded') await part(page, 'result').getByText(`Run ${before + 1}:`).waitFor();
  return state;
}

/// What the viewer shows, once it stands still.
export async function picture(page) {
  const stage = page.locator('.stage');
  let last = await stage.screenshot();
  for (let i = 0; i < 40; ++i) {
    await page.waitForTimeout(100);
    const next = await stage.screenshot();
    if (next.equals(last)) return next;
    last = next;
  }
  assert.fail('the viewer does not come to rest');
}

/// A screenshot that is kept.
export const keep = (page, name) => page.screenshot({ path: `screenshots/${name}.png` });

/// Bytes of script objects after a collection.
export async function heapOf(page) {
  const session = await page.context().newCDPSession(page);
  for (let i = 0; i < 3; ++i) await session.send('HeapProfiler.collectGarbage');
  const { usedSize } = await session.send('Runtime.getHeapUsage');
  await session.detach();
  return usedSize;
}
