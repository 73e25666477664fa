// A mesh as it is shown: the scene of a file, the surfaces in it, and what lies on them.

import {
  Box3,
  BufferAttribute,
  BufferGeometry,
  InterleavedBufferAttribute,
  LineBasicMaterial,
  LineSegments,
  Material,
  Mesh,
  Object3D,
  Points,
  PointsMaterial,
  Texture,
  Vector3,
} from 'three';
import { coarsen } from './coarse';
import type { Quantity } from './quantities';
import type { SurfaceMaterial } from './surface_material';

type Attribute = BufferAttribute | InterleavedBufferAttribute;

/// How many principal directions are drawn at most: more is a carpet.
const kMostDirections = 6000;

export class Model {
  readonly box = new Box3();
  readonly vertices: number;
  readonly triangles: number;
  readonly features: number;
  private readonly meshes: Mesh[] = [];
  private readonly materials = new Map<Mesh, Material | Material[]>();
  private readonly twins = new Map<Mesh, Mesh>(); ///< in few triangles, where there are any
  private coarsening: Promise<void> | null = null;
  private overlays: Object3D[] = [];
  private directions: Object3D[] = [];

  constructor(readonly root: Object3D) {
    root.updateMatrixWorld(true);
    root.traverse((object) => {
      if (object instanceof Mesh) this.meshes.push(object);
    });
    let vertices = 0;
    let triangles = 0;
    let features = 0;
    for (const mesh of this.meshes) {
      const geometry = mesh.geometry as BufferGeometry;
      this.materials.set(mesh, mesh.material as Material | Material[]);
      if (!geometry.hasAttribute('normal')) geometry.computeVertexNormals();
      vertices += geometry.getAttribute('position').count;
      triangles += (geometry.index?.count ?? geometry.getAttribute('position').count) / 3;
      features += indicesOfFeatures(geometry).length;
    }
    this.vertices = vertices;
    this.triangles = Math.floor(triangles);
    this.features = features;
    this.box.setFromObject(root);
  }

  has(quantity: Quantity): boolean {
    return this.meshes.some((mesh) => mesh.geometry.hasAttribute(quantity.attribute));
  }

  hasDirections(): boolean {
    return this.meshes.some((mesh) => mesh.geometry.hasAttribute('_curvature_dir1'));
  }

  /// All values of a quantity, one array for each mesh that has it.
  values(quantity: Quantity): Float32Array[] {
    const found: Float32Array[] = [];
    for (const mesh of this.meshes) {
      const attribute = mesh.geometry.getAttribute(quantity.attribute) as Attribute | undefined;
      if (attribute) found.push(floatsOf(attribute));
    }
    return found;
  }

  /// Shows the surfaces with `material`, or as the file has them where there is none.
  dress(material: SurfaceMaterial | null, quantity: Quantity | null): void {
    for (const mesh of this.meshes) {
      const geometry = mesh.geometry as BufferGeometry;
      const own = quantity && geometry.getAttribute(quantity.attribute);
      if (own) geometry.setAttribute('value', own);
      else geometry.deleteAttribute('value');
      mesh.material = material ?? this.materials.get(mesh)!;
      const twin = this.twins.get(mesh);
      if (twin) dressTwin(twin, mesh);
    }
  }

  /// Makes what `showCoarse` shows: about `triangles` in all. Once.
  prepareCoarse(triangles: number): Promise<void> {
    this.coarsening ??= (async () => {
      for (const mesh of this.meshes) {
        const { index, attributes } = mesh.geometry as BufferGeometry;
        const position = attributes.position as Attribute;
        const share = Math.ceil((triangles * (index?.count ?? 0)) / 3 / this.triangles);
        if (!index || 3 * share > 0.7 * index.count) continue;
        const corners = await coarsen(placesOf(position), Uint32Array.from(index.array), Math.max(share, 4));
        const twin = mesh.clone(false);
        twin.geometry = new BufferGeometry().setIndex(new BufferAttribute(corners, 1));
        twin.layers.disableAll();
        dressTwin(twin, mesh);
        this.twins.set(mesh, twin);
        mesh.parent?.add(twin);
      }
    })();
    return this.coarsening;
  }

  showCoarse(on: boolean): void {
    for (const [mesh, twin] of this.twins) {
      mesh.layers.disableAll();
      twin.layers.disableAll();
      (on ? twin : mesh).layers.enable(0);
    }
  }

  showFeatures(on: boolean, colour: number): void {
    if (on && this.overlays.length === 0) {
      for (const mesh of this.meshes) this.overlays.push(...featurePoints(mesh, colour));
    }
    for (const overlay of this.overlays) overlay.visible = on;
  }

  showDirections(on: boolean): void {
    if (on && this.directions.length === 0) {
      const stride = Math.max(1, Math.ceil(this.vertices / kMostDirections));
      for (const mesh of this.meshes) this.directions.push(...directionLines(mesh, stride));
    }
    for (const lines of this.directions) lines.visible = on;
  }

