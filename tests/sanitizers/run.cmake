# cmake -DMODE=suites|fuzzers -DSOURCE=... -DBINARY=... -DPYTHON=... -P run.cmake
#
# suites: the core's fast suites and the corpora under AddressSanitizer and UBSan.
# fuzzers: every fuzzer, instrumented, for its own number of seconds; needs Clang.
# Both share one build folder, so that Clang compiles the core once. Without Clang the suites are
# built by the ordinary compiler.
find_program(CLANG NAMES clang++ clang++-19 clang++-18 clang++-17 clang++-16 clang++-15 clang++-14)
if(CLANG)
  set(COMPILER -DCMAKE_CXX_COMPILER=${CLANG} -DA2RT_BUILD_FUZZERS=ON
    -DA2RT_SANITIZE=fuzzer-no-link,address,undefined)
else()
  set(COMPILER -DA2RT_SANITIZE=address,undefined)
endif()

if(MODE STREQUAL "suites")
  set(TARGETS arith_units arith_kernels arith_properties bvh_test config_test energy_test rt_test
    spirv_test workload_test timing_test hard_cases_arith hard_cases_units tests/fuzz/all)
  # The mutation check and the large samples would say nothing new here and take an hour; suites that
  # run programs need a driver. What is not built reports itself so, and is left out.
  set(SELECT --label-regex "^fast$"
    --exclude-regex "_NOT_BUILT|^(repo|e2e|hard_cases_page)\\.")
elseif(MODE STREQUAL "fuzzers")
  if(NOT CLANG)
    message("SKIPPED: the fuzzers need libFuzzer; get it with: apt-get install clang libclang-rt-dev")
    return()
  endif()
  set(TARGETS tests/fuzz/all)
  set(SELECT --tests-regex "^fuzz_")
else()
  message(FATAL_ERROR "MODE is suites or fuzzers, not '${MODE}'")
endif()

# Embree keeps what it allocated until the process ends.
set(ENV{ASAN_OPTIONS} "detect_leaks=0")
execute_process(COMMAND ${CMAKE_COMMAND} -S ${SOURCE} -B ${BINARY} -G Ninja
    -DA2RT_BUILD_TESTS=ON -DA2RT_PYTHON=${PYTHON} -DCMAKE_BUILD_TYPE=Release ${COMPILER}
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_COMMAND} --build ${BINARY} --target ${TARGETS}
  COMMAND_ERROR_IS_FATAL ANY)
execute_process(COMMAND ${CMAKE_CTEST_COMMAND} --test-dir ${BINARY} --output-on-failure --parallel 2
    --no-tests=error ${SELECT}
  COMMAND_ERROR_IS_FATAL ANY)
