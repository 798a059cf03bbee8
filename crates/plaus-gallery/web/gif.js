// What the gallery uses of gifenc; build.mjs makes a classic script of it.
export { GIFEncoder, applyPalette, quantize } from 'gifenc';
