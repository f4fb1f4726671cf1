// Lines of the 3-D view: the way of the eye, the pyramid of a view, a ground grid.
import {
  BufferGeometry, Color, DoubleSide, Float32BufferAttribute, GridHelper, Group, Mesh, MeshBasicMaterial, SphereGeometry, type Material, type Object3D,
} from 'three';
import { LineMaterial } from 'three/addons/lines/LineMaterial.js';
import { LineSegments2 } from 'three/addons/lines/LineSegments2.js';
import { LineSegmentsGeometry } from 'three/addons/lines/LineSegmentsGeometry.js';
import type { Vector } from './data.ts';
import { colour } from './dom.ts';

export function free(object: Object3D): void {
  object.traverse((part) => {
    const { geometry, material } = part as Partial<Mesh>;
    geometry?.dispose();
    (material as Material | undefined)?.dispose();
  });
  object.removeFromParent();
}

function segments(points: number[], name: string, width: number, opacity: number, in_front: boolean): LineSegments2 {
  const geometry = new LineSegmentsGeometry();
  geometry.setPositions(points);
  const material = new LineMaterial({ linewidth: width, transparent: opacity < 1, opacity, depthTest: !in_front });
  material.color = new Color(colour(name));
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

/** The pyramid of a view from its apex and four corners; a bold one also has faintly filled sides. */
export function pyramid_lines(corners: Vector[], bold: boolean): Object3D {
  const [eye, a, b, c, d] = corners;
  const group = new Group();
  const points = [eye, a, eye, b, eye, c, eye, d, a, b, b, c, c, d, d, a].flat();
  group.add(segments(points, '--view', bold ? 2 : 1.2, bold ? 0.35 : 0.3, true), segments(points, '--view', bold ? 2.2 : 1.2, bold ? 1 : 0.6, false));
  if (!bold) return group;
  const faces = new BufferGeometry();
  faces.setAttribute('position', new Float32BufferAttribute([eye, a, b, eye, b, c, eye, c, d, eye, d, a].flat(), 3));
  const sides = new Mesh(faces, new MeshBasicMaterial({ color: colour('--view'), transparent: true, opacity: 0.07, side: DoubleSide, depthWrite: false }));
  sides.renderOrder = 1;
  sides.frustumCulled = false;
  group.add(sides);
  return group;
}

export function eye_ball(radius: number): Mesh {
  const ball = new Mesh(new SphereGeometry(radius, 20, 12), new MeshBasicMaterial({ color: colour('--view'), depthTest: false, transparent: true }));
  ball.renderOrder = 4;
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
