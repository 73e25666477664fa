// Bundles the page: source/ to page/, in the folder where this runs. node build.mjs VERSION
// Files of assets/ have their digest in their names, so browsers may keep them for ever.

import { build } from 'esbuild';
import { copyFile, mkdir, readFile, writeFile } from 'node:fs/promises';
import { basename } from 'node:path';

const version = process.argv[2];
const three = JSON.parse(await readFile('node_modules/three/package.json', 'utf8')).version;

// three's loader for Draco asks for its decoder by name.
const draco = `draco-${three}-`;
await mkdir('page/assets', { recursive: true });
for (const file of ['draco_wasm_wrapper.js', 'draco_decoder.wasm']) {
  await copyFile(`node_modules/three/examples/jsm/libs/draco/${file}`, `page/assets/${draco}${file}`);
}

const common = {
  outdir: 'page/assets',
  entryNames: '[name]-[hash]',
  chunkNames: '[name]-[hash]',
  bundle: true,
  format: 'esm',
  target: 'es2022',
  minify: true,
  legalComments: 'none',
  metafile: true,
};
const url = (path) => `/assets/${basename(path)}`;
const outputOf = ({ metafile }, entry) => {
  const found = Object.entries(metafile.outputs).find(([, output]) => output.entryPoint === entry);
  return { path: found[0], imports: found[1].imports };
};

const worker = await build({ ...common, entryPoints: ['source/view/coarse_worker.ts'] });
const page = await build({
  ...common,
  entryPoints: ['source/main.ts', 'source/style.css'],
  splitting: true,
  define: {
    FAIRWAY_VERSION: JSON.stringify(version),
    DRACO_PATH: JSON.stringify(`/assets/${draco}`),
    COARSE_WORKER: JSON.stringify(url(outputOf(worker, 'source/view/coarse_worker.ts').path)),
  },
});
const script = outputOf(page, 'source/main.ts');
const style = outputOf(page, 'source/style.css');
const ahead = script.imports
  .filter((one) => one.kind === 'import-statement')
  .map((one) => `<link rel="modulepreload" href="${url(one.path)}">`);

const html = await readFile('source/index.html', 'utf8');
await writeFile(
  'page/index.html',
  html
    .replace('<!-- style -->', `<link rel="stylesheet" href="${url(style.path)}">`)
    .replace('<!-- script -->', [...ahead, `<script type="module" src="${url(script.path)}"></script>`].join('\n')),
);
