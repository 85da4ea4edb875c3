if(TARGET a2rt::workload)
  a2rt_add_fuzzer(import SOURCES ${CMAKE_CURRENT_LIST_DIR}/fuzz_import.cpp
    ${PROJECT_SOURCE_DIR}/tests/unit/workload/raw_capture.cpp
    LIBRARIES a2rt::workload INCLUDES ${PROJECT_SOURCE_DIR}/tests/unit/workload
    CORPUS ${CMAKE_CURRENT_LIST_DIR}/../corpus/import)
  a2rt_add_fuzzer(verdicts SOURCES ${CMAKE_CURRENT_LIST_DIR}/fuzz_verdicts.cpp
    LIBRARIES a2rt::workload CORPUS ${CMAKE_CURRENT_LIST_DIR}/../corpus/verdicts)
endif()
