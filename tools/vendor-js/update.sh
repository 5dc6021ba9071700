#!/bin/sh
# Makes third_party/vega from the pins of package-lock.json: the three minified bundles, their licences, the licence
# texts of everything bundled in them, versions and checksums. Needs npm and a network; a build never runs it.
#   tools/vendor-js/update.sh            writes third_party/vega
#   tools/vendor-js/update.sh --check    fails if what is there differs from what the pins give
set -eu
here=$(cd "$(dirname "$0")" && pwd)
target=$here/../../third_party/vega
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp "$here/package.json" "$here/package-lock.json" "$work"
(cd "$work" && npm ci --ignore-scripts --no-audit --no-fund --loglevel=error)

out=$work/out
mkdir "$out"
for name in vega vega-lite vega-embed; do
  cp "$work/node_modules/$name/build/$name.min.js" "$out/$name.min.js"
  cp "$work/node_modules/$name/LICENSE" "$out/LICENSE.$name"
done
node "$here/notices.mjs" "$work" > "$out/THIRD_PARTY_NOTICES"
node -e '
  const path = process.argv[1];
  for (const name of ["vega", "vega-lite", "vega-embed"])
    console.log(name + " " + require(path + "/node_modules/" + name + "/package.json").version);
' "$work" > "$out/VERSIONS"
(cd "$out" && LC_ALL=C sha256sum -- * > "$work/SHA256SUMS" && mv "$work/SHA256SUMS" .)

if [ "${1:-}" = --check ]; then
  diff -r "$out" "$target"
  echo "third_party/vega is what the pins give"
else
  rm -rf "$target"
  mkdir -p "$target"
  cp "$out"/* "$target"
  cat "$target/VERSIONS"
fi
