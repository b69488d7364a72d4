# One library of hqslam: C++20, warnings, its public headers, and its own install component, so
# that find_package(hqslam COMPONENTS core) works where only core was built.

function(hqslam_compile_settings target)
  target_compile_features(${target} PUBLIC cxx_std_20)
  target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wshadow -Wconversion
                                           -Wno-sign-conversion)
  # Where sources are compiled several at a time, GCC takes them for headers, which have no names of
  # their own.
  if(CMAKE_UNITY_BUILD AND CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
    target_compile_options(${target} PRIVATE -Wno-subobject-linkage)
  endif()
  if(HQSLAM_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
  # The same bytes on every machine: x86-64 has no fused multiply-add to contract to unless asked,
  # others do. The network's kernels ask for it.
  if(NOT CMAKE_SYSTEM_PROCESSOR MATCHES "x86_64|AMD64")
    target_compile_options(${target} PRIVATE -ffp-contract=off)
  endif()
endfunction()

# Parsed once for each target instead of once for each source: half of what compiling costs. More
# headers with ADDITIONAL. A source that is compiled with other options must skip them.
function(hqslam_precompile target)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "ADDITIONAL")
  if(HQSLAM_PRECOMPILED_HEADERS)
    target_precompile_headers(
      ${target} PRIVATE <algorithm> <array> <cmath> <cstdint> <filesystem> <fstream> <functional>
      <map> <memory> <optional> <span> <string> <variant> <vector> <Eigen/Core> <Eigen/Geometry>
      ${arg_ADDITIONAL})
  endif()
endfunction()

# hqslam_library(<component> [SOURCES <file>...]): target hqslam_<component>, alias
# hqslam::<component>; without sources all that are in src.
function(hqslam_library component)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" "SOURCES")
  if(NOT arg_SOURCES)
    file(GLOB_RECURSE arg_SOURCES CONFIGURE_DEPENDS src/*.cpp)
  endif()
  set(target hqslam_${component})
  add_library(${target} STATIC ${arg_SOURCES})
  add_library(hqslam::${component} ALIAS ${target})
  hqslam_compile_settings(${target})
  hqslam_precompile(${target})
  set_target_properties(${target} PROPERTIES EXPORT_NAME ${component}
                                             POSITION_INDEPENDENT_CODE ON)
  target_include_directories(
    ${target} PUBLIC $<BUILD_INTERFACE:${CMAKE_CURRENT_SOURCE_DIR}/include>
                     $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  if(CMAKE_OBJCOPY AND CMAKE_NM AND NOT APPLE)
    add_custom_command(
      TARGET ${target} POST_BUILD
      COMMAND ${CMAKE_COMMAND} -DNM=${CMAKE_NM} -DOBJCOPY=${CMAKE_OBJCOPY}
              -DARCHIVE=$<TARGET_FILE:${target}> -P ${PROJECT_SOURCE_DIR}/cmake/OwnEigen.cmake
      VERBATIM)
  endif()
  install(TARGETS ${target} EXPORT hqslam-${component}-targets COMPONENT ${component})
  install(EXPORT hqslam-${component}-targets NAMESPACE hqslam:: COMPONENT ${component}
          DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/hqslam)
  install(DIRECTORY include/ DESTINATION ${CMAKE_INSTALL_INCLUDEDIR} COMPONENT ${component})
endfunction()

function(hqslam_install_config)
  include(CMakePackageConfigHelpers)
  set(destination ${CMAKE_INSTALL_LIBDIR}/cmake/hqslam)
  write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/hqslamConfigVersion.cmake
                                   COMPATIBILITY SameMinorVersion)
  configure_package_config_file(cmake/hqslamConfig.cmake.in
                                ${CMAKE_CURRENT_BINARY_DIR}/hqslamConfig.cmake
                                INSTALL_DESTINATION ${destination})
  install(FILES ${CMAKE_CURRENT_BINARY_DIR}/hqslamConfig.cmake
                ${CMAKE_CURRENT_BINARY_DIR}/hqslamConfigVersion.cmake
          DESTINATION ${destination} COMPONENT core)
endfunction()
