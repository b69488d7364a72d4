# cpack makes hqslam_<version>_<architecture>.deb of everything that was built: program, weights,
# manual page and the libraries with what find_package needs.
set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME hqslam)
set(CPACK_PACKAGE_CONTACT "the hqslam authors")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
# To build with the libraries.
set(CPACK_DEBIAN_PACKAGE_SUGGESTS
    "libeigen3-dev, libfmt-dev, nlohmann-json3-dev, libzip-dev, libpcap-dev, libcpp-httplib-dev, libsqlite3-dev, liblz4-dev, libzstd-dev, libbz2-dev, libceres-dev, libpcl-dev")
include(CPack)
