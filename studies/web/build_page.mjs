// node build_page.mjs SOURCE MODULE.js MODULE.wasm VERSION.hpp LANGUAGE PAGE.html
// Puts the page together: one file that holds the module, the scripts, the words, the scenes and the chart library.
import {existsSync, readFileSync, readdirSync, writeFileSync} from 'node:fs';
import {join} from 'node:path';
import {gzipSync} from 'node:zlib';

const [source, glue, module, version_header, language, page] = process.argv.slice(2);
const web = join(source, 'studies/web'), vega = join(source, 'third_party/vega');
const read = (...path) => readFileSync(join(...path), 'utf8');
const scripts = ['words.js', 'solver.js', 'scene.js', 'state.js', 'picture.js', 'panel.js', 'charts.js', 'derivative.js',
                 'answers.js', 'rows.js', 'show.js', 'ask.js', 'link.js', 'editor.js', 'lessons.js', 'main.js'];

/** Texts inside of a <script> must not end it: code, JSON, and text that is only shown. */
const inside = (text) => text.replaceAll('</script', '<\\/script').replaceAll('<!--', '<\\!--');
const json = (text) => text.replaceAll('<', '\\u003c');

const lessons = JSON.parse(read(web, 'lessons.json'));
const shipped = readdirSync(join(source, 'studies/scenes')).filter((name) => name.endsWith('.json') && !name.includes('.study.'))
    .map((name) => 'studies/scenes/' + name);
const scenes = {};
for (const path of [...new Set([...lessons.map((lesson) => lesson.scene), ...shipped])].sort()) {
  const text = read(source, path);
  if (!text.includes('"gmsh"')) scenes[path] = text;  // their meshes are not on the page
}

const text_of = (name) => new RegExp(`string_view ${name} = "([^"]*)"`).exec(read(version_header))[1];
const about = {version: text_of('number'), commit: text_of('git')};
// (Debian keeps the terms of a package there; elsewhere they are to be added by whoever passes the page on.)
const packages = ['libeigen3-dev', 'nlohmann-json3-dev', 'libfmt-dev', 'emscripten'].map((name) => [name, `/usr/share/doc/${name}/copyright`]);
const notices = [read(source, 'LICENSE'), read(vega, 'THIRD_PARTY_NOTICES'),
                 ...packages.filter(([, file]) => existsSync(file)).map(([name, file]) => `${name}:\n\n${read(file)}`)].join('\n\n\n');

const parts = {
  'page.css': read(web, 'page.css'),
  'module': gzipSync(readFileSync(module), {level: 9}).toString('base64'),
  'glue': inside(read(glue)),
  'worker.js': inside(read(web, 'worker.js')),
  'words': json(read(web, `words.${language}.json`)),
  'lessons.json': json(read(web, 'lessons.json')),
  'scenes': json(JSON.stringify(scenes)),
  'about': json(JSON.stringify(about)),
  'notices': inside(notices),
  'scripts': inside([read(source, 'studies/report/numerals.js'), ...scripts.map((name) => read(web, name))].join('\n')),
  'vega': inside(read(vega, 'vega.min.js') + '\n' + read(vega, 'vega-lite.min.js')),
};
writeFileSync(page, read(web, 'page.html').replace(/\{\{([\w.]+)\}\}/g, (all, name) => parts[name]));
