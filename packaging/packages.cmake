# CPack's configuration for scripts/release. Variables of the environment: TREE, the folder to pack; PREFIX, where it goes;
# NAME, the package's file name without its ending; VERSION.
set(CPACK_PACKAGE_NAME wetcurl)
set(CPACK_PACKAGE_VERSION $ENV{VERSION})
set(CPACK_PACKAGE_FILE_NAME $ENV{NAME})
set(CPACK_PACKAGE_VENDOR "The wetcurl authors")
set(CPACK_PACKAGE_CONTACT "The wetcurl authors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "simulation of wet curly hair, and networks that run in its place")
set(CPACK_PACKAGE_DESCRIPTION "wetcurl simulates wet curly hair, trains networks on the simulations, and runs the networks in\nplace of the simulation. This package has the program, libwetcurl for other programs, scenes and released networks.")
set(CPACK_INSTALLED_DIRECTORIES "$ENV{TREE};$ENV{PREFIX}")
set(CPACK_CMAKE_GENERATOR Ninja)
set(CPACK_SYSTEM_NAME Linux)
set(CPACK_TOPLEVEL_TAG packages)

set(CPACK_DEBIAN_PACKAGE_SECTION graphics)
# The packages of the libraries that its programs and libraries link: LibTorch, OpenCV, HDF5 and more are Debian's.
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_EXTRA ${CMAKE_CURRENT_LIST_DIR}/triggers)
