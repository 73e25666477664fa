// How a surface looks when it is judged: plain clay or a quantity as colour, lit from the eye, flat or
// smooth. Light is all there is to compute for a pixel, so that a processor can draw it, too.

import { DataTexture, DoubleSide, LinearFilter, ShaderMaterial, Vector3 } from 'three';
import { colourTable } from './colours';

const kVertex = `
  attribute float value;
  varying float vValue;
  varying vec3 vEye;
  varying vec3 vNormalEye;
  #include <common>
  #include <morphtarget_pars_vertex>
  #include <skinning_pars_vertex>
  void main() {
    vValue = value;
    #include <beginnormal_vertex>
    #include <morphinstance_vertex>
    #include <morphnormal_vertex>
    #include <skinbase_vertex>
    #include <skinnormal_vertex>
    #include <defaultnormal_vertex>
    vNormalEye = transformedNormal;
    #include <begin_vertex>
    #include <morphtarget_vertex>
    #include <skinning_vertex>
    #include <project_vertex>
    vEye = mvPosition.xyz;
  }`;

const kFragment = `
  uniform sampler2D table;
  uniform float low;
  uniform float high;
  uniform vec3 clay;
  uniform bool coloured;
  uniform bool flatShaded;
  varying float vValue;
  varying vec3 vEye;
  varying vec3 vNormalEye;
  void main() {
    vec3 normal = flatShaded ? normalize(cross(dFdx(vEye), dFdy(vEye))) : normalize(vNormalEye);
    vec3 toEye = normalize(-vEye);
    if (dot(normal, toEye) < 0.0) normal = -normal;
    float light = 0.42 + 0.46 * max(dot(normal, normalize(vec3(-0.35, 0.55, 0.75))), 0.0) + 0.2 * dot(normal, toEye);
    vec3 colour = clay;
    if (coloured) colour = texture2D(table, vec2((vValue - low) / (high - low), 0.5)).rgb;
    gl_FragColor = vec4(colour * light, 1.0);
  }`;

export function makeTable(): DataTexture {
  const n = 512;
  const table = new DataTexture(colourTable(n), n, 1);
  table.magFilter = LinearFilter;
  table.minFilter = LinearFilter;
  table.needsUpdate = true;
  return table;
}

export class SurfaceMaterial extends ShaderMaterial {
  constructor(table: DataTexture) {
    super({
      vertexShader: kVertex,
      fragmentShader: kFragment,
      side: DoubleSide,
      uniforms: {
        table: { value: table },
        low: { value: -1 },
        high: { value: 1 },
        clay: { value: new Vector3(0.9, 0.88, 0.84) },
        coloured: { value: false },
        flatShaded: { value: true },
      },
      polygonOffset: true,
      polygonOffsetFactor: 1,
      polygonOffsetUnits: 1,
    });
  }

  show(options: { coloured: boolean; low: number; high: number; flat: boolean; wireframe: boolean }): void {
    const uniforms = this.uniforms;
    uniforms.coloured!.value = options.coloured;
    uniforms.low!.value = options.low;
    uniforms.high!.value = options.high;
    uniforms.flatShaded!.value = options.flat;
    this.wireframe = options.wireframe;
  }
}
