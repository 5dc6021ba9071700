#!/usr/bin/env bash
# check_package.sh BUILD SOURCE: makes the Debian package of a build, unpacks it into an empty folder, and follows the
# tutorial with what is in there: the program, its scenes and its copy of the page. The links of all pages lead somewhere.
set -euo pipefail
build=$1 source=$2
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT

cpack --config "$build/CPackConfig.cmake" -B "$root/made" >"$root/cpack.log" || { cat "$root/cpack.log"; exit 1; }
package=$(ls "$root"/made/stickslip_*.deb)
depends=$(dpkg-deb -f "$package" Depends)
for library in libc6 libfmt9 'libopenblas0-serial | libblas.so.3'; do
  [[ ", $depends" == *", $library"* ]] || { echo "the package does not depend on $library, but on: $depends"; exit 1; }
done

dpkg-deb -x "$package" "$root/system"
doc=$root/system/usr/share/doc/stickslip
share=$root/system/usr/share
for file in "$share/man/man1/stickslip.1" "$doc/LICENSE" "$doc/copyright" "$doc/THIRD_PARTY_NOTICES" "$doc/README.md" \
  "$share/bash-completion/completions/stickslip"; do
  [ -s "$file" ] || { echo "the package lacks $file"; exit 1; }
done

python3 "$source/tests/docs/check_links.py" "$doc"

# nothing of this shell but where the libraries are
env -i PATH=/usr/bin:/bin LD_LIBRARY_PATH="${LD_LIBRARY_PATH:-}" SCENES="$root/system/usr/share/stickslip/scenes" \
  python3 "$source/tests/docs/replay.py" "$root/system/usr/bin/stickslip" "$source" "$doc/docs/tutorial.md"