  /// Gives back all that the graphics hold of it.
  dispose(): void {
    this.root.traverse((object) => {
      if (object instanceof Mesh || object instanceof Points || object instanceof LineSegments) {
        object.geometry.dispose();
      }
      if (object instanceof Points || object instanceof LineSegments) (object.material as Material).dispose();
    });
    for (const material of [...this.materials.values()].flat()) {
      for (const value of Object.values(material)) if (value instanceof Texture) value.dispose();
      material.dispose();
    }
    this.root.removeFromParent();
  }
}

/// A twin has the vertices and the look of its mesh.
function dressTwin(twin: Mesh, mesh: Mesh): void {
  twin.geometry.attributes = mesh.geometry.attributes;
  twin.geometry.morphAttributes = mesh.geometry.morphAttributes;
  twin.geometry.boundingSphere = mesh.geometry.boundingSphere;
  twin.material = mesh.material;
}

/// Coordinates without gaps.
function placesOf(position: Attribute): Float32Array {
  const plain = !(position instanceof InterleavedBufferAttribute) && position.array instanceof Float32Array;
  if (plain) return position.array as Float32Array;
  const places = new Float32Array(3 * position.count);
  const at = new Vector3();
  for (let i = 0; i < position.count; ++i) at.fromBufferAttribute(position, i).toArray(places, 3 * i);
  return places;
}

function floatsOf(attribute: Attribute): Float32Array {
  const plain = !(attribute instanceof InterleavedBufferAttribute) && attribute.itemSize === 1;
  if (plain && attribute.array instanceof Float32Array) return attribute.array;
  return Float32Array.from({ length: attribute.count }, (_, i) => attribute.getX(i));
}

function indicesOfFeatures(geometry: BufferGeometry): number[] {
  const feature = geometry.getAttribute('_feature') as Attribute | undefined;
  const found: number[] = [];
  for (let i = 0; feature && i < feature.count; ++i) if (feature.getX(i) > 0.5) found.push(i);
  return found;
}

function featurePoints(mesh: Mesh, colour: number): Object3D[] {
  const indices = indicesOfFeatures(mesh.geometry);
  if (indices.length === 0) return [];
  const position = mesh.geometry.getAttribute('position') as Attribute;
  const places = new Float32Array(3 * indices.length);
  const at = new Vector3();
  indices.forEach((vertex, i) => at.fromBufferAttribute(position, vertex).toArray(places, 3 * i));
  const geometry = new BufferGeometry().setAttribute('position', new BufferAttribute(places, 3));
  const points = new Points(geometry, new PointsMaterial({ color: colour, size: 3.5, sizeAttenuation: false }));
  mesh.add(points);
  return [points];
}

/// Length of an average edge, from a sample.
function edgeLength(geometry: BufferGeometry): number {
  const position = geometry.getAttribute('position') as Attribute;
  const corners = geometry.index?.count ?? position.count;
  const corner = (i: number): number => geometry.index?.getX(i) ?? i;
  const stride = 3 * Math.max(1, Math.floor(corners / 3 / 2000));
  const [a, b] = [new Vector3(), new Vector3()];
  let sum = 0;
  let n = 0;
  for (let i = 0; i + 2 < corners; i += stride, ++n) {
    sum += a.fromBufferAttribute(position, corner(i)).distanceTo(b.fromBufferAttribute(position, corner(i + 1)));
  }
  return n ? sum / n : 0;
}

/// Crosses of both principal directions at every `stride`-th vertex.
function directionLines(mesh: Mesh, stride: number): Object3D[] {
  const geometry = mesh.geometry as BufferGeometry;
  const position = geometry.getAttribute('position') as Attribute;
  // Where fewer are drawn each may be longer.
  const half = 0.35 * edgeLength(geometry) * Math.sqrt(stride);
  const lines: Object3D[] = [];
  const [at, direction, end] = [new Vector3(), new Vector3(), new Vector3()];
  for (const [name, colour] of [['_curvature_dir1', 0xb3261e], ['_curvature_dir2', 0x1f4fa3]] as const) {
    const attribute = geometry.getAttribute(name) as Attribute | undefined;
    if (!attribute) continue;
    const ends: number[] = [];
    for (let i = 0; i < position.count; i += stride) {
      direction.fromBufferAttribute(attribute, i);
      if (direction.lengthSq() === 0) continue;
      at.fromBufferAttribute(position, i);
      ends.push(...end.copy(at).addScaledVector(direction, -half), ...end.copy(at).addScaledVector(direction, half));
    }
    const shape = new BufferGeometry().setAttribute('position', new BufferAttribute(new Float32Array(ends), 3));
    const drawn = new LineSegments(shape, new LineBasicMaterial({ color: colour }));
    mesh.add(drawn);
    lines.push(drawn);
  }
  return lines;
}
