// Files to scenes. Loaders come when a file of their kind does.

import { BufferGeometry, Group, LoadingManager, Mesh, MeshStandardMaterial, Object3D } from 'three';
import { fileNameOf } from '../api';

/// A scene, or why there is none; the service may read what this page does not.
export async function loadFiles(files: File[]): Promise<Object3D> {
  const main = files[0]!;
  const kind = main.name.split('.').pop()?.toLowerCase() ?? '';
  switch (kind) {
    case 'glb':
    case 'gltf':
      return loadGltf(main, files.slice(1));
    case 'ply': {
      const { PLYLoader } = await import('three/examples/jsm/loaders/PLYLoader.js');
      return sceneOf(new PLYLoader().parse(await main.arrayBuffer()));
    }
    case 'stl': {
      const { STLLoader } = await import('three/examples/jsm/loaders/STLLoader.js');
      return sceneOf(await welded(new STLLoader().parse(await main.arrayBuffer())));
    }
    case 'obj': {
      const { OBJLoader } = await import('three/examples/jsm/loaders/OBJLoader.js');
      return weldedScene(new OBJLoader().parse(await main.text()));
    }
    case 'drc':
      return sceneOf(await loadDraco(main));
    default:
      throw new Error(`This page cannot show a file of the kind “${kind}”.`);
  }
}

/// Corners that the format repeats become one vertex, so that smooth shading is smooth.
async function welded(geometry: BufferGeometry): Promise<BufferGeometry> {
  const { mergeVertices } = await import('three/examples/jsm/utils/BufferGeometryUtils.js');
  geometry.deleteAttribute('normal');
  return mergeVertices(geometry, 0);
}

async function weldedScene(scene: Object3D): Promise<Object3D> {
  const meshes: Mesh[] = [];
  scene.traverse((object) => object instanceof Mesh && meshes.push(object));
  for (const mesh of meshes) {
    const old = mesh.geometry as BufferGeometry;
    old.deleteAttribute('uv');
    mesh.geometry = await welded(old);
    old.dispose();
  }
  return scene;
}

function sceneOf(geometry: BufferGeometry): Object3D {
  const material = new MeshStandardMaterial({ vertexColors: geometry.hasAttribute('color') });
  return new Group().add(new Mesh(geometry, material));
}

async function dracoLoader(manager?: LoadingManager) {
  const { DRACOLoader } = await import('three/examples/jsm/loaders/DRACOLoader.js');
  return new DRACOLoader(manager).setDecoderPath(DRACO_PATH).setWorkerLimit(1);
}

async function loadDraco(file: File): Promise<BufferGeometry> {
  const loader = await dracoLoader();
  const url = URL.createObjectURL(file);
  try {
    return await loader.loadAsync(url);
  } finally {
    URL.revokeObjectURL(url);
    loader.dispose();
  }
}

/// A glTF finds its side files among those that were dropped with it, never on the network.
async function loadGltf(main: File, others: File[]): Promise<Object3D> {
  const [{ GLTFLoader }, { MeshoptDecoder }] = await Promise.all([
    import('three/examples/jsm/loaders/GLTFLoader.js'),
    import('three/examples/jsm/libs/meshopt_decoder.module.js'),
  ]);
  const urls: string[] = [];
  const manager = new LoadingManager();
  manager.setURLModifier((url) => {
    if (url.startsWith('blob:') || url.startsWith('data:') || url.startsWith(DRACO_PATH)) return url;
    const name = fileNameOf(url);
    const file = others.find((other) => other.name === name);
    if (!file) throw new Error(`The glTF names ${name}: drop it together with the .gltf.`);
    const made = URL.createObjectURL(file);
    urls.push(made);
    return made;
  });
  const draco = await dracoLoader(manager);
  const loader = new GLTFLoader(manager).setDRACOLoader(draco).setMeshoptDecoder(MeshoptDecoder);
  try {
    return (await loader.parseAsync(await main.arrayBuffer(), '')).scene;
  } finally {
    urls.forEach((url) => URL.revokeObjectURL(url));
    draco.dispose();
  }
}
