if(TARGET a2rt::hard)
  a2rt_add_fuzzer(units SOURCES ${CMAKE_CURRENT_LIST_DIR}/units_fuzzer.cpp
    LIBRARIES a2rt::hard a2rt::rt a2rt::workload SECONDS 60 MAX_LEN 2048)
endif()
