a2rt_add_fuzzer(boxes SOURCES ${CMAKE_CURRENT_LIST_DIR}/boxes_fuzzer.cpp LIBRARIES a2rt::arith
  SECONDS 60 MAX_LEN 128)
