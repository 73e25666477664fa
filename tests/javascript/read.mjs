// Reads what fairway wrote with the packages that web clients use, and compares it with the plain
// GLB of the same result. Usage: node read.mjs FOLDER (made by run.sh).
import assert from 'node:assert/strict';
import { readFileSync } from 'node:fs';
import path from 'node:path';

import { NodeIO } from '@gltf-transform/core';
import { ALL_EXTENSIONS } from '@gltf-transform/extensions';
import draco3d from 'draco3d';
import { MeshoptDecoder } from 'meshoptimizer';

const folder = process.argv[2];
const curvature = ['_CURVATURE_K1', '_CURVATURE_K2', '_CURVATURE_MEAN', '_CURVATURE_DIR1'];
const names = ['POSITION', ...curvature];
// The notes state three digits of each error.
const kLastDigit = 1.006;

const draco = await draco3d.createDecoderModule({});
await MeshoptDecoder.ready;
const io = new NodeIO().registerExtensions(ALL_EXTENSIONS).registerDependencies({
  'draco3d.decoder': draco,
  'meshopt.decoder': MeshoptDecoder,
});

const file = (name) => path.join(folder, name);

/** What the notes of a run say an attribute is off by at most; 0 where it is exact. */
function statedError(log, name) {
  const text = readFileSync(file(log), 'utf8');
  const off = new RegExp(`[ ;]${name} is off by at most ([-+.e0-9]+)`).exec(text);
  if (off) return Number(off[1]) * kLastDigit;
  assert.match(text, new RegExp(`[ ;]${name} is exact`), `${log} does not state ${name}`);
  return 0;
}

/** The only primitive of a GLB: its indices, its attributes by name, the extensions it needs. */
async function readGlb(name) {
  const document = await io.read(file(name));
  const primitives = document.getRoot().listMeshes().flatMap((mesh) => mesh.listPrimitives());
  assert.equal(primitives.length, 1, name);
  const [primitive] = primitives;
  const attributes = {};
  for (const semantic of primitive.listSemantics()) {
    attributes[semantic] = primitive.getAttribute(semantic).getArray();
  }
  const required = document.getRoot().listExtensionsRequired().map((e) => e.extensionName);
  return { indices: primitive.getIndices().getArray(), attributes, required };
}

function dracoFloats(decoder, mesh, id) {
  const values = new draco.DracoFloat32Array();
  assert.ok(decoder.GetAttributeFloatForAllPoints(mesh, decoder.GetAttribute(mesh, id), values));
  const out = Float32Array.from({ length: values.size() }, (_, i) => values.GetValue(i));
  draco.destroy(values);
  return out;
}

/** A .drc by draco3d alone: the curvature is found by the metadata of generic attributes. */
function readDrc(name) {
  const decoder = new draco.Decoder();
  const mesh = new draco.Mesh();
  const bytes = new Int8Array(readFileSync(file(name)));
  const status = decoder.DecodeArrayToMesh(bytes, bytes.length, mesh);
  assert.ok(status.ok(), `${name}: ${status.error_msg()}`);
  const attributes = {};
  const position = decoder.GetAttributeId(mesh, draco.POSITION);
  attributes.POSITION = dracoFloats(decoder, mesh, position);
  for (const wanted of curvature) {
    const id = decoder.GetAttributeIdByMetadataEntry(mesh, 'name', wanted);
    assert.ok(id >= 0, `${name} has no generic attribute of the name ${wanted}`);
    attributes[wanted] = dracoFloats(decoder, mesh, id);
  }
  const indices = [];
  const face = new draco.DracoInt32Array();
  for (let f = 0; f < mesh.num_faces(); ++f) {
    decoder.GetFaceFromMesh(mesh, f, face);
    indices.push(face.GetValue(0), face.GetValue(1), face.GetValue(2));
  }
  draco.destroy(face);
  draco.destroy(mesh);
  draco.destroy(decoder);
  return { indices, attributes, required: [] };
}

function largestError(found, expected, what) {
  assert.equal(found.length, expected.length, what);
  return found.reduce((worst, value, i) => {
    const error = Math.abs(value - expected[i]);
    assert.ok(Number.isFinite(error), what);
    return Math.max(worst, error);
  }, 0);
}

/** `log` states what may be lost; without one nothing may. */
function compare(what, found, expected, log) {
  assert.deepEqual(Array.from(found.indices), Array.from(expected.indices), `${what}: triangles`);
  const told = names.map((name) => {
    const allowed = log ? statedError(log, name) : 0;
    const error = largestError(found.attributes[name], expected.attributes[name], what);
    assert.ok(error <= allowed, `${what}: ${name} is off by ${error}, stated is ${allowed}`);
    return `${name} ${error.toPrecision(3)} of ${allowed.toPrecision(3)}`;
  });
  console.log(`${what}: ${told.join(', ')}`);
}

const kDraco = 'KHR_draco_mesh_compression';
const kMeshopt = 'EXT_meshopt_compression';

for (const way of ['scene', 'fresh']) {
  const plain = await readGlb(`${way}.glb`);
  assert.ok(plain.attributes.POSITION.length > 1000);
  assert.ok(plain.attributes._CURVATURE_K1.some((k) => Math.abs(k) > 0.01));
  assert.deepEqual(plain.required, []);
  const compressed = await readGlb(`${way}-draco.glb`);
  assert.deepEqual(compressed.required, [kDraco]);
  compare(`${way}, GLB with Draco`, compressed, plain, `${way}-draco.glb.log`);
  const lossless = await readGlb(`${way}-meshopt.glb`);
  assert.deepEqual(lossless.required, [kMeshopt]);
  compare(`${way}, GLB with meshopt`, lossless, plain);
  compare(`${way}, Draco`, readDrc(`${way}.drc`), plain, `${way}.drc.log`);
}
