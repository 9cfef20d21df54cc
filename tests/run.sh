#!/usr/bin/env bash
# Sets everything up, then runs every test, and fails if one stage failed:
#   bash tests/run.sh                       all stages that CI runs
#   bash tests/run.sh STAGE [ARGUMENT...]   one stage; those that run ctest or pytest hand it the arguments
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

# Formatters, checkers, and whether what is written from the options' headers and the module is theirs.
stage_lint() {
  .venv/bin/ruff check .
  .venv/bin/ruff format --check .
  .venv/bin/mypy
  PYTHONPATH=python .venv/bin/lint-imports --no-cache
  find cpp tests bench python/bindings -regex '.*\.[chi]\(pp\|nl\)' -print0 |
    xargs -0 .venv/bin/clang-format --dry-run -Werror
  .venv/bin/python tests/faces.py
  .venv/bin/python tests/deciding.py
  .venv/bin/python python/bindings/option_fields.py --check
  bash python/bindings/stubs.sh --check
}

configure_and_build() {  # DIRECTORY CMAKE_ARGUMENT...
  local directory=$1
  shift
  cmake -S . -B "$directory" -G Ninja --log-level=WARNING -D PDOIK_BUILD_TESTS=ON -D PDOIK_WERROR=ON "$@"
  cmake --build "$directory"
}

under=()  # what starts the tests
run_ctest() {  # DIRECTORY CTEST_ARGUMENT...
  local directory=$1
  shift
  "${under[@]}" ctest --test-dir "$directory" --output-on-failure --no-tests=error --progress -j "$(nproc)" "$@"
}

stage_cpp() {
  configure_and_build build/dev -D PDOIK_BUILD_BENCH=ON
  run_ctest build/dev "$@"
}

# Under the address and undefined-behaviour sanitizers, with Eigen's assertions on: the tests of what reads files, holds
# memory and is given bad input, and the fuzzers' corpora. asan_all has every test, which takes long to compile.
stage_asan() {
  asan "allocation;cloud;obstacle_set;occupancy;point_cloud;robot_errors;self_collision;solver_misuse;srdf;tracker;urdf" "$@"
}

stage_asan_all() { asan "*" "$@"; }

asan() {  # PDOIK_TESTS CTEST_ARGUMENT...
  local tests=$1
  shift
  # The library's files a dozen at once, which halves what reading Eigen takes.
  configure_and_build build/asan -D PDOIK_SANITIZE=address,undefined -D "PDOIK_TESTS=$tests" \
    -D CMAKE_UNITY_BUILD=ON -D CMAKE_UNITY_BUILD_BATCH_SIZE=12 \
    -D CMAKE_BUILD_TYPE=Debug -D CMAKE_CXX_FLAGS_DEBUG="-Og -g1 -Wno-subobject-linkage"
  UBSAN_OPTIONS=print_stacktrace=1 LSAN_OPTIONS=suppressions=$PWD/tests/lsan.supp:print_suppressions=0 \
    run_ctest build/asan "$@"
}

# The tests as cpp built them, at each level of SIMD below the one that this processor has.
stage_simd() {
  configure_and_build build/dev -D PDOIK_BUILD_BENCH=ON
  local level
  for level in baseline avx2; do
    printf -- '-- PDOIK_SIMD=%s\n' "$level"
    PDOIK_SIMD=$level run_ctest build/dev "$@"
  done
}

# What several threads may do at once (the fuzzers' corpora need one), under ThreadSanitizer, whose map of memory has no room for addresses drawn too freely.
stage_tsan() {
  configure_and_build build/tsan -D PDOIK_SANITIZE=thread -D PDOIK_TESTS=threads \
    -D CMAKE_BUILD_TYPE=Debug -D CMAKE_CXX_FLAGS_DEBUG="-O1 -g1"
  local under=()
  if setarch -R true 2>/dev/null; then under=(setarch -R); fi
  run_ctest build/tsan "$@"
}

# What another compiler and clang-tidy make of it.
stage_clang() {
  configure_and_build build/clang -D CMAKE_CXX_COMPILER=clang++ -D CMAKE_CXX_FLAGS_RELEASE="-O1 -DNDEBUG" \
    -D CMAKE_EXPORT_COMPILE_COMMANDS=ON
  run_ctest build/clang "$@"
  run-clang-tidy -quiet -p build/clang -j "$(nproc)" "^$PWD/cpp/src/"
}

build_consumer() {  # NAME CMAKE_ARGUMENT...
  local directory=build/consumer/$1
  shift
  cmake -S tests/consumer -B "$directory" -G Ninja --log-level=WARNING "$@" && cmake --build "$directory"
}

