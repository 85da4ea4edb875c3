if(TARGET a2rt::rt)
  a2rt_add_fuzzer(workload SOURCES ${CMAKE_CURRENT_LIST_DIR}/workload_fuzzer.cpp
    LIBRARIES a2rt::rt a2rt::workload a2rt::config MAX_LEN 256)
endif()
