# 64-bit ARM on another machine: Debian's cross compiler, the libraries in HQSLAM_ARM64_ROOT, where
# tools/test_arm64.sh unpacks them, and qemu-aarch64 to run the tests.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_SYSTEM_PROCESSOR aarch64)
set(CMAKE_CXX_COMPILER aarch64-linux-gnu-g++)
set(CMAKE_LIBRARY_ARCHITECTURE aarch64-linux-gnu)

set(HQSLAM_ARM64_ROOT "" CACHE PATH "Where the arm64 packages are unpacked")
list(APPEND CMAKE_TRY_COMPILE_PLATFORM_VARIABLES HQSLAM_ARM64_ROOT)
set(CMAKE_SYSROOT ${HQSLAM_ARM64_ROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
set(ENV{PKG_CONFIG_SYSROOT_DIR} ${HQSLAM_ARM64_ROOT})
set(ENV{PKG_CONFIG_LIBDIR}
    ${HQSLAM_ARM64_ROOT}/usr/lib/aarch64-linux-gnu/pkgconfig:${HQSLAM_ARM64_ROOT}/usr/share/pkgconfig)

set(CMAKE_EXE_LINKER_FLAGS_INIT "")
foreach(folder lib usr/lib)
  string(APPEND CMAKE_EXE_LINKER_FLAGS_INIT
         " -Wl,-rpath-link,${HQSLAM_ARM64_ROOT}/${folder}/aarch64-linux-gnu")
endforeach()
set(CMAKE_CROSSCOMPILING_EMULATOR qemu-aarch64;-L;${HQSLAM_ARM64_ROOT})
