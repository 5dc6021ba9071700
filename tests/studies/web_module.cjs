// node web_module.cjs MODULE.js: answers the requests of studies/web/interface.cpp that standard input has, one a line,
// each by a line {"code", "milliseconds", "answer"}.
'use strict';
const {readFileSync} = require('node:fs');
delete globalThis.fetch;  // which reads no files; without it the module is read by node:fs
const create = require(require('node:path').resolve(process.argv[2]));

create().then((module) => {
  const scene = module.cwrap('stickslip_scene', 'number', ['string']), result = module.cwrap('stickslip_result', 'string', []);
  let stop_at = 0;
  const report = module.addFunction((done) => { if (stop_at && done >= stop_at) module._stickslip_cancel(); }, 'vii');
  module._stickslip_progress(report);
  for (const line of readFileSync(0, 'utf8').split('\n').filter(Boolean)) {
    const request = JSON.parse(line), start = performance.now();
    stop_at = request.stop_at ?? 0;
    const code = scene(line);
    const text = result();
    process.stdout.write(JSON.stringify({code, milliseconds: performance.now() - start, answer: JSON.parse(text)}) + '\n');
  }
});
