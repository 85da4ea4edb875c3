if(TARGET a2rt::spirv)
  a2rt_add_fuzzer(spirv SOURCES ${CMAKE_CURRENT_LIST_DIR}/spirv_fuzzer.cpp LIBRARIES a2rt::spirv)
endif()
