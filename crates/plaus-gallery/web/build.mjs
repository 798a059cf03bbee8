// Makes dist/*.iife.js from the packages that package-lock.json pins. The same packages give the same bytes; `--check` compares.
import { build } from 'esbuild';
import { readFileSync, writeFileSync } from 'node:fs';

const here = new URL('.', import.meta.url);
// Its package, where it comes from, its licence, and the name that its parts have in the page.
const bundles = [['three', 'three.js', 'https://threejs.org', 'LICENSE', 'THREE'], ['gifenc', 'gif.js', 'https://github.com/mattdesl/gifenc', 'LICENSE.md', 'GIF']];
for (const [name, entry, home, licence, globalName] of bundles) {
  const read = (file) => readFileSync(new URL(`node_modules/${name}/${file}`, here), 'utf8'), { version } = JSON.parse(read('package.json'));
  const result = await build({
    entryPoints: [new URL(entry, here).pathname],
    bundle: true,
    minify: true,
    format: 'iife',
    globalName,
    target: 'es2022',
    charset: 'ascii',
    legalComments: 'none',
    banner: { js: `/*! ${name === 'three' ? 'three.js' : name} ${version}, ${home}\n${read(licence).trim()}\n*/` },
    write: false,
  });
  const text = result.outputFiles[0].text;
  if (/<\/script|<!--/i.test(text)) throw new Error(`the bundle of ${name} would end the script element it lies in`);
  const out = new URL(`dist/${name}.iife.js`, here);
  if (process.argv.includes('--check')) {
    if (readFileSync(out, 'utf8') !== text) throw new Error(`dist/${name}.iife.js is not what build.mjs makes`);
    console.log(`dist/${name}.iife.js is what build.mjs makes of ${name} ${version}`);
  } else {
    writeFileSync(out, text);
    console.log(`dist/${name}.iife.js: ${name} ${version}, ${text.length} bytes`);
  }
}
