// Prints the licence of every package the lock file names, type declarations apart (no code of theirs is bundled).
// Packages that share one text are listed above it together. Fails where a package carries no licence text.
import {readFileSync, readdirSync} from 'node:fs';
import {join} from 'node:path';

const root = process.argv[2];
const lock = JSON.parse(readFileSync(join(root, 'package-lock.json'), 'utf8'));
const packages_of = new Map();
for (const [folder, entry] of Object.entries(lock.packages)) {
  if (folder === '' || folder.includes('node_modules/@types/')) continue;
  const name = folder.slice(folder.lastIndexOf('node_modules/') + 'node_modules/'.length);
  const file = readdirSync(join(root, folder)).find((f) => /^(licen[cs]e|copying)/i.test(f));
  if (!file) throw new Error(`${name} ${entry.version} has no licence file`);
  const text = readFileSync(join(root, folder, file), 'utf8').replace(/\r/g, '').trim();
  if (!packages_of.has(text)) packages_of.set(text, []);
  packages_of.get(text).push(`${name} ${entry.version} (${entry.license})`);
}
console.log('The charts are drawn by Vega, Vega-Lite and Vega-Embed. Their files contain code of these packages:\n');
for (const [text, names] of packages_of) console.log(`${'-'.repeat(80)}\n${names.join('\n')}\n\n${text}\n`);
