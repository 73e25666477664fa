// Two meshes under one camera: one over the other with a split between them, side by side, or one alone.

import {
  AmbientLight,
  Box3,
  DirectionalLight,
  PerspectiveCamera,
  Scene,
  Sphere,
  Vector3,
  WebGLRenderer,
} from 'three';
import { OrbitControls } from 'three/examples/jsm/controls/OrbitControls.js';
import { Model } from './model';
import type { Quantity } from './quantities';
import { makeTable, SurfaceMaterial } from './surface_material';

export type Side = 'before' | 'after';
export type Layout = 'split' | 'side' | Side;

export interface Look {
  layout: Layout;
  quantity: Quantity | null; ///< as colour
  original: boolean; ///< materials as the file has them
  low: number;
  high: number;
  flat: boolean;
  wireframe: boolean;
  features: boolean;
  directions: boolean;
}

const kFeatureColour = 0xe07b00;

/// While the camera moves a frame that takes longer than this, in ms, makes the next ones coarser: first
/// in triangles, then in pixels.
const kSlowFrame = 42;
/// So many triangles a mesh is enough while it moves, where drawing is slow.
const kMovingTriangles = 8000;
const kMostCoarse = 2.2;

function drawsBySoftware(): boolean {
  const probe = document.createElement('canvas').getContext('webgl2', { failIfMajorPerformanceCaveat: true });
  if (!probe) return true;
  const names = probe.getExtension('WEBGL_debug_renderer_info');
  const name = String(probe.getParameter(names ? names.UNMASKED_RENDERER_WEBGL : probe.RENDERER));
  probe.getExtension('WEBGL_lose_context')?.loseContext();
  return /swiftshader|llvmpipe|softpipe|software|basic render/i.test(name);
}

export class Viewer {
  private readonly splits = { split: 0.5, side: 0.5 };
  private readonly renderer: WebGLRenderer;
  private readonly scenes = { before: new Scene(), after: new Scene() };
  private readonly camera = new PerspectiveCamera(35, 1, 0.01, 100);
  private readonly controls: OrbitControls;
  private readonly lamps: DirectionalLight[] = [];
  private readonly material = new SurfaceMaterial(makeTable());
  private models: { before: Model | null; after: Model | null } = { before: null, after: null };
  private look: Look | null = null;
  private pending = 0;
  private moving = false;
  private slow = false; ///< this machine cannot draw all of what is shown while it moves
  private coarseness = 1; ///< of pixels
  private lastFrame = 0;

  constructor(private readonly canvas: HTMLCanvasElement) {
    // A processor that draws does not smooth edges, too: that costs four times the pixels.
    this.slow = drawsBySoftware();
    this.renderer = new WebGLRenderer({ canvas, antialias: !this.slow, alpha: true });
    this.renderer.setClearColor(0x000000, 0);
    this.renderer.autoClear = false;
    for (const scene of Object.values(this.scenes)) {
      const lamp = new DirectionalLight(0xffffff, 2.2);
      scene.add(new AmbientLight(0xffffff, 0.9), lamp);
      this.lamps.push(lamp);
    }
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.addEventListener('start', () => this.move());
    this.controls.addEventListener('end', () => this.rest());
    this.controls.addEventListener('change', () => this.draw());
    new ResizeObserver(() => this.resize()).observe(canvas);
    this.resize();
  }

  /// Puts a mesh on one side; the one that was there is not disposed of.
  put(side: Side, model: Model | null): void {
    const old = this.models[side];
    if (old === model) return;
    if (old) this.scenes[side].remove(old.root);
    this.models[side] = model;
    if (model) this.scenes[side].add(model.root);
    if (this.slow) this.prepare();
    if (this.look) this.apply(this.look);
  }

  /// Where the two sides part, as a share of the width; each layout has its own.
  get split(): number {
    return this.splits[this.look?.layout === 'side' ? 'side' : 'split'];
  }

  set split(share: number) {
    this.splits[this.look?.layout === 'side' ? 'side' : 'split'] = share;
    this.draw();
  }

  model(side: Side): Model | null {
    return this.models[side];
  }

  apply(look: Look): void {
    this.look = look;
    this.material.show({
      coloured: !!look.quantity && !look.original,
      low: look.low,
      high: look.high,
      flat: look.flat,
      wireframe: look.wireframe,
    });
    for (const model of this.shown()) {
      const coloured = look.quantity && model.has(look.quantity) ? look.quantity : null;
      model.dress(look.original ? null : this.material, coloured);
      model.showFeatures(look.features, kFeatureColour);
      model.showDirections(look.directions);
    }
    this.draw();
  }

  /// Turns the camera to see all there is.
  fit(): void {
    const box = new Box3();
    for (const model of Object.values(this.models)) if (model) box.union(model.box);
    if (box.isEmpty()) return;
    const ball = box.getBoundingSphere(new Sphere());
    const radius = Math.max(ball.radius, 1e-12);
    const distance = (1.12 * radius) / Math.sin((this.camera.fov * Math.PI) / 360);
    this.camera.near = distance / 200;
    this.camera.far = distance * 20;
    this.controls.target.copy(ball.center);
    this.camera.position.copy(ball.center).addScaledVector(new Vector3(0.55, 0.6, 0.9).normalize(), distance);
    this.controls.minDistance = radius / 50;
    this.controls.maxDistance = distance * 6;
    this.controls.update();
    this.draw();
  }