run_consumer() {  # NAME
  "build/consumer/$1/core"
  "build/consumer/$1/consumer"
  "build/consumer/$1/readme"
}

# The project that the page on C++ shows.
of_the_page() {  # CMAKE_ARGUMENT...
  cmake -S tests/consumer/page -B build/consumer/page -G Ninja --log-level=WARNING "$@"
  cmake --build build/consumer/page
  build/consumer/page/reach
  build/consumer/page/control_loop
  build/consumer/page/seam
}

# The program of pdoik::core alone runs, and neither it nor all of core has anything of what pdoik::io is made of.
run_core() {  # NAME
  local program
  for program in core whole_core; do
    "build/consumer/$1/$program"
    ldd "build/consumer/$1/$program" >"build/consumer/$1/$program.contents"
    nm --demangle "build/consumer/$1/$program" >>"build/consumer/$1/$program.contents"
    if grep -iE 'pcl|urdf|yaml|tinyxml|console_bridge' "build/consumer/$1/$program.contents"; then
      echo "$program has the above of pdoik::io in it" >&2
      return 1
    fi
  done
}

without_io=()
for package in urdfdom yaml-cpp PCL; do without_io+=(-D "CMAKE_DISABLE_FIND_PACKAGE_$package=ON"); done

# A parent's build type stays unset and its installation holds its own program only.
is_parents_own() {  # NAME
  grep -qx 'CMAKE_BUILD_TYPE:STRING=' "build/consumer/$1/CMakeCache.txt"
  cmake --install "build/consumer/$1" --prefix "build/consumer/$1_install" >/dev/null
  [[ $(cd "build/consumer/$1_install" && find . -type f) == ./bin/core ]]
}

# A project of its own, which finds the installed library.
stage_consumer() {
  configure_and_build build/dev
  rm -rf build/install build/consumer
  cmake --install build/dev --prefix build/install --component cpp >/dev/null
  mkdir build/consumer
  local installed="-D CMAKE_PREFIX_PATH=$PWD/build/install"

  build_consumer plain "$installed"
  run_consumer plain
  of_the_page "$installed"

  # pdoik::core alone, as on a computer without the libraries of pdoik::io.
  build_consumer core "$installed" "${without_io[@]}" -D PDOIK_IO=OFF
  run_core core
  if build_consumer hidden "$installed" "${without_io[@]}" &>build/consumer/hidden.log; then
    echo "find_package(pdoik) found io without its libraries" >&2
    return 1
  fi
  grep -F "its component io needs" build/consumer/hidden.log
  of_pkg_config
}

# Make and other builds find it by pkg-config.
of_pkg_config() {
  local flags PKG_CONFIG_PATH
  PKG_CONFIG_PATH=$(find "$PWD/build/install" -name pkgconfig)
  export PKG_CONFIG_PATH
  read -ra flags <<<"$(pkg-config --cflags --libs pdoik-core)"
  "${CXX:-c++}" -std=c++20 tests/consumer/core.cpp "${flags[@]}" -o build/consumer/of_pkg_config
  build/consumer/of_pkg_config
  read -ra flags <<<"$(pkg-config --cflags --libs pdoik)"
  "${CXX:-c++}" -std=c++20 tests/consumer/page/reach.cpp "${flags[@]}" -o build/consumer/of_pkg_config
  build/consumer/of_pkg_config
}

# It compiled for this processor, and with the library's sources within, which compiles all of them once more.
stage_consumer_all() {
  stage_consumer
  local installed="-D CMAKE_PREFIX_PATH=$PWD/build/install" native="-D CMAKE_CXX_FLAGS=-march=native"

  if grep -qw avx /proc/cpuinfo; then  # Eigen aligns otherwise with it, and the linker must say so
    if build_consumer native_alone "$installed" "$native" &>build/consumer/native_alone.log; then
      echo "a consumer compiled with AVX linked without pdoik::eigen_abi" >&2
      return 1
    fi
    grep -o 'undefined reference to .pdoik::EigenAbi<.*' build/consumer/native_alone.log | sort -u
  fi
  build_consumer native "$installed" "$native" -D EIGEN_ABI=ON
  run_consumer native

  # By add_subdirectory: how to build, here with Eigen's assertions, and what to install are the outer project's decisions.
  build_consumer inside -D PDOIK_SOURCE="$PWD" "$native" -D EIGEN_ABI=ON
  run_consumer inside
  is_parents_own inside

  # Compiled as `inside` was, command for command: ccache has core's objects from there.
  build_consumer core_inside -D PDOIK_SOURCE="$PWD" "$native" -D EIGEN_ABI=ON "${without_io[@]}" -D PDOIK_IO=OFF
  run_core core_inside
  is_parents_own core_inside
}

