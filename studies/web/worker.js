'use strict';
// Runs scenes in the module, one at a time, away from the page. It gets {module} once, then {id, request}; it answers
// {ready}, {id, done, steps} after steps, and {id, code, answer, milliseconds}; with `dead` it answers nothing more.

const solver = (async () => {
  const {data: {module, files}} = await new Promise((got) => {
    self.addEventListener('message', got, {once: true});
  });
  const stickslip = await createStickslip({
    instantiateWasm(imports, take) {
      WebAssembly.instantiate(module, imports).then((instance) => take(instance));
      return {};
    },
    print() {},
    printErr() {},
  });
  for (const [name, text] of Object.entries(files)) stickslip.FS.writeFile(name, text);
  const scene = stickslip.cwrap('stickslip_scene', 'number', ['string']);
  const result = stickslip.cwrap('stickslip_result', 'string', []);
  let id = 0, said = 0;
  const report = stickslip.addFunction((done, steps) => {
    if (performance.now() - said < 100) return;
    said = performance.now();
    postMessage({id, done, steps});
  }, 'vii');
  stickslip.ccall('stickslip_progress', null, ['number'], [report]);
  postMessage({ready: true});
  return (task) => {
    const start = performance.now();
    id = task.id;
    said = start;
    try {
      const code = scene(JSON.stringify(task.request));
      postMessage({id, code, answer: JSON.parse(result()), milliseconds: performance.now() - start});
    } catch (error) {  // the module's memory may be damaged: the page takes another one
      postMessage({id, code: 1, answer: {broken: String(error)}, milliseconds: performance.now() - start, dead: true});
    }
  };
})();
self.addEventListener('message', ({data}) => {
  if (data.request) solver.then((run) => run(data));
});
