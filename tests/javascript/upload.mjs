// Uploads a mesh to fairwayd with tus-js-client: in pieces, resumed after a break, past a connection
// of which only the server believes that it lives, and ended.
// Usage: node upload.mjs http://HOST:PORT FILE
import assert from 'node:assert/strict';
import { createHash } from 'node:crypto';
import { readFileSync } from 'node:fs';
import { connect } from 'node:net';
import { setTimeout as sleep } from 'node:timers/promises';

import * as tus from 'tus-js-client';

const [server, path] = process.argv.slice(2);
const file = readFileSync(path);
const options = {
  endpoint: `${server}/v1/uploads`,
  chunkSize: Math.ceil(file.length / 5),
  metadata: { filename: 'mesh.glb', filetype: 'model/gltf-binary' },
};

/** Uploads, from where `more` says; `stop` breaks off after so many pieces. Returns the address. */
function upload(more, stop = Infinity) {
  return new Promise((resolve, reject) => {
    let pieces = 0;
    const task = new tus.Upload(file, {
      ...options,
      ...more,
      onError: reject,
      onSuccess: () => resolve({ url: task.url, pieces }),
      onChunkComplete: () => {
        if (++pieces === stop) task.abort().then(() => resolve({ url: task.url, pieces }), reject);
      },
    });
    task.start();
  });
}

/** Bytes of an upload in a connection that brings no more; ends when the server has kept some. */
async function stall(url) {
  const { hostname, port, pathname } = new URL(url);
  const head = { method: 'HEAD', headers: { 'Tus-Resumable': '1.0.0' } };
  const offset = Number((await fetch(url, head)).headers.get('upload-offset'));
  const socket = connect(Number(port), hostname);
  socket.on('error', () => {});
  socket.write(`PATCH ${pathname} HTTP/1.1\r\nHost: ${hostname}\r\nTus-Resumable: 1.0.0\r\n`
    + `Upload-Offset: ${offset}\r\nContent-Type: application/offset+octet-stream\r\n`
    + `Content-Length: ${file.length - offset}\r\n\r\n`);
  socket.write(file.subarray(offset, offset + 100));
  for (;;) {
    const now = Number((await fetch(url, head)).headers.get('upload-offset'));
    if (now > offset) return socket;
    await sleep(20);
  }
}

async function answer(url, init) {
  const response = await fetch(url, init);
  assert.ok(response.ok, `${url}: ${response.status} ${await response.clone().text()}`);
  return response.json();
}

const broken = await upload({}, 2);
const resumed = await upload({ uploadUrl: broken.url });
assert.equal(resumed.url, broken.url);
assert.ok(resumed.pieces < 5, 'the pieces that were there came once more');
const id = new URL(resumed.url).pathname.split('/').pop();
const submitted = await answer(`${server}/v1/jobs?upload=${id}`, { method: 'POST' });
assert.equal(submitted.input.sha256, createHash('sha256').update(file).digest('hex'));
assert.equal(submitted.input.format, 'glb');
let job = submitted;
while (job.state === 'queued' || job.state === 'running') {
  await sleep(50);
  job = await answer(server + submitted.links.self);
}
assert.equal(job.state, 'succeeded', JSON.stringify(job));

const cut = await upload({}, 1);
const dead = await stall(cut.url);
const past = await upload({ uploadUrl: cut.url });
dead.destroy();
assert.equal(past.url, cut.url);

const first = await upload({ uploadDataDuringCreation: true }, 1);
await tus.Upload.terminate(first.url);
const gone = await fetch(first.url, { method: 'HEAD', headers: { 'Tus-Resumable': '1.0.0' } });
assert.equal(gone.status, 404);
console.log(`tus: ${broken.pieces} and ${resumed.pieces} pieces, job ${job.state}`);
