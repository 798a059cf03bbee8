// Runs the module: node module.mjs MODULE.wasm.gz SCHEMA.json LIVE.json ITERATIONS
import { readFileSync } from 'node:fs';
import { gunzipSync } from 'node:zlib';

const [module, schema, live, iterations] = process.argv.slice(2);
const compiled = new WebAssembly.Module(gunzipSync(readFileSync(module)));
const start = () => new WebAssembly.Instance(compiled, {}).exports;
// Making room may move the memory, so it is asked for last.
const hand = (instance, bytes) => {
  const at = instance.input(bytes.length);
  new Uint8Array(instance.memory.buffer, at, bytes.length).set(bytes);
};
const answer = (instance) => Buffer.from(new Uint8Array(instance.memory.buffer, instance.output(), instance.output_length()));
const call = (instance, name, ...values) => {
  const number = instance[name](...values);
  if (number < 0) throw new Error(answer(instance).toString());
  return number;
};
const [sampler, keeper] = [start(), start()], run = readFileSync(live);
for (const instance of [sampler, keeper]) {
  hand(instance, readFileSync(schema));
  call(instance, 'give_schema');
}
hand(sampler, run);
call(sampler, 'open_sampler', 2);
hand(keeper, run);
call(keeper, 'open_keeper');
for (let step = 0; step < 2; step++) {
  const count = call(sampler, 'advance', +iterations), found = count ? answer(sampler).toString() : '[]';
  call(sampler, 'state');
  process.stdout.write(`${count} ${answer(sampler)}\n`);
  for (const one of parts(found).slice(0, 2)) {
    hand(keeper, Buffer.from(one));
    const added = call(keeper, 'add') ? answer(keeper) : Buffer.alloc(0);
    const sum = added.reduce((sum, byte) => (Math.imul(sum, 31) + byte) >>> 0, 7);
    process.stdout.write(`${one}\n${added.length} ${sum}\n`);
  }
}

// The items of a list in JSON, each as its text; no text within them has brackets.
function parts(list) {
  const found = [];
  let depth = 0, start = 0;
  for (let k = 0; k < list.length; k++) {
    if ('{['.includes(list[k]) && ++depth === 2) start = k;
    if ('}]'.includes(list[k]) && depth-- === 2) found.push(list.slice(start, k + 1));
  }
  return found;
}