# The library compiled for this processor: its own tests, and a plain program that finds it installed.
stage_native() {
  # GCC 12 warns of its own intrinsics for AVX-512 (GCC bug 105593), so warnings are no errors here.
  configure_and_build build/native -D PDOIK_NATIVE=ON -D PDOIK_WERROR=OFF
  run_ctest build/native "$@"
  rm -rf build/install_native build/consumer/of_native
  cmake --install build/native --prefix build/install_native --component cpp >/dev/null
  build_consumer of_native -D CMAKE_PREFIX_PATH="$PWD/build/install_native"
  run_consumer of_native
}

# A look by every fuzzer; tests/fuzz.sh by itself takes an hour for each.
stage_fuzz() { bash tests/fuzz.sh "${1:-15}"; }

# One worker per core, and one thread each: the files are many and the numerics small. python_all has the long ones too.
stage_python() { stage_python_all -m "not long" "$@"; }

# Cross-compiled for aarch64 and run by qemu: the core and a program of its own, then the tests and the other programs.
# The library is compiled as users compile it, a dozen files at once; its tests in less time.
stage_aarch64() {
  bash third_party/debian.sh third_party/aarch64/debian.txt
  bash third_party/aarch64/root.sh
  local root=$PWD/build/aarch64/root here=$PWD/build/aarch64/build
  local cross=(-D "CMAKE_TOOLCHAIN_FILE=$PWD/third_party/aarch64/toolchain.cmake" -D "CMAKE_SYSROOT=$root"
    -D "CMAKE_FIND_ROOT_PATH=$PWD/build/aarch64/install")
  cross_build() {
    configure_and_build "$here" "${cross[@]}" -D CMAKE_UNITY_BUILD=ON -D CMAKE_UNITY_BUILD_BATCH_SIZE=12 \
      -D CMAKE_CXX_FLAGS=-Wno-subobject-linkage -D PDOIK_TESTS_OPTIONS=-O1 "$@"
  }
  run_installed() {  # PROGRAM CMAKE_ARGUMENT...
    cmake --install "$here" --prefix build/aarch64/install --component cpp >/dev/null
    build_consumer aarch64 "${cross[@]}" "${@:2}"
    qemu-aarch64-static -L "$root" "build/consumer/aarch64/$1"
  }
  cross_build -D PDOIK_IO=OFF -D PDOIK_BUILD_TESTS=OFF
  run_installed core -D PDOIK_IO=OFF
  cross_build -D PDOIK_IO=ON
  # One test starts its own program again, which qemu cannot unless the system knows its format.
  run_ctest "$here" -E SimdLevel.is_the_highest "$@"
  run_installed readme -D PDOIK_IO=ON
}

# A wheel for each Python told, .venv's unless told, `all` for every one that can be had; each is tried in a new environment
# where nothing of this tree is, and in bare systems by root, if one of these has its Python.
stage_wheel() {
  bash third_party/wheel.sh "$@"
  bash tests/wheel/venvs.sh "$@"
  if ((EUID == 0)) && compgen -G 'build/wheels/pdoik-*-cp31[13]-cp31[13]-*.whl' >/dev/null; then bash tests/wheel/roots.sh; fi
}

stage_python_all() {
  # What the benches of peers load, made once, and as cpp compiles it: ccache has the library from there.
  cmake -S . -B build/bench --log-level=WARNING -D PDOIK_BUILD_BENCH=ON -D PDOIK_WERROR=ON \
    -D "Python3_EXECUTABLE=$PWD/.venv/bin/python"
  cmake --build build/bench --parallel "$(nproc)" --target pdoik_peers
  OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 .venv/bin/python -m pytest -n auto --dist loadfile --no-loadscope-reorder "$@"
}

# The documentation's site, whose warnings are errors. The code in its pages is run by the Python tests.
stage_docs() { bash python/docs/build.sh test,bench; }

stages=(lint cpp simd asan consumer docs python)
others=(python_all consumer_all asan_all tsan clang native fuzz aarch64 wheel)  # by name only: they take long
if (($#)); then
  [[ " ${stages[*]} ${others[*]} " == *" $1 "* ]] ||
    { echo "run.sh: no stage $1; there are: ${stages[*]} ${others[*]}" >&2; exit 2; }
  stages=("$1")
  shift
fi

# The wheel as cpp compiles it, so that ccache has the library from there.
export CXX=${CXX:-c++} SKBUILD_CMAKE_DEFINE="PDOIK_WERROR=ON"
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