  /// Turns around the mesh, for keys: radians to the right and up.
  turn(right: number, up: number): void {
    const offset = this.camera.position.clone().sub(this.controls.target);
    const side = new Vector3(1, 0, 0).applyQuaternion(this.camera.quaternion);
    offset.applyAxisAngle(this.camera.up, right);
    const tilted = offset.clone().applyAxisAngle(side, -up);
    if (Math.abs(tilted.clone().normalize().dot(this.camera.up)) < 0.98) offset.copy(tilted);
    this.camera.position.copy(this.controls.target).add(offset);
    this.controls.update();
    this.draw();
  }

  /// Nearer (below 1) or farther.
  zoom(factor: number): void {
    this.camera.position.sub(this.controls.target).multiplyScalar(factor).add(this.controls.target);
    this.controls.update();
    this.draw();
  }

  draw(): void {
    this.pending ||= requestAnimationFrame((now) => this.frame(now));
  }

  /// What three.js keeps on the graphics side, for tests.
  memory(): { geometries: number; textures: number } {
    return { geometries: this.renderer.info.memory.geometries, textures: this.renderer.info.memory.textures };
  }

  private shown(): Set<Model> {
    return new Set(Object.values(this.models).filter((model) => !!model));
  }

  /// Large meshes get a coarse twin beside the page.
  private prepare(): void {
    this.slow = true;
    for (const model of this.shown()) {
      if (model.triangles < 2 * kMovingTriangles) continue;
      model.prepareCoarse(kMovingTriangles).catch((error: unknown) => console.warn(error));
    }
  }

  private move(): void {
    this.moving = true;
    this.lastFrame = 0;
    if (this.slow) for (const model of this.shown()) model.showCoarse(true);
    if (this.coarseness > 1) this.resize();
  }

  /// At rest all of it is drawn. How coarse the next movement begins is kept.
  private rest(): void {
    this.moving = false;
    for (const model of this.shown()) model.showCoarse(false);
    this.resize();
  }

  /// Both sides have one scale: that in which the narrower one sees about what a square would.
  private scale(): number {
    const { clientWidth: width, clientHeight: height } = this.canvas;
    const share = this.look?.layout === 'side' ? Math.min(this.split, 1 - this.split) : 1;
    return Math.min(1, (1.2 * share * width) / Math.max(height, 1));
  }

  private resize(): void {
    const ratio = Math.min(devicePixelRatio, 2) / (this.moving ? this.coarseness : 1);
    if (this.renderer.getPixelRatio() !== ratio) this.renderer.setPixelRatio(ratio);
    this.renderer.setSize(this.canvas.clientWidth, this.canvas.clientHeight, false);
    this.draw();
  }

  private frame(now: number): void {
    this.pending = 0;
    const took = now - this.lastFrame;
    if (this.moving && this.lastFrame > 0 && took > kSlowFrame && took < 2000) this.coarser();
    this.lastFrame = now;
    const { clientWidth: width, clientHeight: height } = this.canvas;
    if (width === 0 || height === 0) return;
    this.renderer.setScissorTest(false);
    this.renderer.clear();
    for (const lamp of this.lamps) lamp.position.set(-0.35, 0.55, 0.75).applyQuaternion(this.camera.quaternion);
    const layout = this.look?.layout ?? 'split';
    const cut = Math.round(width * this.split);
    if (layout === 'before' || layout === 'after') {
      this.drawSide(layout, 0, 0, width, width);
    } else if (layout === 'side') {
      this.drawSide('before', 0, 0, cut, cut);
      this.drawSide('after', cut, cut, width - cut, width - cut);
    } else {
      this.drawSide('before', 0, 0, cut, width);
      this.drawSide('after', 0, cut, width - cut, width);
    }
  }

  /// After a slow frame.
  private coarser(): void {
    if (!this.slow) {
      this.prepare();
    } else if (this.coarseness < kMostCoarse) {
      this.coarseness *= 1.2;
      this.resize();
      cancelAnimationFrame(this.pending);
      this.pending = 0;
    }
    for (const model of this.shown()) model.showCoarse(true);
  }

  /// One scene in a window from `left`, `width` wide, of a picture from `origin`, `full` wide.
  private drawSide(side: Side, origin: number, left: number, width: number, full: number): void {
    if (width <= 0 || !this.models[side]) return;
    const height = this.canvas.clientHeight;
    this.renderer.setViewport(origin, 0, full, height);
    this.renderer.setScissor(left, 0, width, height);
    this.renderer.setScissorTest(true);
    this.camera.aspect = full / height;
    this.camera.zoom = this.scale();
    this.camera.updateProjectionMatrix();
    this.renderer.render(this.scenes[side], this.camera);
  }
}
