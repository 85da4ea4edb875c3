if(TARGET a2rt::scenes)
  a2rt_add_fuzzer(gltf SOURCES ${CMAKE_CURRENT_LIST_DIR}/gltf_fuzzer.cpp
    LIBRARIES a2rt_scenes a2rt::base MAX_LEN 16384)
endif()
