// Makes dist/three.iife.js from the three.js that package-lock.json pins. The same packages give the same bytes; `--check` compares.
import { build } from 'esbuild';
import { readFileSync, writeFileSync } from 'node:fs';

const here = new URL('.', import.meta.url);
const version = JSON.parse(readFileSync(new URL('node_modules/three/package.json', here))).version;
const licence = readFileSync(new URL('node_modules/three/LICENSE', here), 'utf8').trim();
const result = await build({
  entryPoints: [new URL('three.js', here).pathname],
  bundle: true,
  minify: true,
  format: 'iife',
  globalName: 'THREE',
  target: 'es2022',
  charset: 'ascii',
  legalComments: 'none',
  banner: { js: `/*! three.js ${version}, https://threejs.org\n${licence}\n*/` },
  write: false,
});
const text = result.outputFiles[0].text;
if (/<\/script|<!--/i.test(text)) throw new Error('the bundle would end the script element it lies in');
const out = new URL('dist/three.iife.js', here);
if (process.argv.includes('--check')) {
  if (readFileSync(out, 'utf8') !== text) throw new Error('dist/three.iife.js is not what build.mjs makes');
  console.log(`dist/three.iife.js is what build.mjs makes of three.js ${version}`);
} else {
  writeFileSync(out, text);
  console.log(`dist/three.iife.js: three.js ${version}, ${text.length} bytes`);
}
