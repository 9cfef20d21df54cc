#!/usr/bin/env bash
# Sets everything up, then runs every test, and fails if one stage failed:
#   bash tests/run.sh                       all stages
#   bash tests/run.sh STAGE [ARGUMENT...]   one stage; cpp and asan hand the arguments to ctest, python to pytest
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# Formatters, checkers, and whether the type stubs are those of the module.
stage_lint() {
  .venv/bin/ruff check .
  .venv/bin/ruff format --check .
  .venv/bin/mypy
  find cpp tests bench python/bindings -regex '.*\.[chi]\(pp\|nl\)' -print0 |
    xargs -0 .venv/bin/clang-format --dry-run -Werror
  bash python/bindings/stubs.sh --check
}

configure_and_build() {  # DIRECTORY CMAKE_ARGUMENT...
  local directory=$1
  shift
  cmake -S . -B "$directory" -G Ninja --log-level=WARNING -D PDOIK_BUILD_TESTS=ON -D PDOIK_WERROR=ON "$@"
  cmake --build "$directory"
}

run_ctest() {  # DIRECTORY CTEST_ARGUMENT...
  local directory=$1
  shift
  ctest --test-dir "$directory" --output-on-failure --no-tests=error --progress -j "$(nproc)" "$@"
}

stage_cpp() {
  configure_and_build build/dev -D PDOIK_BUILD_BENCH=ON
  run_ctest build/dev "$@"
}

# The same tests under the address and undefined-behaviour sanitizers, with Eigen's assertions on.
stage_asan() {
  configure_and_build build/asan -D PDOIK_SANITIZE=address,undefined \
    -D CMAKE_BUILD_TYPE=Debug -D CMAKE_CXX_FLAGS_DEBUG="-O1 -g1"
  UBSAN_OPTIONS=print_stacktrace=1 LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0 \
    run_ctest build/asan "$@"
}

# A project of its own that finds the installed library.
stage_consumer() {
  configure_and_build build/dev
  rm -rf build/install build/consumer
  cmake --install build/dev --prefix build/install --component cpp >/dev/null
  cmake -S tests/consumer -B build/consumer -G Ninja --log-level=WARNING -D CMAKE_PREFIX_PATH="$PWD/build/install"
  cmake --build build/consumer
  build/consumer/consumer
  build/consumer/readme
}

# One worker per core, and one thread each: the files are many and the numerics small.
stage_python() {
  OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 .venv/bin/python -m pytest -n auto --dist loadfile "$@"
}

stages=(lint cpp asan consumer python)
if (($#)); then
  [[ " ${stages[*]} " == *" $1 "* ]] || { echo "run.sh: no stage $1; there are: ${stages[*]}" >&2; exit 2; }
  stages=("$1")
  shift
fi

bash third_party/setup.sh --extras test,bench
if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi

summary=()
failed=0
for stage in "${stages[@]}"; do
  printf '\n== %s\n' "$stage"
  start=$SECONDS
  set +e  # a subshell outside any condition: only there does errexit end a stage at its first failing command
  (set -e; "stage_$stage" "$@")
  status=$?
  set -e
  if ((status)); then failed=1 outcome=FAILED; else outcome=passed; fi
  summary+=("$(printf '%-9s %s (%d s)' "$stage" "$outcome" $((SECONDS - start)))")
done
printf '\n== summary\n'
printf '%s\n' "${summary[@]}"
exit $failed
