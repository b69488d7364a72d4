# hqslam_source_hash(<target> NAME <name> FILES <file>...): the target can include <name>.h, which
# defines HQSLAM_<NAME>, a text that changes with any of the files, the compiler or its flags.
# It tells results of one state of the program from those of another without a version by hand.
function(hqslam_source_hash target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "NAME" "FILES")
  list(SORT arg_FILES)
  set(folder ${CMAKE_CURRENT_BINARY_DIR}/source_hash)
  set(list ${folder}/${arg_NAME}.txt)
  set(header ${folder}/${arg_NAME}.h)
  string(JOIN "\n" lines ${arg_FILES})
  file(WRITE ${list}.new "${lines}\n")
  file(COPY_FILE ${list}.new ${list} ONLY_IF_DIFFERENT)
  string(TOUPPER "${CMAKE_BUILD_TYPE}" type)
  add_custom_command(
    OUTPUT ${header}
    COMMAND
      ${CMAKE_COMMAND} -DNAME=${arg_NAME} -DFILES=${list} -DROOT=${PROJECT_SOURCE_DIR}
      -DHEADER=${header}
      "-DSALT=${CMAKE_CXX_COMPILER_ID} ${CMAKE_CXX_COMPILER_VERSION} ${CMAKE_CXX_FLAGS} ${CMAKE_CXX_FLAGS_${type}}"
      -P ${PROJECT_SOURCE_DIR}/cmake/WriteSourceHash.cmake
    DEPENDS ${arg_FILES} ${list} ${PROJECT_SOURCE_DIR}/cmake/WriteSourceHash.cmake
    COMMENT "Hash of the sources that decide results"
    VERBATIM)
  target_sources(${target} PRIVATE ${header})
  target_include_directories(${target} PRIVATE ${folder})
endfunction()
