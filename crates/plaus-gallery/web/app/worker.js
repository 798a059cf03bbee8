// A worker of a live gallery: an instance of the module, which is either a sampler or the keeper of solutions. Nothing in it touches the page.

let exported = null, going = false, pace = 4, turn = 0;

// Hands a text to the module.
function hand(text) {
  const bytes = new TextEncoder().encode(text), at = exported.input(bytes.length);
  // Making room may move the memory, so it is asked for last.
  new Uint8Array(exported.memory.buffer, at, bytes.length).set(bytes);
}

// The module's answer, a copy.
function answer() {
  const from = exported.output();
  return new Uint8Array(exported.memory.buffer, from, exported.output_length()).slice();
}

const words = () => new TextDecoder().decode(answer());

// Calls a function of the module; it throws what the module says if it fails.
function call(name, ...values) {
  const number = exported[name](...values);
  if (number < 0) throw new Error(words());
  return number;
}

// Iterations for about a seventh of a second, then a look at the messages.
const bell = new MessageChannel();
bell.port1.onmessage = ({ data }) => {
  if (!going || data !== turn) return;
  attempt(() => {
    const before = performance.now(), done = exported.iterations();
    const count = call('advance', pace), took = performance.now() - before;
    // The text goes on as it is: numbers of 64 bits must not become JavaScript's.
    if (count > 0) postMessage({ found: words() });
    pace = Math.round(Math.min(Math.max(pace * Math.min(Math.max(150 / Math.max(took, 1), 0.25), 4), 1), 65536));
    postMessage({ iterations: exported.iterations() - done });
    bell.port2.postMessage(turn);
  });
};

function attempt(job) {
  try {
    job();
  } catch (error) {
    going = false;
    postMessage({ failed: String(error.message ?? error) });
  }
}

onmessage = ({ data }) => attempt(() => {
  const { module, schema, live, chain, keeper, go, near, add, draw, save, read, edit, glb, label } = data;
  if (module) {
    exported = new WebAssembly.Instance(module, {}).exports;
    hand(schema);
    call('give_schema');
    if (live) {
      hand(live);
      if (keeper) call('open_keeper'); else call('open_sampler', chain);
    }
    if (keeper) call('about');
    postMessage({ opened: true, about: keeper ? JSON.parse(words()) : null });
  }
  // A text, or other values: what is wrong with them, or all that workers need to sample them.
  for (const [name, given] of [['read_text', read], ['edit', edit]]) {
    if (given === undefined) continue;
    hand(JSON.stringify(given));
    const isRight = call(name) === 1, said = words();
    postMessage(isRight ? { live: said } : { problems: JSON.parse(said) });
  }
  if (near !== undefined) {
    hand(near);
    call('begin_at', chain);
  }
  if (go !== undefined) {
    going = go;
    turn += 1;
    if (go) bell.port2.postMessage(turn);
  }
  if (add !== undefined) {
    hand(add);
    const isNew = call('add') === 1, bytes = isNew ? answer() : null;
    postMessage({ added: bytes }, bytes ? [bytes.buffer] : []);
  }
  if (draw !== undefined) {
    call('draw', draw);
    postMessage({ drawn: words() });
  }
  if (glb !== undefined) {
    hand(label);
    call('glb', glb);
    const bytes = answer();
    postMessage({ glb: bytes, of: glb }, [bytes.buffer]);
  }
  if (save) {
    call('saved');
    postMessage({ saved: words() });
  }
});
