// Lines of the 3-D view: the way of the eye, the solid of a view, a ground grid.
import {
  BufferGeometry, Color, DoubleSide, Float32BufferAttribute, GridHelper, Group, Mesh, MeshBasicMaterial, SphereGeometry, type Material, type Object3D,
} from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';
import type { Vector } from './data.ts';
import { colour } from './dom.ts';

// Lines come and go with every frame; their materials stay, since compiling a shader stalls the view.
const materials = new Map<string, Material>();

function lasting<M extends Material>(key: string, make: () => M): M {
  const known = (materials.get(key) as M | undefined) ?? make();
  materials.set(key, known);
  return known;
}

/** Takes an object out of its scene and frees its geometry. */
export function free(object: Object3D): void {
  object.traverse((part) => (part as Partial<Mesh>).geometry?.dispose());
  object.removeFromParent();
}

function segments(points: number[], name: string, width: number, opacity: number, in_front: boolean): LineSegments2 {
  const geometry = new LineSegmentsGeometry();
  geometry.setPositions(points);
  const tint = colour(name);
  const material = lasting(`${tint} ${width} ${opacity} ${in_front}`, () => {
    const made = new LineMaterial({ linewidth: width, transparent: opacity < 1, opacity, depthTest: !in_front });
    made.color = new Color(tint);
    return made;
  });
  const line = new LineSegments2(geometry, material);
  line.renderOrder = in_front ? 2 : 1;
  line.frustumCulled = false;
  return line;
}

/** The way of the eye, seen through the boxes faintly and where nothing covers it fully. */
export function path_line(eyes: Vector[]): Object3D {
  const points: number[] = [];
  for (let i = 1; i < eyes.length; ++i) points.push(...eyes[i - 1], ...eyes[i]);
  const group = new Group();
  if (points.length === 0) return group;
  group.add(segments(points, '--path', 2, 0.45, true), segments(points, '--path', 2.5, 1, false));
  return group;
}

/** The faces of the solid of a view, as lines; a bold one also has faintly filled sides. */
export function view_lines(faces: Vector[][], bold: boolean): Object3D {
  const group = new Group();
  const points = faces.flatMap((face) => face.flatMap((point, index) => [point, face[(index + 1) % face.length]])).flat();
  if (points.length === 0) return group;
  group.add(segments(points, '--view', bold ? 1.6 : 1, bold ? 0.25 : 0.12, true), segments(points, '--view', bold ? 2 : 1, bold ? 1 : 0.4, false));
  if (!bold) return group;
  const triangles = faces.flatMap((face) => face.slice(2).flatMap((point, index) => [face[0], face[index + 1], point])).flat();
  const filled = new BufferGeometry();
  filled.setAttribute('position', new Float32BufferAttribute(triangles, 3));
  const sides = new Mesh(filled, lasting(`sides ${colour('--view')}`, () =>
    new MeshBasicMaterial({ color: colour('--view'), transparent: true, opacity: 0.06, side: DoubleSide, depthWrite: false })));
  sides.renderOrder = 1;
  sides.frustumCulled = false;
  group.add(sides);
  return group;
}

/** A ball that keeps its size on the screen. */
export function eye_ball(): Mesh {
  const ball = new Mesh(new SphereGeometry(1, 20, 12), lasting(`ball ${colour('--view')}`, () =>
    new MeshBasicMaterial({ color: colour('--view'), depthTest: false, transparent: true })));
  ball.renderOrder = 4;
  ball.onBeforeRender = (_, __, camera) => {
    ball.scale.setScalar(0.007 * camera.position.distanceTo(ball.position));
    ball.updateMatrixWorld();
    ball.modelViewMatrix.multiplyMatrices(camera.matrixWorldInverse, ball.matrixWorld);
  };
  return ball;
}

/** A ground grid with cells of 1, 2 or 5 times a power of ten metres; its cell size is in `userData.cell`. */
export function ground(radius: number, height: number): Object3D {
  const rough = radius / 8, power = 10 ** Math.floor(Math.log10(rough));
  const cell = [1, 2, 5, 10].map((step) => step * power).find((step) => step >= rough) ?? rough;
  const cells = 2 * Math.ceil((1.6 * radius) / cell);
  const grid = new GridHelper(cells * cell, cells, colour('--grid'), colour('--grid'));
  grid.position.y = height;
  grid.userData.cell = cell;
  return grid;
}
