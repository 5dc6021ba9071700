#!/usr/bin/env bash
# check_includes.sh SOURCE_DIR: fails and names each #include that points the wrong way.
# check_includes.sh --self-test: fails where a wrong include would go unseen.
#
#   core <- methods <- sensitivity <- studies; within core: algebra, mesh <- solids, contact <- model <- engine;
#   within studies: io <- input <- run (and verify) <- report <- sweep <- app, and what python and web need of them.
#   studies/verify, which checks what all others find, shares nothing with them.
#   Below studies/ there is no JSON and no printing; solver libraries are seen by core/algebra alone.
#   What the page for learners is made of (studies/web) has nothing that the library of Emscripten lacks: no algorithms of
#   std::ranges, and no std::from_chars of a double, for which core/mesh/decimal.hpp stands in.
set -euo pipefail

# what the quoted includes of a folder may begin with
allowed() {
  case "$1" in
    core/algebra) echo 'core/algebra/' ;;
    core/mesh) echo 'core/(algebra|mesh)/' ;;
    core/solids) echo 'core/(algebra|mesh|solids)/' ;;
    core/contact) echo 'core/(algebra|mesh|solids|contact)/' ;;
    core/model) echo 'core/(algebra|mesh|solids|contact|model)/' ;;
    core/engine) echo 'core/' ;;
    methods) echo '(core|methods)/' ;;
    sensitivity) echo '(core|methods|sensitivity)/' ;;
    studies/io) echo '(core|methods|sensitivity|studies/(io|version\.hpp))' ;;
    studies/input) echo '(core|methods|sensitivity|studies/(io|input))/' ;;
    studies/run) echo '(core|methods|sensitivity|studies/(io|input|verify|run|version\.hpp))' ;;
    studies/report) echo 'studies/(io|input|report)/|core/contact/friction_law\.hpp' ;;
    studies/sweep) echo '(core|methods|sensitivity|studies/(io|input|verify|run|report|sweep|version\.hpp))' ;;
    studies/verify) echo 'studies/verify/' ;;
    studies/app) echo '(core|methods|sensitivity|studies/(io|input|run|report|sweep|verify|app))/' ;;
    studies/web) echo 'core/mesh/decimal\.hpp|studies/(io|input|run)/|studies/app/exit_codes\.hpp' ;;
    studies/python) echo '(core|methods|sensitivity|studies)/' ;;
  esac
}
folders="core/algebra core/mesh core/solids core/contact core/model core/engine methods sensitivity
  studies/io studies/input studies/run studies/report studies/sweep studies/verify studies/app studies/python
  studies/web"
solver_headers='<(cholmod|dmumps_c|SuiteSparse_config)[^>]*>'
lacking='std::ranges::|std::from_chars\('
not_of_the_page='core/mesh/(decimal\.cpp|msh_tokens\.hpp)|studies/run/(certificate|solution_file|export_system|run_files)\.cpp'
printing='<(nlohmann|fmt|CLI)/|<(iostream|print)>|\b(printf|fprintf|puts) *\(|\b(cout|cerr)\b'

# check SOURCE_DIR [FOLDER]: all folders if none is named
check() {
  cd "$1"
  local folder wrong="" found
  for folder in ${2:-$folders}; do
    [ -d "$folder" ] || continue
    found=$(grep -rnE '^[[:space:]]*#[[:space:]]*include[[:space:]]*"' --include='*.[hc]pp' "$folder" |
      grep -vE "\"($(allowed "$folder"))" || true)
    wrong+=${found:+$found$'\n'}
    case "$folder" in core/algebra) ;; *)
      found=$(grep -rnE "#[[:space:]]*include[[:space:]]*$solver_headers" --include='*.[hc]pp' "$folder" || true)
      wrong+=${found:+$found$'\n'} ;;
    esac
    case "$folder" in studies/verify | studies/report | studies/sweep | studies/app | studies/python) ;; *)
      found=$(grep -rnE "$lacking" --include='*.[hc]pp' "$folder" | grep -vE "^($not_of_the_page):" || true)
      wrong+=${found:+$found$'\n'} ;;
    esac
    case "$folder" in studies/*) ;; *)
      found=$(grep -rnE "$printing" --include='*.[hc]pp' "$folder" | grep -vE ':[0-9]+:[[:space:]]*//' || true)
      wrong+=${found:+$found$'\n'} ;;
    esac
  done
  if [ -n "$wrong" ]; then
    printf 'against the direction of includes (see %s):\n%s' "tests/support/check_includes.sh" "$wrong" >&2
    return 1
  fi
}

self_test() {
  local line folder
  tree=$(mktemp -d)
  trap 'rm -rf "$tree"' EXIT
  mkdir -p "$tree"/core/{algebra,mesh,solids,contact,model,engine} "$tree"/{methods,sensitivity} \
    "$tree"/studies/{io,input,run,report,sweep,verify,app}
  echo '#include "core/algebra/scalar.hpp"' >"$tree/studies/io/good.cpp"
  echo '#include "studies/report/report.hpp"' >"$tree/studies/sweep/good.cpp"
  echo '#include "core/algebra/number.hpp"' >"$tree/core/mesh/good.hpp"
  (check "$tree") || { echo "a good tree is refused" >&2; return 1; }
  while read -r folder line; do
    echo "$line" >"$tree/$folder/wrong.hpp"
    if (check "$tree" "$folder") 2>/dev/null; then
      echo "unseen in $folder: $line" >&2
      return 1
    fi
    rm "$tree/$folder/wrong.hpp"
  done <<'CASES'
core/algebra #include "core/mesh/mesh.hpp"
core/mesh #include "core/model/model.hpp"
core/mesh #include "core/model/scene.hpp"
core/solids #include "core/contact/friction_cone.hpp"
core/contact #  include "core/model/state.hpp"
core/model #include "methods/options.hpp"
core/model #include "core/engine/engine.hpp"
core/model #include <nlohmann/json.hpp>
methods #include "sensitivity/direct.hpp"
methods #include <dmumps_c.h>
sensitivity #include "studies/io/vtu.hpp"
sensitivity std::cout << "iteration";
core/mesh const auto end = std::from_chars(first, last, x).ptr;
studies/input if (std::ranges::count(required, key) == 0) return;
studies/app #include "bench/kernels.hpp"
studies/io #include "studies/input/scene_reader.hpp"
studies/input #include "studies/run/case.hpp"
studies/run #include "studies/sweep/study.hpp"
studies/report #include "studies/run/case.hpp"
studies/sweep #include "studies/app/commands.hpp"
studies/verify #include "core/mesh/mesh.hpp"
studies/verify #include "studies/io/numerals.hpp"
CASES
}

case "${1:---self-test}" in
  --self-test) self_test ;;
  *) check "$1" ;;
esac
