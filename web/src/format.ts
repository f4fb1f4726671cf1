// Numbers as people read them. A missing number is a dash, never a zero.

const grouped = new Intl.NumberFormat('en-GB');
const compact = new Intl.NumberFormat('en-US', { notation: 'compact', maximumFractionDigits: 1 });

type Maybe = number | null | undefined;
const known = (value: Maybe): value is number => typeof value === 'number' && Number.isFinite(value);

export const count = (value: Maybe) => (known(value) ? grouped.format(value) : '–');

/** 12.3 k, 4.5 M: for axes and tiles. */
export const short_count = (value: Maybe) => (known(value) ? compact.format(value) : '–');

/** Three significant digits, never an exponent. */
export function significant(value: Maybe): string {
  if (!known(value)) return '–';
  const magnitude = Math.abs(value);
  if (magnitude >= 100) return grouped.format(Math.round(value));
  if (magnitude >= 10) return value.toFixed(1);
  if (magnitude >= 1) return value.toFixed(2);
  return value === 0 ? '0' : value.toFixed(Math.min(6, 2 - Math.floor(Math.log10(magnitude))));
}

/** A round length: 20 cm, 5 m, 2 km. */
export const metres = (length: number) =>
  length >= 1000 ? `${short_decimal(length / 1000)} km` : length >= 1 ? `${short_decimal(length)} m` : `${short_decimal(length * 100)} cm`;

/** Of a mark at an axis: as short as it is exact. */
export const short_decimal = (value: number) => String(Number(value.toPrecision(6)));

export const percent = (share: Maybe) =>
  !known(share) ? '–' : share > 0 && share < 0.001 ? '< 0.1 %' : `${(share * 100).toFixed(1)} %`;

export const plural = (number: number, word: string) => (number === 1 ? word : `${word}s`);
