#!/usr/bin/env bash
# Fuzzes the readers, the solver and the tracker, and writes what it found to build/fuzz/fuzz.md:
#   bash tests/fuzz.sh [SECONDS [TARGET...]]   3600 seconds each, all targets, two at a time
# Targets are tests/fuzz/fuzz_<TARGET>.cpp (clang's libFuzzer) and fuzz_<TARGET>.py (Atheris). Each starts from its
# corpus in tests/fuzz/corpus and what earlier runs left in build/fuzz/corpus. Exit status 1 if one failed; the input
# that did it is then in build/fuzz/crashes/<TARGET>. Environment: JOBS (2), RSS_MB (2500).
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

cpp_targets=(urdf srdf occupancy solve tracker)
python_targets=(clouds border)
seconds=${1:-3600}
[[ $seconds =~ ^[1-9][0-9]*$ ]] || { echo "fuzz.sh: SECONDS is '$seconds', expected a positive number" >&2; exit 2; }
if (($# > 1)); then targets=("${@:2}"); else targets=("${cpp_targets[@]}" "${python_targets[@]}"); fi
for target in "${targets[@]}"; do
  [[ " ${cpp_targets[*]} ${python_targets[*]} " == *" $target "* ]] ||
    { echo "fuzz.sh: no target $target; there are: ${cpp_targets[*]} ${python_targets[*]}" >&2; exit 2; }
done
out=build/fuzz
bin=$out/cmake/tests/fuzz
mkdir -p $out

is_cpp() { [[ " ${cpp_targets[*]} " == *" $1 "* ]]; }

# Without trace-cmp: a solver compares numbers all day, and to watch each comparison halves the speed.
build() {
  local wanted=()
  for target in "${targets[@]}"; do if is_cpp "$target"; then wanted+=("pdoik_fuzz_$target"); fi; done
  ((${#wanted[@]})) || return 0
  if command -v ccache >/dev/null; then export CMAKE_CXX_COMPILER_LAUNCHER=ccache; fi
  cmake -S . -B $out/cmake -G Ninja --log-level=WARNING -D CMAKE_CXX_COMPILER=clang++ \
    -D PDOIK_BUILD_FUZZERS=ON -D PDOIK_SANITIZE=address,undefined,fuzzer-no-link \
    -D CMAKE_BUILD_TYPE=Debug -D CMAKE_CXX_FLAGS_DEBUG="-O1 -g1 -fno-sanitize-coverage=trace-cmp"
  cmake --build $out/cmake --target "${wanted[@]}"
}

# One target for so many seconds; its output in build/fuzz/<target>.log, its exit status in <target>.status.
fuzz() {
  local target=$1 program flags=() status=0 started=$SECONDS
  if is_cpp "$target"; then program=("$bin/pdoik_fuzz_$target"); else program=(.venv/bin/python "tests/fuzz/fuzz_$target.py"); fi
  mkdir -p "$out/corpus/$target" "$out/crashes/$target"
  if [[ -f tests/fuzz/$target.dict ]]; then flags+=("-dict=tests/fuzz/$target.dict"); fi
  # Entropic scheduling counts rare features at a cost that grows with the corpus, here past that of the solves.
  case $target in solve | tracker) flags+=(-entropic=0) ;; esac
  # The leak check is off for Python, whose interpreter keeps what it likes.
  is_cpp "$target" || flags+=(-detect_leaks=0)
  UBSAN_OPTIONS=print_stacktrace=1 LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0 \
    "${program[@]}" "$out/corpus/$target" "tests/fuzz/corpus/$target" "${flags[@]}" \
    "-max_total_time=$seconds" -timeout=20 "-rss_limit_mb=${RSS_MB:-2500}" -max_len=4096 \
    "-artifact_prefix=$out/crashes/$target/" -print_final_stats=1 >"$out/$target.log" 2>&1 || status=$?
  echo $status >"$out/$target.status"
  echo $((SECONDS - started)) >"$out/$target.seconds"
  if ((status)); then
    echo "fuzz.sh: $target failed:" >&2
    grep -m 3 -E 'does not hold|runtime error|ERROR: |SUMMARY|Test unit written' "$out/$target.log" >&2 || tail -5 "$out/$target.log" >&2
  fi
}

stat_of() { sed -n "s/^stat::$2: *//p" "$out/$1.log" | tail -1; }
coverage_of() { sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$out/$1.log" | tail -1; }

table() {
  echo "| target | seconds | executions | a second | edges covered | inputs kept | peak memory, MB | crashes |"
  echo "| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |"
  for target in "${targets[@]}"; do
    local crashes=0 kept
    if [[ $(<"$out/$target.status") != 0 ]]; then crashes=1; fi
    kept=$(find "$out/corpus/$target" -type f | wc -l)
    echo "| $target | $(<"$out/$target.seconds") | $(stat_of "$target" number_of_executed_units) |" \
      "$(stat_of "$target" average_exec_per_sec) | $(coverage_of "$target") | $kept |" \
      "$(stat_of "$target" peak_rss_mb) | $crashes |"
  done
}

build
for target in "${targets[@]}"; do rm -f "$out/$target.status"; done
for target in "${targets[@]}"; do
  while (($(jobs -rp | wc -l) >= ${JOBS:-2})); do wait -n || true; done
  fuzz "$target" &
done
wait
table | tee $out/fuzz.md
for target in "${targets[@]}"; do [[ $(<"$out/$target.status") == 0 ]] || exit 1; done
