'use strict';
/** The module in workers, one for each method. Each runs one request at a time; a newer one replaces one that waits. */
const Solver = (() => {
  const text = (id) => document.getElementById(id).textContent;
  const files = {};  // meshes that scenes name, by name
  const workers = new Map();
  let next = 1;

  /** The compiled module, from the page. */
  const compiled = (async () => {
    const bytes = Uint8Array.from(atob(text('module').trim()), (letter) => letter.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
    return WebAssembly.compile(await new Response(stream).arrayBuffer());
  })();

  const source = URL.createObjectURL(new Blob([text('glue'), '\n', text('worker')], {type: 'text/javascript'}));

  /** A worker that waits for its first request. */
  function start(name) {
    const worker = {thread: new Worker(source), tasks: [], running: null};
    workers.set(name, worker);
    compiled.then((module) => worker.thread.postMessage({module, files}));
    worker.thread.addEventListener('message', ({data}) => {
      if (data.ready) {
        worker.ready = true;
        send(worker);
        return;
      }
      const task = worker.running;
      if (!task || data.id !== task.id) return;
      if (data.code === undefined) {
        task.on_step?.(data.done, data.steps);
        return;
      }
      worker.running = null;
      task.resolve(data);
      if (data.dead) stop(name);
      else send(worker);
    });
    worker.thread.addEventListener('error', (event) => stop(name, {broken: event.message}));
    return worker;
  }

  function send(worker) {
    if (!worker.ready || worker.running || !worker.tasks.length) return;
    worker.running = worker.tasks.shift();
    worker.running.start = performance.now();
    worker.thread.postMessage({id: worker.running.id, request: worker.running.request});
  }

  /** Answers {code, answer, milliseconds}, or null where a newer request of the same kind took its place. */
  function ask(name, kind, request, on_step) {
    const worker = workers.get(name) ?? start(name);
    for (const task of worker.tasks.filter((task) => task.kind === kind)) task.resolve(null);
    worker.tasks = worker.tasks.filter((task) => task.kind !== kind);
    return new Promise((resolve) => {
      worker.tasks.push({id: next++, kind, request, on_step, resolve});
      send(worker);
    });
  }

  /** Ends what a worker runs, and gives the rest to a new one. `answer`: of what it ran. */
  function stop(name, answer = {cancelled: true}) {
    const old = workers.get(name);
    if (!old) return;
    old.thread.terminate();
    const worker = start(name);
    worker.tasks = old.tasks;
    old.running?.resolve({code: 4, answer, milliseconds: performance.now() - old.running.start});
  }

  /** Seconds since the request that runs was sent; 0: none runs. */
  const age = (name) => {
    const running = workers.get(name)?.running;
    return running ? (performance.now() - running.start) / 1000 : 0;
  };

  /** Whether a worker runs, or will run, a request of this kind. */
  const busy = (name, kind) => {
    const worker = workers.get(name);
    return Boolean(worker && [worker.running, ...worker.tasks].some((task) => task?.kind === kind));
  };

  /** A file beside the scenes, for all workers from now on. */
  function add_file(name, content) {
    files[name] = content;
    for (const each of workers.keys()) stop(each);
  }

  /** Starts workers before there is a request for them. */
  const warm = (...names) => {
    for (const name of names) start(name);
  };

  return {ask, stop, age, busy, add_file, warm, compiled};
})();
