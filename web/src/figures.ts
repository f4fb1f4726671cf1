// Figures and sentences that sum up a run: the verdict in words, shares, medians. Computed from the frames, so that the
// head of the page cannot disagree with its plots and its table.
import type { Run, Walk } from './data.ts';
import { count, plural } from './format.ts';

export type Outcome = 'clean' | 'lost' | 'approximate' | 'unchecked' | 'empty';

export interface Verdict {
  outcome: Outcome;
  sentence: string;
  detail: string;
  worst: number | null;  // index of the frame that lost most
}

const sum = (values: number[]) => values.reduce((total, value) => total + value, 0);

export function median(values: number[]): number | null {
  if (values.length === 0) return null;
  const sorted = [...values].sort((a, b) => a - b);
  const middle = sorted.length >> 1;
  return sorted.length % 2 ? sorted[middle] : (sorted[middle - 1] + sorted[middle]) / 2;
}

/** `samples`: rays per axis of a pixel with which the truth was found. */
export function verdict(run: Run, samples: number): Verdict {
  const frames = run.frames;
  if (frames.length === 0) return { outcome: 'empty', sentence: 'This walk holds no frames', detail: '', worst: null };
  const checked = frames.filter((frame) => frame.truth !== null && frame.truth !== undefined);
  if (checked.length === 0)
    return {
      outcome: 'unchecked',
      sentence: 'Not checked whether anything visible was lost',
      detail: 'The walk was made with --no-verify: what was drawn is known, what can be seen is not.',
      worst: null,
    };
  const scope = checked.length === frames.length ? `${count(frames.length)} ${plural(frames.length, 'frame')}`
                                                  : `the ${count(checked.length)} checked of ${count(frames.length)} frames`;
  const losing = checked.filter((frame) => (frame.missed ?? 0) > 0);
  if (losing.length === 0)
    return {
      outcome: 'clean',
      sentence: `Nothing visible was lost in ${scope}`,
      detail: samples > 1 ? `Every object that at least one of ${samples} × ${samples} rays through a pixel meets was among those drawn.`
                          : 'Every object seen at the centre of at least one pixel was among those drawn.',
      worst: null,
    };
  const worst = losing.reduce((most, frame) => ((frame.missed ?? 0) > (most.missed ?? 0) ? frame : most));
  const objects = lost_objects(losing.map((frame) => ({ missed: frame.missed ?? 0, ids: frame.missed_ids ?? [] })));
  const was = objects.number === 1 ? 'was' : 'were';
  const what = objects.distinct ? `${count(objects.number)} ${plural(objects.number, 'object')} ${was} lost`
                                : `Objects were lost ${count(objects.number)} times`;
  const between = losing.every((frame) => frame.missed === frame.unpromised);
  const outcome = run.promise === 'approximate' || between ? 'approximate' : 'lost';
  const excuse = run.promise === 'approximate' ? ' The method is approximate: it promises no better.'
               : between ? ' All of it lies between pixel centres; the method promises what is seen at them.' : '';
  if (losing.length === 1)
    return {
      outcome, worst: frames.indexOf(worst), sentence: `${what} in frame ${worst.frame}`,
      detail: (checked.length > 1 ? `Nothing was lost in the other ${count(checked.length - 1)}.` : '') + excuse,
    };
  return {
    outcome,
    sentence: `${what} in ${count(losing.length)} of ${scope}`,
    detail: `Frame ${worst.frame} is the worst: it lost ${count(worst.missed ?? 0)}.${excuse}`,
    worst: frames.indexOf(worst),
  };
}

/** Distinct objects where every id was written down, else the sum over the frames. */
function lost_objects(losses: { missed: number; ids: number[] }[]): { number: number; distinct: boolean } {
  if (losses.every((loss) => loss.ids.length === loss.missed))
    return { number: new Set(losses.flatMap((loss) => loss.ids)).size, distinct: true };
  return { number: sum(losses.map((loss) => loss.missed)), distinct: losses.length === 1 };
}

export interface Figures {
  culled: number | null;           // share of the candidates that were not drawn
  overestimate: number | null;     // objects drawn per object seen, over the checked frames
  cull_ms: number | null;          // median
  triangles: number | null;        // share of the triangles of the scene that were submitted
}

export function figures(walk: Walk, run: Run): Figures {
  const frames = run.frames;
  const checked = frames.filter((frame) => typeof frame.truth === 'number');
  const candidates = sum(frames.map((frame) => frame.candidates ?? 0));
  const truth = sum(checked.map((frame) => frame.truth ?? 0));
  const submitted = frames.map((frame) => frame.triangles_submitted).filter((value) => typeof value === 'number');
  const times = frames.map((frame) => frame.cull_ms).filter((value) => typeof value === 'number');
  return {
    culled: candidates > 0 ? 1 - sum(frames.map((frame) => frame.visible)) / candidates : null,
    overestimate: truth > 0 ? sum(checked.map((frame) => frame.visible)) / truth : null,
    cull_ms: run.summary.cull_ms_median ?? median(times),
    triangles: run.summary.triangles_fraction ??
        (submitted.length && walk.triangles ? sum(submitted) / (submitted.length * walk.triangles) : null),
  };
}
